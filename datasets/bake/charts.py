"""UV charts: each panel is flattened with as little distortion as possible, then both are laid side by side."""

import gpytoolbox
import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import factorized, spsolve

MARGIN = 0.03  # of the UV square, round each chart


def border_loop(faces: np.ndarray) -> np.ndarray:
    """The border of a disk, in the faces' direction, shape (B,)."""
    following = {}
    directed = set(map(tuple, faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).tolist()))
    following = {a: b for a, b in directed if (b, a) not in directed}
    start = min(following)
    loop = [start]
    while following[loop[-1]] != start:
        loop.append(following[loop[-1]])
    assert len(loop) == len(following), "a panel must be a disk"
    return np.array(loop)


def disk_map(points: np.ndarray, faces: np.ndarray, border: np.ndarray) -> np.ndarray:
    """Tutte's map to the unit disk with mean-value-free, uniform weights, border by arc length: never flips. Shape (V, 2)."""
    steps = np.linalg.norm(np.roll(points[border], -1, axis=0) - points[border], axis=1)
    angle = 2 * np.pi * np.concatenate([[0], np.cumsum(steps)[:-1]]) / steps.sum()
    adjacency = gpytoolbox.adjacency_matrix(faces).astype(float)
    adjacency.data[:] = 1
    laplacian = sp.diags(np.asarray(adjacency.sum(1)).ravel()) - adjacency
    inner = np.setdiff1d(np.arange(len(points)), border)
    flat = np.zeros((len(points), 2))
    flat[border] = np.column_stack([np.cos(angle), np.sin(angle)])
    laplacian = laplacian.tocsr()[inner]
    flat[inner] = spsolve(laplacian[:, inner].tocsc(), -laplacian[:, border] @ flat[border])
    return flat


def flatten(points: np.ndarray, faces: np.ndarray, rounds: int = 100) -> np.ndarray:
    """As-rigid-as-possible flattening (Liu et al. 2008), in metres, shape (V, 2)."""
    a, b, c = points[faces].transpose(1, 0, 2)
    x = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
    normal = np.cross(b - a, c - a)
    y = np.cross(normal / np.linalg.norm(normal, axis=1, keepdims=True), x)
    local = np.stack([np.stack([((p - a) * x).sum(1), ((p - a) * y).sum(1)], -1) for p in (a, b, c)], 1)
    flat = disk_map(points, faces, border_loop(faces))
    area = np.linalg.norm(normal, axis=1).sum() / 2
    flat *= np.sqrt(area / np.pi)
    # Half-edges i -> j opposite corner k, with cotangent weights.
    ends = [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
    cot = []
    for i, j, k in ends:
        u, v = local[:, i] - local[:, k], local[:, j] - local[:, k]
        cot.append((u * v).sum(1) / np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]))
    cot = np.maximum(np.stack(cot, 1), 0.02)
    rows = np.concatenate([faces[:, i] for i, _, _ in ends])
    cols = np.concatenate([faces[:, j] for _, j, _ in ends])
    weights = sp.coo_matrix((cot.T.ravel(), (rows, cols)), (len(points),) * 2)
    weights = (weights + weights.T).tocsr()
    laplacian = sp.diags(np.asarray(weights.sum(1)).ravel()) - weights + 1e-9 * sp.eye(len(points))
    solve = factorized(laplacian.tocsc())
    for _ in range(rounds):
        covariance = np.zeros((len(faces), 2, 2))
        for e, (i, j, _) in enumerate(ends):
            d2, d3 = flat[faces[:, i]] - flat[faces[:, j]], local[:, i] - local[:, j]
            covariance += cot[:, e, None, None] * d2[:, :, None] * d3[:, None, :]
        u, _, vt = np.linalg.svd(covariance)
        u[:, :, 1] *= np.linalg.det(u @ vt)[:, None]
        rotation = u @ vt
        right = np.zeros_like(flat)
        for e, (i, j, _) in enumerate(ends):
            pull = cot[:, e, None] * np.einsum("fij,fj->fi", rotation, local[:, i] - local[:, j])
            np.add.at(right, faces[:, i], pull)
            np.add.at(right, faces[:, j], -pull)
        flat = np.column_stack([solve(right[:, 0]), solve(right[:, 1])])
    return flat


def turn(flat: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Rotate a chart so that it lies as near as it can to `target`, both of shape (V, 2)."""
    u, _, vt = np.linalg.svd((flat - flat.mean(0)).T @ (target - target.mean(0)))
    return flat @ (u @ np.diag([1, np.linalg.det(u @ vt)]) @ vt)


def side_by_side(charts: list[np.ndarray]) -> list[np.ndarray]:
    """Lay charts beside each other in the unit square and scale them to fill it, all by the same two factors.

    Filling the square (rather than keeping angles) wastes fewer texels of the maps that are drawn through the charts.
    """
    sizes = np.array([np.ptp(chart, axis=0) for chart in charts])
    scale = (1 - np.array([len(charts) + 1, 2]) * MARGIN) / [sizes[:, 0].sum(), sizes[:, 1].max()]
    starts = MARGIN + np.concatenate([[0], np.cumsum(sizes[:-1, 0] * scale[0] + MARGIN)])
    return [
        (chart - (chart.max(0) + chart.min(0)) / 2) * scale + [start + size[0] * scale[0] / 2, 0.5]
        for chart, start, size in zip(charts, starts, sizes)
    ]
