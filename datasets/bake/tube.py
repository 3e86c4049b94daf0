"""Tubes of cloth that hang from the waist: the hull of what is beneath, seen from an axis, and rings round it."""

import numpy as np
from scipy.spatial import ConvexHull

from garmentbench.scenes.bodies import load_body

AXIS = np.array([0.0, -0.02])  # [m] x, y of a vertical axis that is inside every slice from the waist down
WAIST = 1.165  # [m] height where the base body is narrowest
ARMS = ("fore_arm", "rear_arm")


def without_arms() -> tuple[np.ndarray, np.ndarray]:
    """Points [m] and faces of the base body, less the arms, which hang beside the hips."""
    baked = load_body("base", "full").body
    arms = np.isin(baked.labels, [baked.part_names.index(part) for part in ARMS])
    return baked.rest.astype(float), baked.faces[~arms[baked.faces].any(axis=1)]


def hull_radius(points: np.ndarray, faces: np.ndarray, heights: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """How far the convex hull of a surface's slice reaches from the axis [m], shape (heights, angles).

    Nothing gets narrower further down, as cloth hangs straight below the widest place.

    Args:
        points: shape (V, 3); faces: shape (F, 3).
        heights: Falling [m], shape (H,).
        angles: From x towards y, shape (A,).
    """
    a, b = points[faces.ravel()], points[np.roll(faces, 1, axis=1).ravel()]
    toward = np.column_stack([np.cos(angles), np.sin(angles)])
    radius = np.empty((len(heights), len(angles)))
    for row, z in enumerate(heights):
        crossing = (a[:, 2] < z) != (b[:, 2] < z)
        low, high = a[crossing], b[crossing]
        share = (z - low[:, 2]) / (high[:, 2] - low[:, 2])
        sides = ConvexHull((low + share[:, None] * (high - low))[:, :2] - AXIS).equations
        with np.errstate(divide="ignore"):
            reach = -sides[:, 2] / (toward @ sides[:, :2].T)
        radius[row] = np.where(reach > 0, reach, np.inf).min(axis=1)
    return np.maximum.accumulate(radius, axis=0)


def flutes(ring: np.ndarray, count: int) -> np.ndarray:
    """A wave round a closed ring, shape (R, 2) [m]: 0 to 1, shape (R,), equally long along it, the same left and right
    of the middle of the front, where it is 1."""
    steps = np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1)
    along = np.cumsum(steps) - steps
    front = along[np.argmin(ring[:, 1])]  # the body faces -y
    return 0.5 + 0.5 * np.cos(2 * np.pi * count * (along - front) / steps.sum())


def grid_faces(number: np.ndarray, first: int = 0) -> np.ndarray:
    """Two triangles a cell of a grid of vertex numbers, diagonals like a chequerboard; outward where rows go down and
    columns counterclockwise seen from above. `first`: the number of its first row, so that the chequerboard goes on
    from one strip to the next."""
    a, b, c, d = (corner.ravel() for corner in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    rows, columns = map(np.arange, np.subtract(number.shape, 1))
    falling = (np.add.outer(rows + first, columns) % 2 == 0).ravel()[:, None]
    one = np.where(falling, np.stack([a, b, c], 1), np.stack([a, b, d], 1))
    other = np.where(falling, np.stack([a, c, d], 1), np.stack([b, c, d], 1))
    return np.concatenate([one, other])
