"""The signed distance by Warp's queries against a plain one: all triangles, and exact solid angles."""

import numpy as np
import trimesh

from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.geometry.signed_distance import signed_distances


def plain_signed_distance(point, triangles):
    nearest = trimesh.triangles.closest_point(triangles, np.repeat(point[None], len(triangles), axis=0))
    a, b, c = (triangles[:, k] - point for k in range(3))
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    above = np.sum(a * np.cross(b, c), axis=1)
    below = la * lb * lc + np.sum(a * b, axis=1) * lc + np.sum(b * c, axis=1) * la + np.sum(c * a, axis=1) * lb
    winding = np.arctan2(above, below).sum() / (2 * np.pi)
    return np.linalg.norm(nearest - point, axis=1).min() * (-1 if winding > 0.5 else 1)


def test_all_triangles_and_solid_angles_say_the_same():
    sequence = tiny_sequence(6)
    rng = np.random.default_rng(0)
    points = (sequence.garment + rng.normal(scale=0.05, size=sequence.garment.shape)).astype(np.float32)
    faces = sequence.template.body.faces
    found = signed_distances(points, sequence.body, faces)
    triangles = sequence.body.astype(np.float64)[:, faces]
    plain = [
        [plain_signed_distance(p, t) for p in ps] for ps, t in zip(points.astype(np.float64), triangles, strict=True)
    ]
    assert 0.05 < np.mean(found < 0) < 0.5
    np.testing.assert_allclose(found, plain, atol=2e-6)


def test_where_faces_of_a_crease_are_equally_near():
    """Points on the planes that halve the angles of a star's deep creases: many faces tie for the nearest."""
    angle = np.arange(20) * np.pi / 10
    ring = np.where(np.arange(20) % 2, 0.2, 0.5)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    body = np.concatenate([np.insert(ring, 2, z, axis=1) for z in (-0.3, 0.3)] + [[[0, 0, -0.3], [0, 0, 0.3]]])
    i, j = np.arange(20), np.roll(np.arange(20), -1)
    faces = np.concatenate(
        [
            np.stack(f, axis=1)
            for f in ((i, j, i + 20), (j, j + 20, i + 20), (j, i, 0 * i + 40), (i + 20, j + 20, 0 * i + 41))
        ]
    )
    rng = np.random.default_rng(0)
    turn = angle[1::2][rng.integers(0, 10, 400)]
    out = rng.uniform(0.0, 0.6, 400)
    points = np.stack([out * np.cos(turn), out * np.sin(turn), rng.uniform(-0.25, 0.25, 400)], axis=1)
    body, points = body.astype(np.float32)[None], points.astype(np.float32)[None]
    found = signed_distances(points, body, faces.astype(np.int32))[0]
    assert ((found < 0) == (out < 0.2)).all()


def test_an_open_surface_has_no_inside_beyond_its_border():
    """A square in the plane z = 0: above, below, beside and slightly lower, below a corner."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    points = np.array([[0.5, 0.5, 0.1], [0.5, 0.4, -0.1], [1.1, 0.5, -0.05], [1.02, 1.02, -0.2]])
    found = signed_distances(points[None], square[None], np.array([[0, 1, 2], [0, 2, 3]]))[0]
    np.testing.assert_allclose(found, [0.1, -0.1, np.hypot(0.1, 0.05), -np.sqrt(0.0408)], rtol=1e-5)
