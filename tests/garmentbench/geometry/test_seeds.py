import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from garmentbench.geometry.nearest import nearest_vertices, plane_distances
from garmentbench.geometry.seeds import REACH, farthest_points, seed_frames, seed_points, select_seeds
from garmentbench.sequence import Body, Garment, Template


@pytest.fixture(scope="module")
def template() -> Template:
    """A tall cylinder (labels by height) that wears a short tube."""
    body = trimesh.creation.cylinder(radius=0.1, height=1.0, sections=16).subdivide_to_size(0.08)
    tube = trimesh.creation.cylinder(radius=0.12, height=0.3, sections=16)
    rest, faces = body.vertices.astype(np.float32), body.faces.astype(np.int32)
    labels = (rest[:, 2] > 0).astype(np.int8)
    garment = Garment(
        "tube",
        tube.vertices.astype(np.float32),
        tube.faces.astype(np.int32),
        np.zeros((len(tube.vertices), 2), np.float32),
        np.zeros((0, 2), np.int32),
    )
    return Template(garment, Body("cylinder", rest, faces, labels, ("low", "high")), 30.0)


def test_seeds_are_spread_within_reach_and_the_same_each_time(template):
    seeds = select_seeds(template, 20)
    again = select_seeds(template, 20)
    assert seeds.vertices.tolist() == again.vertices.tolist()
    assert len(set(seeds.vertices.tolist())) == 20
    assert nearest_vertices(seeds.rest, template.garment.rest)[0].max() < REACH
    np.testing.assert_array_equal(seeds.labels, template.body.labels[seeds.vertices])
    random = template.body.rest[np.random.default_rng(0).choice(len(template.body.rest), 20, replace=False)]
    assert _smallest_gap(seeds.rest) > _smallest_gap(random)


def _smallest_gap(points: np.ndarray) -> float:
    return min(np.sort(np.linalg.norm(points - p, axis=1))[1] for p in points)


def test_farthest_points_on_a_strip_go_from_end_to_end_to_middle():
    x = np.arange(9.0)
    strip = np.array([[i, j, 0] for i in x for j in (0, 0.1)])
    faces = np.array([f for i in range(0, 16, 2) for f in ([i, i + 2, i + 1], [i + 1, i + 2, i + 3])])
    chosen = farthest_points(strip, faces, np.arange(0, 18, 2), 3)
    assert sorted(strip[chosen, 0].tolist()) == [0, 4, 8]


def test_all_that_may_be_chosen_is_chosen_when_more_are_asked(template):
    few = farthest_points(template.body.rest, template.body.faces, np.arange(5), 50)
    assert sorted(few.tolist()) == [0, 1, 2, 3, 4]


def test_seed_rotations_are_the_bodys_own_twist_included(template):
    body = template.body
    seeds = seed_points(body.rest.astype(float), body.faces, np.array([0, 7, 30]))
    turns = Rotation.random(4, rng=1).as_matrix()
    moved = np.einsum("tij,vj->tvi", turns, body.rest.astype(float)) + [1.0, 2.0, 3.0]
    positions, rotations, normals = seed_frames(moved, seeds)
    np.testing.assert_allclose(rotations, np.broadcast_to(turns[:, None], rotations.shape), atol=1e-9)
    np.testing.assert_allclose(positions, moved[:, seeds.vertices])
    np.testing.assert_allclose(normals, np.einsum("tij,nj->tni", turns, seeds.frames[..., 2]), atol=1e-9)


def test_plane_distance_is_negative_behind_the_nearest_vertex():
    floor = np.array([[0.0, 0, 0], [10, 0, 0]])
    up = np.array([[0.0, 0, 1], [0, 0, 1]])
    points = np.array([[1.0, 0, 0.5], [9, 0, -0.25]])
    np.testing.assert_allclose(plane_distances(points, floor, up), [0.5, -0.25])
