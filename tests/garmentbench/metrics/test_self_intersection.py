"""Which faces cross, by hand and against a plain test of all pairs."""

import numpy as np
import pytest

from garmentbench.geometry.crossing import crossing_faces
from garmentbench.metrics.self_intersection import self_intersection

NO_SEAMS = np.zeros((0, 2), np.int32)
FLAT = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


def crossing(*triangles, seams=NO_SEAMS) -> list[bool]:
    """Of triangles that share no vertex."""
    points = np.array(triangles, np.float32).reshape(1, -1, 3)
    return crossing_faces(points, np.arange(points.shape[1], dtype=np.int32).reshape(-1, 3), seams)[0].tolist()


@pytest.mark.parametrize(
    ("other", "cross"),
    [
        ([[0.2, 0.2, -0.5], [0.2, 0.2, 0.5], [2.0, 2.0, 0.5]], True),  # an edge goes through the flat one
        ([[0.5, -0.5, -0.5], [0.5, -0.5, 0.5], [0.5, 2.0, 0.0]], True),  # the flat one's edges go through it
        ([[0.2, 0.2, 1e-4], [0.2, 0.2, 0.5], [2.0, 2.0, 0.5]], False),  # just above
        ([[0.8, 0.8, -0.5], [0.8, 0.8, 0.5], [2.0, 2.0, 0.5]], False),  # through the plane, beside the triangle
        ([[0.1, 0.1, 0], [0.3, 0.1, 0], [0.1, 0.3, 0]], False),  # in the plane
        ([[0.2, 0.2, 0], [0.2, 0.3, 0.5], [0.3, 0.3, 0.5]], False),  # touches with a corner
    ],
)
def test_two_triangles(other, cross):
    assert crossing(FLAT, other) == [cross, cross]
    assert crossing(other, FLAT) == [cross, cross]
    assert crossing(np.array(FLAT) * 1e-2, np.array(other) * 1e-2) == [cross, cross]


def test_faces_that_share_a_point_of_cloth_are_not_looked_at():
    other = [[0.2, 0.2, -0.5], [0.2, 0.2, 0.5], [2.0, 2.0, 0.5]]
    assert crossing(FLAT, other, seams=np.array([[1, 5]])) == [False, False]
    points = np.array([[*FLAT, [0.2, 0.2, -0.5], [0.2, 0.2, 0.5]]], np.float32)
    assert not crossing_faces(points, np.array([[0, 1, 2], [3, 4, 1]]), NO_SEAMS).any()


def test_share_is_over_faces_and_frames():
    above, through = np.array(FLAT) + [0, 0, 1], [[0.2, 0.2, -0.5], [0.2, 0.2, 0.5], [2.0, 2.0, 0.5]]
    frames = np.array([[*FLAT, *above, *(np.array(FLAT) + [0, 0, 2])]] * 4, np.float32)
    frames[2, 3:6] = through
    found = crossing_faces(frames, np.arange(9).reshape(3, 3), NO_SEAMS)
    assert self_intersection(found) == pytest.approx(100 * 2 / 12)


def plain_crossing(points, faces):
    """All pairs, each edge against each triangle by solving for where it meets the plane."""
    found = np.zeros(len(faces), bool)
    for i in range(len(faces)):
        for j in range(len(faces)):
            if set(faces[i]) & set(faces[j]):
                continue
            a, b, c = points[faces[j]]
            for k in range(3):
                p, q = points[faces[i][k]], points[faces[i][(k + 1) % 3]]
                t, u, v = np.linalg.solve(np.column_stack([p - q, b - a, c - a]), p - a)
                if 0 < t < 1 and u > 0 and v > 0 and u + v < 1:
                    found[[i, j]] = True
    return found


def test_all_pairs_say_the_same_and_a_rigid_motion_changes_nothing():
    rng = np.random.default_rng(0)
    points, faces = (
        rng.uniform(size=(40, 3)).astype(np.float32),
        rng.permuted(np.tile(np.arange(40), (30, 1)), axis=1)[:, :3],
    )
    points = points.astype(np.float64)
    points[faces[:, 1:]] = points[faces[:, 1:]] * 0.3 + points[faces[:, :1]] * 0.7
    found = crossing_faces(points[None].astype(np.float32), faces, NO_SEAMS)[0]
    assert 4 < found.sum() < 28
    assert found.tolist() == plain_crossing(points.astype(np.float32).astype(np.float64), faces).tolist()
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    moved = (points @ turn.T + [100, 5, 0])[None]
    assert crossing_faces(moved, faces, NO_SEAMS)[0].tolist() == found.tolist()
