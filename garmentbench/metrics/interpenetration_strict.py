"""Interpenetration by signed distance to the body's surface: how much is inside, and how deep.

    interpenetration_strict = 100 / (T V) #{ (t, i) : d_ti < 0 }    [%]
    depth_p95 = 95th percentile of -1000 d_ti over the vertices inside, 0 if none is    [mm]

d is the signed distance [m] of a garment vertex to the nearest point of the body's triangles, negative inside
(`garmentbench.geometry.signed_distance`).

When it lies. Where the body passes through itself (an arm in the trunk) the nearest surface decides, and cloth caught
in between may count as outside. `depth_p95` is over the vertices inside only: one deep vertex looks worse than a
thousand shallow ones, so read it beside the share. Garment edges and faces between the vertices are not looked at.
"""

import numpy as np
from jaxtyping import Float

from garmentbench.metrics.interpenetration import INTERPENETRATION
from garmentbench.metrics.metric import Metric, has_inside


def interpenetration_strict(distances: Float[np.ndarray, "frames vertices"]) -> float:
    """Share of vertices inside [%], of signed distances [m], shape (T, V)."""
    return float(100 * (distances < 0).mean())


def depth_p95(distances: Float[np.ndarray, "frames vertices"]) -> float:
    """95th percentile of the depth of the vertices inside [mm], of signed distances [m], shape (T, V); 0 if none is."""
    inside = distances[distances < 0]
    return float(np.percentile(-1e3 * inside.astype(np.float64), 95)) if inside.size else 0.0


INTERPENETRATION_STRICT = Metric(
    "interpenetration_strict", "%", "inside, strict", lambda m: interpenetration_strict(m.distances), has_inside
)
DEPTH_P95 = Metric("depth_p95", "mm", "depth, 95th percentile", lambda m: depth_p95(m.distances), has_inside)
PENETRATION = (INTERPENETRATION, INTERPENETRATION_STRICT, DEPTH_P95)  # of a finished garment
