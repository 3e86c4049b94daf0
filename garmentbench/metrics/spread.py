"""Spread: how far two runs of the simulator are apart, what another run of it errs by.

    spread = E|y - y'| = 100 / (T V) sum_t sum_i |y_ti - y'_ti|, mean over all pairs of different runs y, y'    [cm]

The runs are those of the reference's ensemble: the same scene, pushed by 1 mm or integrated with a finer step. No
method is asked to err by less. Where the cloth forgets a push (a contracting scene) the spread is the reference's
uncertainty and nothing else; where it does not (a chaotic one, see `push_growth`) it says how much of the motion
can't be foretold.

When it lies. Four runs are few: four others have another spread, and rare folds are not in it. It says that runs
agree with each other, not with real cloth. It grows over a recording, so it belongs to a horizon: that of the whole
says nothing of the first second. A method knows the first run's first three frames, which the other runs do not
share: over a short horizon an honest prediction may err by less. Runs that are not finite over the frames looked at
are left out, and whoever shows the spread says so.
"""

import math
from collections.abc import Sequence
from itertools import combinations

import numpy as np
from jaxtyping import Float

from garmentbench.metrics.l2 import l2
from garmentbench.metrics.metric import Metric

Run = Float[np.ndarray, "frames vertices 3"]


def finite_runs(runs: Sequence[Run]) -> list[Run]:
    """Those that are finite in all frames."""
    return [run for run in runs if np.isfinite(run).all()]


def spread(runs: Sequence[Run]) -> float:
    """Mean distance of two runs [cm], of positions [m], each of shape (T, V, 3); NaN for fewer than two finite runs."""
    pairs = [l2(a, b) for a, b in combinations(finite_runs(runs), 2)]
    return float(np.mean(pairs)) if pairs else math.nan


SPREAD = Metric("spread", "cm", "spread", lambda m: spread(m.ensemble), applies=lambda m: m.runs is not None)
