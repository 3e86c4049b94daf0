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
from garmentbench.metrics.metric import Metric, Motion, has_inside


def inside_vertices(
    garment: Float[np.ndarray, "frames vertices 3"],
    body: Float[np.ndarray, "frames body_vertices 3"],
    body_faces: Int[np.ndarray, "faces 3"],
    wanted: Bool[np.ndarray, "frames vertices"] | None = None,
) -> Bool[np.ndarray, "frames vertices"]:
    """Which garment vertices are behind the tangent plane of their nearest body vertex.

    Args:
        garment: [m], shape (T, V, 3), finite.
        body: [m], shape (T, B, 3).
        body_faces: Shape (K, 3), outward orientation.
        wanted: Which are asked for, shape (T, V); the others are outside. None: all.

    Returns:
        bool, shape (T, V).
    """
    corners, inside = corner_matrix(body_faces, body.shape[1]), np.zeros(garment.shape[:2], bool)
    for t, (g, b) in enumerate(zip(garment, body, strict=True)):
        asked = slice(None) if wanted is None else wanted[t]
        inside[t, asked] = plane_distances(g[asked], b, vertex_normals(b, body_faces, corners)) < 0
    return inside


def interpenetration(inside: Bool[np.ndarray, "frames vertices"]) -> float:
    """Share of garment vertices inside [%], mean over frames, shape (T, V)."""
    return float(100 * inside.mean())


def _inside(predicted: np.ndarray, motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Which vertices are inside, of the prediction and of that before the collision stage, where it has one; what that
    has left alone is not looked at twice."""
    before, body, template = motion.before_collision, motion.body, motion.template
    assert body is not None and template.body is not None
    if before is None:
        inside = inside_vertices(predicted, body, template.body.faces)
        return inside, inside
    changed = (before != predicted).any(axis=2)
    both, wanted = np.concatenate([predicted, before], 1), np.concatenate([np.ones_like(changed), changed], 1)
    inside, inside_before = np.split(inside_vertices(both, body, template.body.faces, wanted), 2, axis=1)
    return inside, np.where(changed, inside_before, inside)


INTERPENETRATION = Metric(
    "interpenetration",
    "%",
    "inside",
    lambda m: interpenetration(m.once(_inside, m.predicted)[0]),
    has_inside,
)
INTERPENETRATION_BEFORE = Metric(
    "interpenetration_before",
    "%",
    "inside before collision stage",
    lambda m: interpenetration(m.once(_inside, m.predicted)[1]),
    lambda m: has_inside(m) and m.before_collision is not None,
)
