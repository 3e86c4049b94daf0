"""Stable frames: for how long the error stays what it was at first.

    stable_frames = the first predicted frame t with e_t > 4 median(e_0 ... e_49), or, if there is none, the number of
    predicted frames    [frames]

e_t is the frame's l2; a position that is not finite counts as an error without bound.

When it lies. It asks for growth, not for quality: a method that is bad from the start is stable, and one that starts
almost perfect is punished for an ordinary error later. A motion that becomes harder after two seconds looks like
instability. The end of the recording is not the end of stability.
"""

import numpy as np
from jaxtyping import Float

from garmentbench.metrics.l2 import frame_l2
from garmentbench.metrics.metric import Metric

_FIRST, _FACTOR = 50, 4.0


def stable_frames(error: Float[np.ndarray, " frames"]) -> int:
    """Number of frames before the error [any unit], shape (T,), first passes 4 times the median of its first 50."""
    bounded = np.where(np.isfinite(error), error, np.inf)
    passed = np.flatnonzero((bounded > _FACTOR * np.median(bounded[:_FIRST])) | np.isinf(bounded))
    return int(passed[0]) if len(passed) else len(error)


STABLE_FRAMES = Metric(
    "stable_frames",
    "frames",
    "stable",
    lambda m: float(stable_frames(frame_l2(m.predicted, m.reference))),
    best="high",
    whole=False,
)
