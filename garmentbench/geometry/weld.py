"""Sewing a mesh together along its seams: vertices that seams join become one point."""

import numpy as np
import scipy.sparse as sp
from jaxtyping import Int
from scipy.sparse.csgraph import connected_components


def weld(vertices: int, seams: Int[np.ndarray, "seams 2"]) -> tuple[Int[np.ndarray, " vertices"], int]:
    """Points of a sewn mesh.

    Args:
        vertices: Number of vertices V.
        seams: Vertex pairs that are joined, shape (S, 2).

    Returns:
        The point that each vertex belongs to, shape (V,), int32, and the number of points.
    """
    pairs = np.asarray(seams, np.int64).reshape(-1, 2)
    graph = sp.coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(vertices, vertices))
    count, point = connected_components(graph, directed=False)
    return point.astype(np.int32), count
