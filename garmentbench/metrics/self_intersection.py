"""Self-intersection: how much of the garment passes through itself.

    self_intersection = 100 / (T F) sum_t #{ f : face f crosses another that shares no point of cloth with it }    [%]
    crossing_faces_max = the largest number of them in a frame    [faces]

`garmentbench.geometry.crossing` says when two triangles cross.

When it lies. Faces are counted, not depths: a corner through by a hundredth of a millimetre counts like a sleeve pulled
inside out, and a coarse mesh has larger faces, hence a larger share for the same tangle. Faces that share a vertex are
not looked at, so a crease folded through itself at one vertex is not seen, nor is cloth that merely touches or lies
exactly in one plane. A rest shape that crosses itself counts in every frame. Of two layers each is measured alone: the
inner garment through the outer one is `interpenetration`.
"""

import numpy as np
from jaxtyping import Bool

from garmentbench.metrics.metric import Metric


def self_intersection(crossing: Bool[np.ndarray, "frames faces"]) -> float:
    """Share of faces that cross another [%], mean over frames, shape (T, F)."""
    return float(100 * crossing.mean())


SELF_INTERSECTION = Metric("self_intersection", "%", "faces through others", lambda m: self_intersection(m.crossing))
CROSSING_FACES_MAX = Metric(
    "crossing_faces_max", "faces", "most faces through others", lambda m: float(m.crossing.sum(axis=1).max())
)
