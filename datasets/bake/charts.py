"""UV charts: each panel is flattened with as little distortion as possible, then both are laid side by side."""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import factorized, spsolve
from surface import border_loop, edges

MARGIN = 0.03  # of the UV square, round each chart


def disk_map(points: np.ndarray, faces: np.ndarray, border: np.ndarray) -> np.ndarray:
    """Tutte's map to the unit disk, the border by arc length; it never flips a triangle. Shape (V, 2)."""
    steps = np.linalg.norm(np.roll(points[border], -1, axis=0) - points[border], axis=1)
    angle = 2 * np.pi * (np.cumsum(steps) - steps) / steps.sum()
    a, b = edges(faces)[0].T
    adjacency = sp.csr_array((np.ones(2 * len(a)), (np.append(a, b), np.append(b, a))), (len(points),) * 2)
    laplacian = sp.csr_array(sp.diags_array(adjacency.sum(axis=1)) - adjacency)
    inner = np.setdiff1d(np.arange(len(points)), border)
    flat = np.zeros((len(points), 2))
    flat[border] = np.column_stack([np.cos(angle), np.sin(angle)])
    flat[inner] = spsolve(sp.csc_array(laplacian[inner][:, inner]), -(laplacian[inner][:, border] @ flat[border]))
    return flat


def flatten(points: np.ndarray, faces: np.ndarray, rounds: int = 100) -> np.ndarray:
    """Flatten a disk as rigidly as possible (Liu et al. 2008, local/global), in metres, shape (V, 2)."""
    local, cotangents = in_their_planes(points[faces])
    i, j = faces, np.roll(faces, -1, axis=1)
    weights = sp.coo_array((cotangents.ravel(), (i.ravel(), j.ravel())), (len(points),) * 2)
    weights = sp.csr_array(weights + weights.T)
    # The tiny diagonal fixes where the chart lies, which the energy leaves open.
    solve = factorized(sp.csc_array(sp.diags_array(weights.sum(axis=1) + 1e-9) - weights))
    a, b, c = points[faces].transpose(1, 0, 2)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    flat = disk_map(points, faces, border_loop(faces)) * np.sqrt(area / np.pi)
    wanted = local - np.roll(local, -1, axis=1)
    for _ in range(rounds):
        present = flat[i] - flat[j]
        mixed = np.einsum("fe,fex,fey->xyf", cotangents, present, wanted)
        cosine, sine = mixed[0, 0] + mixed[1, 1], mixed[1, 0] - mixed[0, 1]
        rotations = np.array([[cosine, -sine], [sine, cosine]]) / np.hypot(
            cosine, sine
        )  # nearest to `mixed`, shape (2, 2, F)
        pull = cotangents[..., None] * np.einsum("xyf,fey->fex", rotations, wanted)
        sums = np.zeros_like(flat)
        np.add.at(sums, i, pull)
        np.add.at(sums, j, -pull)
        flat = np.column_stack([solve(column) for column in sums.T])
    return flat


def in_their_planes(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles, shape (F, 3, 3), in coordinates of their own planes, shape (F, 3, 2), and the cotangents of the angles
    opposite the edges 01, 12, 20, shape (F, 3), at least 0.02 so that the flattening stays definite."""
    a, b, c = corners.transpose(1, 0, 2)
    x = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
    normal = np.cross(b - a, c - a)
    y = np.cross(normal / np.linalg.norm(normal, axis=1, keepdims=True), x)
    local = np.einsum("fcx,fkx->fck", corners - a[:, None], np.stack([x, y], axis=1))
    to_first, to_second = local - np.roll(local, 1, axis=1), np.roll(local, -1, axis=1) - np.roll(local, 1, axis=1)
    twice_area = np.linalg.norm(normal, axis=1, keepdims=True)
    return local, np.maximum((to_first * to_second).sum(axis=2) / twice_area, 0.02)


def turn(flat: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Rotate a chart so that it lies as near as it can to `target`, both of shape (V, 2)."""
    u, _, vt = np.linalg.svd((flat - flat.mean(0)).T @ (target - target.mean(0)))
    return flat @ (u @ np.diag([1, np.linalg.det(u @ vt)]) @ vt)


def side_by_side(charts: list[np.ndarray]) -> list[np.ndarray]:
    """Lay charts beside each other in the unit square and scale them to fill it, all by the same two factors.

    Filling the square (rather than keeping angles) wastes fewer texels of the maps that are drawn through the charts.
    """
    return in_columns([[chart] for chart in charts])


def in_columns(columns: list[list[np.ndarray]]) -> list[np.ndarray]:
    """As `side_by_side`, with charts above one another in each column; the lowest comes first."""
    sizes = [np.array([np.ptp(chart, axis=0) for chart in column]) for column in columns]
    width = sum(column[:, 0].max() for column in sizes)
    scale_x = (1 - (len(columns) + 1) * MARGIN) / width
    scale_y = min((1 - (len(column) + 1) * MARGIN) / column[:, 1].sum() for column in sizes)
    placed, left = [], MARGIN
    for column, size in zip(columns, sizes, strict=True):
        wide, high = size[:, 0].max() * scale_x, size[:, 1] * scale_y
        gap = (1 - high.sum()) / (len(column) + 1)
        bottom = gap
        for chart, height in zip(column, high, strict=True):
            middle = (chart.max(0) + chart.min(0)) / 2
            placed.append((chart - middle) * [scale_x, scale_y] + [left + wide / 2, bottom + height / 2])
            bottom += height + gap
        left += wide + MARGIN
    return placed
