"""The nearest body vertex of each garment vertex."""

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import KDTree


def nearest_vertices(
    points: Float[np.ndarray, "points 3"], vertices: Float[np.ndarray, "vertices 3"]
) -> tuple[Float[np.ndarray, " points"], Int[np.ndarray, " points"]]:
    """Nearest vertex of each point.

    Args:
        points: [m], shape (P, 3), finite.
        vertices: [m], shape (B, 3).

    Returns:
        Distances [m], shape (P,), and indices into `vertices`, shape (P,).
    """
    # Built for one query: a balanced tree takes half as long again, and finds the same.
    distances, indices = KDTree(vertices, balanced_tree=False).query(points)
    return np.asarray(distances), np.asarray(indices)


def plane_distances(
    points: Float[np.ndarray, "points 3"],
    vertices: Float[np.ndarray, "vertices 3"],
    normals: Float[np.ndarray, "vertices 3"],
) -> Float[np.ndarray, " points"]:
    """Signed distance [m], shape (P,), of each point to the tangent plane of its nearest vertex; negative: behind it.

    Source: o_t^ik of section 5.1 of Zhang et al. 2022.
    """
    _, nearest = nearest_vertices(points, vertices)
    return np.sum((points - vertices[nearest]) * normals[nearest], axis=-1)
