"""Stable frames: for how long the error stays what it was at first.

    the first predicted frame t with e_t > 4 median(e_0 ... e_49), or the number of predicted frames if there is none

e_t is the frame's l2; a position that is not finite counts as an error without bound.

When it lies. It asks for growth, not for quality: a method that is bad from the start is stable, and one that starts
almost perfect is punished for an ordinary error later. A motion that becomes harder after two seconds looks like
instability. The end of the recording is not the end of stability.
"""

import numpy as np

_FIRST, _FACTOR = 50, 4.0


def stable_frames(error: np.ndarray) -> int:
    """Number of frames before the error [any unit], shape (T,), first passes 4 times the median of its first 50."""
    bounded = np.where(np.isfinite(error), error, np.inf)
    passed = np.flatnonzero((bounded > _FACTOR * np.median(bounded[:_FIRST])) | np.isinf(bounded))
    return int(passed[0]) if len(passed) else len(error)
