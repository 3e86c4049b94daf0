"""Seam pairs: vertices that are the same point of cloth, because the UV map cuts there or because they never part."""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

TOGETHER = 2e-5  # [m] at rest; OBJ files round to a micrometre, the shortest edges of dense meshes are 0.1 mm
SEWN = 1e-3  # [m] in every frame


def seam_pairs(origin: np.ndarray, faces: np.ndarray, rest: np.ndarray, frames: np.ndarray) -> np.ndarray:
    """Pairs of vertices that are sewn together.

    Args:
        origin: Vertices of the same number were one vertex before the UV map was cut, shape (V,).
        faces: Shape (F, 3).
        rest: Rest positions [m], shape (V, 3).
        frames: Positions [m], shape (T, V, 3).

    Returns:
        Shape (S, 2), int32; of vertices that are all the same point each is paired with the first.
    """
    order = np.argsort(origin, kind="stable")
    same = origin[order][1:] == origin[order][:-1]
    cut = np.stack([order[:-1][same], order[1:][same]], axis=1)
    return _stars(np.concatenate([cut, _touching(_border(faces), rest, frames)]), len(rest))


def _border(faces: np.ndarray) -> np.ndarray:
    """Vertices on edges of one face."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    unique, counts = np.unique(edges, axis=0, return_counts=True)
    return np.unique(unique[counts == 1])


def _touching(border: np.ndarray, rest: np.ndarray, frames: np.ndarray) -> np.ndarray:
    """Pairs on the border that coincide at rest and never part."""
    if not len(border):
        return np.zeros((0, 2), np.int64)
    pairs = border[cKDTree(rest[border]).query_pairs(TOGETHER, output_type="ndarray")]
    for frame in frames:
        if not len(pairs):
            break
        gap = np.linalg.norm(frame[pairs[:, 0]] - frame[pairs[:, 1]], axis=1)
        pairs = pairs[gap <= SEWN]
    return pairs


def _stars(pairs: np.ndarray, count: int) -> np.ndarray:
    """Each vertex of a cluster with the cluster's first one."""
    graph = sp.coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), (count, count))
    _, cluster = connected_components(graph, directed=False)
    _, first = np.unique(cluster, return_index=True)
    others = np.setdiff1d(np.arange(count), first)
    return np.stack([first[cluster[others]], others], axis=1).astype(np.int32)
