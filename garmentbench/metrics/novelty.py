"""Novelty: does the method know when it does not know?

A method may say of each frame how far the pose and its garment are from what it was trained on (`state.novelty`; 1: as
far as the farthest of its training frames are from the others).

    novelty_correlation = Spearman's rank correlation of novelty and error, over the frames of a roll-out    [1]
    novel_frames = 100 * share of frames whose novelty is above 1    [%]

1: the stranger a frame, the larger its error; 0: the warning says nothing of the error.

When it lies. Both grow along a roll-out that drifts, so they correlate over time without either knowing of the other,
and where errors are even, as on a steady walk, there is nothing to correlate: read it beside `novel_frames` and across
scenes. A method measures novelty with its own eyes; two methods' values are not of one scale. Frames after a roll-out
broke are not among them.
"""

import numpy as np
from jaxtyping import Float

from garmentbench.metrics.l2 import frame_l2
from garmentbench.metrics.metric import Metric, Motion


def rank_correlation(a: Float[np.ndarray, " frames"], b: Float[np.ndarray, " frames"]) -> float:
    """Spearman's rank correlation, over frames where both are finite; NaN where one of them does not vary."""
    from scipy.stats import rankdata

    finite = np.isfinite(a) & np.isfinite(b)
    if finite.sum() < 2 or np.ptp(a[finite]) == 0 or np.ptp(b[finite]) == 0:
        return float("nan")
    return float(np.corrcoef(rankdata(a[finite]), rankdata(b[finite]))[0, 1])


def _correlation(motion: Motion) -> float:
    assert motion.novelty is not None
    return rank_correlation(motion.novelty, frame_l2(motion.predicted, motion.reference))


def _novel(motion: Motion) -> float:
    assert motion.novelty is not None
    known = motion.novelty[np.isfinite(motion.novelty)]
    return 100 * float(np.mean(known > 1)) if len(known) else float("nan")


def _told(motion: Motion) -> bool:
    return motion.novelty is not None


NOVELTY_CORRELATION = Metric(
    "novelty_correlation", "1", "novelty and error", _correlation, _told, best="high", whole=False
)
NOVEL_FRAMES = Metric("novel_frames", "%", "novel frames", _novel, _told, whole=False)
