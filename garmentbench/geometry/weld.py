"""Sewing a mesh together along its seams: vertices that seams join become one point."""

import numpy as np
import scipy.sparse as sp
from jaxtyping import Float, Int
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from garmentbench.geometry.mesh import border_vertices

TOGETHER = 2e-5  # [m] at rest; OBJ files round to a micrometre, the shortest edges of dense meshes are 0.1 mm


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


def touching_borders(
    rest: Float[np.ndarray, "vertices 3"], faces: Int[np.ndarray, "faces 3"], distance: float
) -> Int[np.ndarray, "pairs 2"]:
    """Pairs of vertices on borders that lie within a distance [m] of each other, shape (S, 2), int64."""
    border = border_vertices(faces)
    if not len(border):
        return np.zeros((0, 2), np.int64)
    return border[KDTree(rest[border]).query_pairs(distance, output_type="ndarray")].astype(np.int64)


def sewing_pairs(pairs: Int[np.ndarray, "pairs 2"], vertices: int) -> Int[np.ndarray, "seams 2"]:
    """Seams that join what the pairs join: each vertex of a cluster with its first one, shape (S, 2), int32."""
    point, _ = weld(vertices, pairs)
    _, first = np.unique(point, return_index=True)
    others = np.setdiff1d(np.arange(vertices), first)
    return np.stack([first[point[others]], others], axis=1).astype(np.int32)
