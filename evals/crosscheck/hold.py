"""The body between two frames, and points held by it: what the other engine is told, in NumPy."""

from dataclasses import dataclass

import numpy as np


def hermite(p0: np.ndarray, p1: np.ndarray, m0: np.ndarray, m1: np.ndarray, u: float) -> np.ndarray:
    """Positions [m], shape (B, 3), at the fraction u of a frame, of those at its ends and their tangents [m a
    frame]."""
    w = 1.0 - u
    return w * w * ((1 + 2 * u) * p0 + u * m0) + u * u * ((3 - 2 * u) * p1 - w * m1)


@dataclass(frozen=True)
class Held:
    """Points fastened to faces of a surface, wherever they are.

    Attributes:
        corners: Vertices of each point's face, shape (P, 3).
        weights: Affine coordinates of each point's foot in its face, of any sign, shape (P, 3).
        height: Over the face, along its normal [m], shape (P,).
    """

    corners: np.ndarray
    weights: np.ndarray
    height: np.ndarray

    def at(self, surface: np.ndarray) -> np.ndarray:
        """Positions [m], shape (P, 3), on a surface's vertices [m], shape (B, 3)."""
        a, b, c = surface[self.corners].transpose(1, 0, 2)
        foot = np.einsum("pk,pkd->pd", self.weights, surface[self.corners])
        return foot + self.height[:, None] * _unit(np.cross(b - a, c - a))


def fasten(points: np.ndarray, faces: np.ndarray, surface: np.ndarray) -> Held:
    """Fasten points [m], shape (P, 3), each to the face whose centre is nearest.

    surface: vertices [m], shape (B, 3).
    """
    from scipy.spatial import KDTree

    corners = faces[KDTree(surface[faces].mean(axis=1)).query(points)[1]] if len(points) else np.zeros((0, 3), int)
    a, b, c = surface[corners].transpose(1, 0, 2)
    normal, away = np.cross(b - a, c - a), points - a
    area = (normal**2).sum(axis=1)
    v = (np.cross(away, c - a) * normal).sum(axis=1) / area
    w = (np.cross(b - a, away) * normal).sum(axis=1) / area
    return Held(corners, np.stack([1 - v - w, v, w], axis=1), (away * _unit(normal)).sum(axis=1))


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
