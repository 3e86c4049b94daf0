"""Skin through faces: is the body inside the cloth between its vertices, too?

    faces_inside = 100 / (T N) #{ (t, n) : d_tn < 0 }    [%]
    skin_frames = 100 / T #{ t : min_n d_tn < -0.5 mm }    [%]

n goes over the N middles of edges and centres of faces, d is their signed distance to the body's surface [m]
(`garmentbench.geometry.signed_distance`). Skin shows where a body's bulge is higher than the cloth's straight face over
it, though all three corners are outside: the vertices' own share, `interpenetration_strict`, doesn't see that.

When it lies. Between those points nothing is looked at: a fine body's sharp bump can pass beside them. The number of
points grows with the mesh, so `skin_frames`, which asks for one of them, is stricter on finer cloth. Where the body
passes through itself (an arm in the trunk), cloth caught in between may count as outside, and a single frame of contact
between two skins counts as a frame with skin through.
"""

import numpy as np
from jaxtyping import Float

from garmentbench.metrics.metric import Metric, has_inside

THROUGH = 5e-4  # [m]


def faces_inside(distances: Float[np.ndarray, "frames points"]) -> float:
    """Share of points between the vertices that are inside [%], of signed distances [m], shape (T, N)."""
    return float(100 * (distances < 0).mean())


def skin_frames(distances: Float[np.ndarray, "frames points"]) -> float:
    """Share of frames in which a point is more than 0.5 mm inside [%], of signed distances [m], shape (T, N)."""
    return float(100 * (distances.min(axis=1, initial=np.inf) < -THROUGH).mean())


FACES_INSIDE = Metric("faces_inside", "%", "faces inside", lambda m: faces_inside(m.distances_between), has_inside)
SKIN_FRAMES = Metric(
    "skin_frames", "%", "frames with skin through", lambda m: skin_frames(m.distances_between), has_inside
)
