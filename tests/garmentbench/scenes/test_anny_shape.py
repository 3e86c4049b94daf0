"""Hands at ease and eyes in, on shapes made for it: no Anny needed."""

import numpy as np
from trimesh import Trimesh
from trimesh.creation import icosphere

from garmentbench.scenes.anny_shape import Bones, close_over_eye, relax_hands

LENGTHS = (0.0, 0.045, 0.075, 0.10)  # of a finger's joints and tip, from its knuckle on [m]


def flat_hands() -> tuple[np.ndarray, Bones]:
    """Stiff hands that point down, palms to the body, fingers splayed: a vertex at each joint, tip and wrist."""
    names, heads, vertices, owners = [], [], [], []
    for side, out in (("L", 1.0), ("R", -1.0)):
        wrist = np.array([0.3 * out, 0.0, 0.9])
        names.append(f"wrist.{side}")
        heads.append(wrist)
        vertices.append(wrist)
        owners.append(names[-1])
        for finger in range(1, 6):
            across = 0.02 * (finger - 3)  # backwards, from the index finger to the little one
            knuckle = wrist + ([0.0, -0.05, -0.03] if finger == 1 else [0.0, across, -0.09])
            way = np.array([-0.3 * out, -0.8, -0.6]) if finger == 1 else np.array([0.0, 6 * across, -1.0])
            joints = knuckle + np.multiply.outer(LENGTHS, way / np.linalg.norm(way))
            for k in (1, 2, 3):
                names.append(f"finger{finger}-{k}.{side}")
                heads.append(joints[k - 1])
                vertices.append(joints[k])  # each bone's far end goes with it
                owners.append(names[-1])
    weights = np.array([[owner == name for name in names] for owner in owners], float)
    return np.array(vertices), Bones(names, np.array(heads), weights)


def test_hands_at_ease_are_curled_towards_the_palm_and_closer_together():
    stiff, bones = flat_hands()
    eased = relax_hands(stiff, bones)
    for side, inward in (("L", -1.0), ("R", 1.0)):
        ends = {name: k for k, name in enumerate(bones.names) if name.endswith(side)}
        assert (eased[ends[f"wrist.{side}"]] == stiff[ends[f"wrist.{side}"]]).all()
        for finger in range(2, 6):
            tip = ends[f"finger{finger}-3.{side}"]
            assert 0.02 < inward * (eased[tip] - stiff[tip])[0] < 0.08
        splay = [np.ptp(p[[ends[f"finger{f}-3.{side}"] for f in range(2, 6)], 1]) for p in (eased, stiff)]
        assert splay[0] < 0.85 * splay[1]


def test_hands_at_ease_keep_their_length_and_are_mirror_images():
    stiff, bones = flat_hands()
    eased = relax_hands(stiff, bones)
    half = len(bones.names) // 2
    np.testing.assert_allclose(eased[:half] * [-1, 1, 1], eased[half:], atol=1e-12)
    for finger in range(1, 6):
        chain = [bones.names.index(f"finger{finger}-{k}.L") for k in (1, 2, 3)]
        points = np.vstack([bones.heads[chain[0]], eased[chain]])
        np.testing.assert_allclose(np.linalg.norm(np.diff(points, axis=0), axis=1), np.diff(LENGTHS), atol=1e-12)


def test_a_socket_is_laid_on_the_front_of_its_eyeball():
    """A ball of skin with a bag that goes round the back of an eyeball."""
    skin = icosphere(subdivisions=4, radius=0.1)
    axis, centre, radius = np.array([0.0, -1.0, 0.0]), np.array([0.0, -0.088, 0.0]), 0.016
    points, faces = np.array(skin.vertices), np.array(skin.faces)
    angle = np.arccos(np.clip(points @ axis / 0.1, -1, 1))
    bag = angle < 0.14
    side = points - np.outer(points @ axis, axis)
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-12)
    round_back = np.pi - (np.pi - 0.9) * angle / 0.14  # on the eyeball, from the front: 0.9 at the rim, pi in the depth
    lined = centre + 1.02 * radius * (np.cos(round_back)[:, None] * axis + np.sin(round_back)[:, None] * side)
    points[bag] = lined[bag]
    eyeball = centre + radius * np.asarray(icosphere(subdivisions=2).vertices)

    closed = close_over_eye(points, faces, eyeball)
    moved = np.linalg.norm(closed - points, axis=1) > 1e-6
    assert moved.sum() > 0.6 * bag.sum() and not moved[~bag].any()
    np.testing.assert_allclose(np.linalg.norm(closed[moved] - centre, axis=1), radius, rtol=1e-6)
    front = (closed[moved] - centre) @ axis / radius
    assert front.min() > np.cos(1.2)
    surface = Trimesh(closed, faces, process=False)
    on_eye = moved[faces].all(axis=1)
    assert (np.sum(surface.face_normals[on_eye] * (surface.triangles_center[on_eye] - centre), axis=1) > 0).all()
