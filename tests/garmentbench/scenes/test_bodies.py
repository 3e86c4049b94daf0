"""The baked bodies: sound meshes of one topology, and skinning against matrices worked out one by one."""

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from garmentbench.errors import UsageError
from garmentbench.scenes.bodies import body_names, joint_positions, load_body, pose, pose_exact

SIZES = {"small": 3502, "full": 13348}
NAMES = ("base", "slim", "heavy", "tall", "short")
BODIES = [(name, size) for name in NAMES for size in SIZES]
HEIGHTS = {"tall": 1.95, "short": 1.67}  # the others: 1.84


def test_names():
    assert set(body_names()) >= set(NAMES)  # and your own


@pytest.mark.parametrize("name, size", BODIES)
def test_mesh_is_closed_manifold_and_outward(name, size):
    body = load_body(name, size).body
    mesh = trimesh.Trimesh(body.rest, body.faces, process=False)
    _, uses = np.unique(np.sort(mesh.edges, axis=1), axis=0, return_counts=True)
    assert len(body.rest) == SIZES[size]
    assert (uses == 2).all() and mesh.is_winding_consistent
    assert mesh.euler_number == 2 and mesh.body_count == 1
    assert 0.055 < mesh.volume < 0.09  # cubic metres, positive for outward faces
    assert abs(body.rest[:, 2].min()) < 1e-4 and abs(np.ptp(body.rest[:, 2]) - HEIGHTS.get(name, 1.84)) < 0.01


@pytest.mark.parametrize("name, size", BODIES)
def test_weights_labels_and_uv(name, size):
    baked = load_body(name, size)
    body = baked.body
    np.testing.assert_allclose(baked.weights.sum(axis=1), 1.0, atol=1e-12)
    assert (baked.weights >= 0).all() and (baked.weights.max(axis=0) > 0.4).all()
    assert set(body.labels) == set(range(5))
    assert body.part_names == ("upper_body", "fore_arm", "rear_arm", "thigh", "calf")
    assert baked.uv.min() >= 0 and baked.uv.max() <= 1 and baked.uv.shape == (len(body.rest), 2)
    assert (baked.parents[1:] < np.arange(1, len(baked.parents))).all() and baked.parents[0] == -1


def test_labels_lie_where_they_say():
    baked = load_body("base", "small")
    rest, labels = baked.body.rest, baked.body.labels
    part = {name: rest[labels == i] for i, name in enumerate(baked.body.part_names)}
    assert part["upper_body"][:, 2].max() == rest[:, 2].max()  # the head
    assert part["calf"][:, 2].min() == rest[:, 2].min()  # the feet
    assert np.abs(part["fore_arm"][:, 0]).max() == np.abs(rest[:, 0]).max()  # the hands
    assert np.abs(part["rear_arm"][:, 0]).max() < np.abs(part["fore_arm"][:, 0]).max()
    assert part["calf"][:, 2].mean() < part["thigh"][:, 2].mean() < part["upper_body"][:, 2].mean()


@pytest.mark.parametrize("size", SIZES)
def test_shapes_share_all_but_their_form(size):
    base, slim, heavy, tall, short = (load_body(name, size) for name in NAMES)
    for other in (slim, heavy, tall, short):
        np.testing.assert_array_equal(other.body.faces, base.body.faces)
        np.testing.assert_array_equal(other.body.labels, base.body.labels)
        np.testing.assert_array_equal(other.weights, base.weights)
    volume = [trimesh.Trimesh(b.body.rest, b.body.faces, process=False).volume for b in (slim, base, heavy)]
    assert volume[0] < volume[1] < volume[2]


def test_body_stands_upright_and_faces_minus_y():
    baked = load_body("base", "full")
    joint = dict(zip(baked.joint_names, baked.joints, strict=True))
    assert joint["toes.L"][1] < joint["foot.L"][1] and joint["toes.R"][1] < joint["foot.R"][1]
    assert joint["hand.L"][0] > 0 > joint["hand.R"][0]
    np.testing.assert_allclose(joint["pelvis"][:2], 0.0, atol=1e-6)


def test_rest_pose_is_the_rest_shape():
    baked = load_body("slim", "small")
    still = np.tile(np.eye(3), (2, len(baked.parents), 1, 1))
    posed = pose(baked, still, np.tile(baked.joints[0], (2, 1)))
    assert posed.dtype == np.float32
    np.testing.assert_allclose(posed[1], baked.body.rest, atol=1e-6)


def test_skinning_against_matrices_one_by_one():
    baked = load_body("base", "small")
    joints = len(baked.parents)
    rotations = Rotation.random(2 * joints, rng=np.random.default_rng(0)).as_matrix().reshape(2, joints, 3, 3)
    root = np.array([[0.0, 0.0, 1.0], [3.0, -2.0, 1.0]])
    heads = joint_positions(baked, rotations, root)
    chosen = np.array([0, 700, 3501])
    fast = pose_exact(baked, rotations, root, chosen)
    for row, vertex in enumerate(chosen):
        plain = sum(
            baked.weights[vertex, j] * (rotations[1, j] @ (baked.body.rest[vertex] - baked.joints[j]) + heads[1, j])
            for j in range(joints)
        )
        np.testing.assert_allclose(fast[1, row], plain, atol=1e-12)


def test_bones_keep_their_lengths():
    baked = load_body("heavy", "small")
    joints = len(baked.parents)
    rotations = Rotation.random(joints, rng=np.random.default_rng(1)).as_matrix()[None]
    heads = joint_positions(baked, rotations, np.zeros((1, 3)))[0]
    bones = np.arange(1, joints)
    posed = np.linalg.norm(heads[bones] - heads[baked.parents[bones]], axis=1)
    rest = np.linalg.norm(baked.joints[bones] - baked.joints[baked.parents[bones]], axis=1)
    np.testing.assert_allclose(posed, rest, atol=1e-12)


@pytest.mark.parametrize("name, size, hint", [("bese", "small", "'base'"), ("base", "smal", "'small'")])
def test_unknown_names_are_told(name, size, hint):
    with pytest.raises(UsageError, match=f"did you mean {hint}"):
        load_body(name, size)
