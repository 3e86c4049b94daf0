"""Between a garment's vertices and a square map in its UV space.

Pixel (row y, column x) of a map of S x S pixels lies at u = (x + 0.5) / S, v = (y + 0.5) / S.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int


@dataclass(frozen=True)
class Chart:
    """The pixels that the garment covers in UV.

    Attributes:
        size: Pixels a side, S.
        pixels: Covered pixels, y * S + x, ascending, shape (P,).
        vertices: Corners of the triangle that covers each, shape (P, 3).
        weights: Barycentric weights of the corners, shape (P, 3).
    """

    size: int
    pixels: Int[np.ndarray, " covered"]
    vertices: Int[np.ndarray, "covered 3"]
    weights: Float[np.ndarray, "covered 3"]


def chart(uv: Float[np.ndarray, "vertices 2"], faces: Int[np.ndarray, "faces 3"], size: int) -> Chart:
    """Rasterise the garment in UV: a pixel is covered when its centre lies in a triangle (the first one counts).

    Args:
        uv: UV coordinates in [0, 1], shape (V, 2).
        faces: Triangles, shape (F, 3).
        size: Pixels a side.
    """
    corners = uv[faces].astype(np.float64) * size - 0.5  # in pixels, centres at whole numbers
    low = np.clip(np.ceil(corners.min(axis=1) - 1e-9), 0, size).astype(np.int64)
    high = np.clip(np.floor(corners.max(axis=1) + 1e-9) + 1, 0, size).astype(np.int64)
    width, height = np.maximum(high - low, 0).T
    count = width * height
    face = np.repeat(np.arange(len(faces)), count)
    nth = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    x, y = low[face, 0] + nth % width[face], low[face, 1] + nth // width[face]
    weights = _barycentric(corners[face], np.stack([x, y], axis=1))
    inside = np.flatnonzero((weights > -1e-9).all(axis=1))
    pixels, first = np.unique(y[inside] * size + x[inside], return_index=True)
    chosen = inside[first]
    return Chart(size, pixels, faces[face[chosen]].astype(np.int64), weights[chosen])


def _barycentric(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Barycentric weights, shape (K, 3), of points (K, 2) in triangles (K, 3, 2); -inf in a triangle without area."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    area = _cross(b - a, c - a)
    flat = np.abs(area) < 1e-12
    of_b, of_c = (_cross(points - a, c - a), _cross(b - a, points - a)) / np.where(flat, 1.0, area)
    weights = np.stack([1 - of_b - of_c, of_b, of_c], axis=1)
    weights[flat] = -np.inf
    return weights


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def bilinear_table(
    uv: Float[np.ndarray, "vertices 2"], size: int
) -> tuple[Int[np.ndarray, "vertices 4"], Float[np.ndarray, "vertices 4"]]:
    """The four pixels round each UV point and their bilinear weights.

    Args:
        uv: UV coordinates in [0, 1], shape (V, 2); beyond the outermost pixel centres the border value holds.
        size: Pixels a side.

    Returns:
        Pixels, y * S + x, shape (V, 4), and weights, shape (V, 4), adding up to 1.
    """
    at = np.clip(uv.astype(np.float64) * size - 0.5, 0, size - 1)
    low = np.minimum(np.floor(at).astype(np.int64), max(size - 2, 0))
    high = np.minimum(low + 1, size - 1)
    (fx, fy), (x0, y0), (x1, y1) = (at - low).T, low.T, high.T
    pixels = np.stack([y0 * size + x0, y0 * size + x1, y1 * size + x0, y1 * size + x1], axis=1)
    return pixels, np.stack([(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy], axis=1)
