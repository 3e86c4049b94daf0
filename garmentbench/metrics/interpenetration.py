"""Interpenetration, as the paper counts it: how much of the garment is behind the skin.

    interpenetration = 100 / (T V) sum_t #{ i : (g_ti - b_tk) . n_tk < 0 }    [%],
    b_tk the body vertex nearest to g_ti, n_tk its normal

`interpenetration_before` is the same of the garment before the method's collision stage.

Source: section 6 of Zhang et al. 2022; o_t^ik of section 5.1.

When it lies. The tangent plane of the nearest *vertex* is not the surface: on a coarse body, cloth just outside a
concave place (armpit, crotch) counts as inside, and cloth just inside a sharp convex one as outside. It says nothing
about depth: a hundredth of a millimetre counts. Edges and faces of the garment between its vertices are not looked at.
`interpenetration_strict` and `depth_p95` go by the surface itself.
"""

import numpy as np
from jaxtyping import Bool, Float, Int

from garmentbench.geometry.mesh import corner_matrix, vertex_normals
from garmentbench.geometry.nearest import plane_distances
from garmentbench.metrics.metric import Metric, has_inside


def inside_vertices(
    garment: Float[np.ndarray, "frames vertices 3"],
    body: Float[np.ndarray, "frames body_vertices 3"],
    body_faces: Int[np.ndarray, "faces 3"],
) -> Bool[np.ndarray, "frames vertices"]:
    """Which garment vertices are behind the tangent plane of their nearest body vertex.

    Args:
        garment: [m], shape (T, V, 3), finite.
        body: [m], shape (T, B, 3).
        body_faces: Shape (K, 3), outward orientation.

    Returns:
        bool, shape (T, V).
    """
    corners = corner_matrix(body_faces, body.shape[1])
    normals = (vertex_normals(b, body_faces, corners) for b in body)
    return np.array([plane_distances(g, b, n) < 0 for g, b, n in zip(garment, body, normals, strict=True)])


def interpenetration(
    garment: Float[np.ndarray, "frames vertices 3"],
    body: Float[np.ndarray, "frames body_vertices 3"],
    body_faces: Int[np.ndarray, "faces 3"],
) -> float:
    """Share of garment vertices inside [%], mean over frames. Arguments as for `inside_vertices`."""
    return float(100 * inside_vertices(garment, body, body_faces).mean())


INTERPENETRATION = Metric(
    "interpenetration",
    "%",
    "inside",
    lambda m: interpenetration(m.predicted, m.body, m.template.body.faces),
    has_inside,
)
INTERPENETRATION_BEFORE = Metric(
    "interpenetration_before",
    "%",
    "inside before collision stage",
    lambda m: interpenetration(m.before_collision, m.body, m.template.body.faces),
    lambda m: has_inside(m) and m.before_collision is not None,
)
