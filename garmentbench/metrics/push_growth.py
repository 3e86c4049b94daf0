"""Push growth: what becomes of a push of a millimetre. Is the cloth contracting or chaotic?

    push_growth = mean over pushed runs y, and frames t of the last fifth, of 1/V sum_i |y_ti - x_ti| / push    [1]

x is the first run, push how far every vertex of the others was moved, before the warm-up or at frame 0. At most 1:
the cloth has forgotten it, the scene is *contracting*, and a single run can stand for all. Above 1: the push has
grown, the scene is *chaotic*, and only the ensemble says how near a prediction could come.

When it lies. A push grows until folds have fallen another way, then no further: 30 on a small garment may be as
hopeless as 100 on a large one; read `spread`. A long calm end lets cloth forget what was chaotic before, a wild one
makes any scene chaotic: it is a property of the recording, not of the garment alone. Friction keeps some of a push
for ever, and the mean hides a hem that flips where all else lies still. The step's own error is not in it.
"""

import math
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from garmentbench.metrics.l2 import frame_l2
from garmentbench.metrics.metric import Metric
from garmentbench.metrics.spread import finite_runs

CHAOTIC_ABOVE = 1.0
LAST = 0.2  # of the frames


def push_growth(
    first: Float[np.ndarray, "frames vertices 3"],
    pushed: Sequence[Float[np.ndarray, "frames vertices 3"]],
    push: float,
) -> float:
    """The push's growth over the whole recording.

    Args:
        first: The run itself [m], shape (T, V, 3).
        pushed: Runs that were pushed [m], each of shape (T, V, 3).
        push: By how much [m].

    Returns:
        The mean distance in the last fifth of the frames over the push; NaN where no pushed run is finite there.
    """
    late = slice(len(first) - math.ceil(LAST * len(first)), None)
    apart = [frame_l2(run, first[late]).mean() for run in finite_runs([run[late] for run in pushed])]
    return float(np.mean(apart)) / (100 * push) if apart else math.nan


def regime(growth: float | None) -> str:
    """What that makes of a scene, in a word, "contracting" or "chaotic"; "unknown" for None or NaN."""
    if growth is None or math.isnan(growth):
        return "unknown"
    return "chaotic" if growth > CHAOTIC_ABOVE else "contracting"


PUSH_GROWTH = Metric("push_growth", "1", "growth of a push", push_growth)
