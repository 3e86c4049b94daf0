"""The baked bodies: sound meshes of one topology, and skinning against matrices worked out one by one."""

import numpy as np
import pytest
import trimesh
from scipy.ndimage import median_filter
from scipy.spatial.transform import Rotation

from garmentbench.errors import UsageError
from garmentbench.geometry.signed_distance import signed_distances
from garmentbench.scenes.bodies import BakedBody, body_names, joint_positions, load_body, pose, pose_exact
from garmentbench.sequence import Body

SIZES = {"small": 5414, "full": 13348}
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


def part(baked: BakedBody, *joints: str) -> np.ndarray:
    """Which vertices follow these joints more than all others."""
    return baked.weights[:, [baked.joint_names.index(name) for name in joints]].sum(axis=1) > 0.5


def apart(points: np.ndarray, body: Body) -> np.ndarray:
    """Distances of points from a body's surface [mm]."""
    return 1e3 * np.abs(signed_distances(points[None].astype(np.float32), body.rest[None], body.faces)[0])


PARTS = {"head": ("head",), "hand": ("hand.L",), "foot": ("foot.L", "toes.L")}


@pytest.mark.parametrize("name", NAMES)
def test_the_small_size_keeps_head_hands_and_feet(name):
    """No point of either size's surface is far from the other's: fingers, toes, lids, lips and ears are all there."""
    small, full = load_body(name, "small"), load_body(name, "full")
    for names in PARTS.values():
        missing = apart(full.body.rest[part(full, *names)], small.body)
        centres = small.body.rest[small.body.faces[part(small, *names)[small.body.faces].all(axis=1)]].mean(axis=1)
        beside = apart(centres, full.body)
        assert np.quantile(missing, 0.95) < 1.3 and np.quantile(beside, 0.95) < 1.3
        assert missing.max() < 4.0 and beside.max() < 3.0


@pytest.mark.parametrize("name", NAMES)
def test_where_garments_touch_the_small_size_has_even_triangles_on_the_full_surface(name):
    small, full = load_body(name, "small"), load_body(name, "full")
    trunk = ~part(small, "head", *(f"{n}.{s}" for n in ("hand", "foot", "toes") for s in "LR"))
    mesh = trimesh.Trimesh(small.body.rest, small.body.faces[trunk[small.body.faces].all(axis=1)], process=False)
    assert np.median(mesh.edges_unique_length) == pytest.approx(0.027, rel=0.12)
    assert mesh.edges_unique_length.max() < 0.085
    assert np.quantile(mesh.face_angles.min(axis=1), 0.05) > np.radians(21)
    assert apart(small.body.rest[trunk], full.body).max() < 0.05
    assert np.quantile(apart(mesh.triangles_center, full.body), 0.95) < 2.0


def seen_from_the_front(body: Body, x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """y [m] of the nearest point of the surface along +y at each x and z, shape of x; infinite where there is none."""
    corners = body.rest[body.faces].astype(np.float64)
    in_sight = (np.abs(corners[:, :, 0]).min(axis=1) < np.abs(x).max()) & (corners[:, :, 2].max(axis=1) > z.min())
    depth = np.full(x.shape, np.inf)
    for a, b, c in corners[in_sight]:
        double = (b[0] - a[0]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[0] - a[0])
        if double > 1e-12:  # faces -y
            v = ((x - a[0]) * (c[2] - a[2]) - (z - a[2]) * (c[0] - a[0])) / double
            w = ((b[0] - a[0]) * (z - a[2]) - (b[2] - a[2]) * (x - a[0])) / double
            y = (1 - v - w) * a[1] + v * b[1] + w * c[1]
            depth = np.where((v >= 0) & (w >= 0) & (v + w <= 1), np.minimum(depth, y), depth)
    return depth


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", NAMES)
def test_the_eyes_are_in_and_the_mouth_is_closed(name, size):
    """Seen from the front the face is one relief, without the holes of open sockets or of a torn mouth."""
    baked = load_body(name, size)
    top = baked.body.rest[:, 2].max()
    head = top - baked.joints[baked.joint_names.index("head"), 2]  # 16 cm
    x, z = np.meshgrid(head * np.linspace(-0.28, 0.28, 46), top - head * np.linspace(0.55, 1.16, 50))
    depth = seen_from_the_front(baked.body, x, z)
    assert np.isfinite(depth).all()
    assert (depth - median_filter(depth, 15)).max() < 0.012


@pytest.mark.parametrize("size", SIZES)
def test_hands_are_at_ease(size):
    """Curled: from the wrist to the farthest finger tip 19 cm, where the flat hand has 21."""
    baked = load_body("base", size)
    for side in "LR":
        hand = baked.body.rest[part(baked, f"hand.{side}")] - baked.joints[baked.joint_names.index(f"hand.{side}")]
        assert 0.17 < np.linalg.norm(hand, axis=1).max() < 0.195


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
    chosen = np.array([0, 700, 5413])
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
