import numpy as np
from scipy.spatial.transform import Rotation

from garmentbench.geometry.surface_seeds import surface_frames, surface_seeds

TETRA = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
CORNERS, WEIGHTS = np.array([[0, 2, 1], [1, 2, 3]]), np.array([[0.5, 0.25, 0.25], [1 / 3, 1 / 3, 1 / 3]])


def test_places_and_normals_by_hand():
    seeds = surface_seeds(TETRA, FACES, CORNERS, WEIGHTS)
    np.testing.assert_allclose(seeds.rest, [[0.25, 0.25, 0], [1 / 3, 1 / 3, 1 / 3]])
    positions, rotations, normals = surface_frames(TETRA, seeds)
    np.testing.assert_allclose(positions, seeds.rest)
    np.testing.assert_allclose(rotations, np.tile(np.eye(3), (2, 1, 1)), atol=1e-12)
    # Along each axis the three corners' faces add up to 3 / sqrt 3 - 2, which is below 0.
    np.testing.assert_allclose(normals[1], np.full(3, -(3**-0.5)), atol=1e-12)
    np.testing.assert_allclose(seeds.frames[0][:, 0] @ normals[0], 0, atol=1e-12)


def test_they_turn_with_the_body_twist_included():
    seeds = surface_seeds(TETRA, FACES, CORNERS, WEIGHTS)
    turns = Rotation.from_rotvec([[0.3, -1.0, 2.0], [0, 0, 0.7]]).as_matrix()
    moved = np.einsum("txy,vy->tvx", turns, TETRA) + [1.0, 2, 3]
    positions, rotations, _ = surface_frames(moved, seeds)
    np.testing.assert_allclose(rotations, np.repeat(turns[:, None], 2, axis=1), atol=1e-12)
    np.testing.assert_allclose(positions, np.einsum("txy,ny->tnx", turns, seeds.rest) + [1.0, 2, 3], atol=1e-12)


def test_faces_elsewhere_do_not_count():
    far = np.concatenate([TETRA, 5 + TETRA])
    seeds = surface_seeds(far, np.concatenate([FACES, 4 + FACES]), CORNERS, WEIGHTS)
    assert len(seeds.faces) == 4
    np.testing.assert_allclose(seeds.frames, surface_seeds(TETRA, FACES, CORNERS, WEIGHTS).frames)
