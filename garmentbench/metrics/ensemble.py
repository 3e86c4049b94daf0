"""Errors against the ensemble: a prediction beside all runs of the simulator, none of which is the truth.

    error = E|x - y| = mean over all runs y of 100 / (T V) sum_t sum_i |x_ti - y_ti|    [cm]
    error_over_spread = error / spread    [1]
    energy_score = E|x - y| - E|y - y'| / 2    [cm]

x is the prediction, E|y - y'| the `spread`. An error over the spread of 1 is as good as another run of the simulator.
The energy score (Gneiting and Raftery 2007, "Strictly proper scoring rules") is that of a method which gives one
answer, with the distance of each vertex by itself. In one scene it ranks as `error` does; between scenes it says what
is left when the cloth's own chance is taken off. No prediction has less than 0 if the runs are many.

When it lies. A smooth average of all folds errs by less than any single run (down to half the spread; about 0.7 of
it where distances are like those of a normal distribution), so an error over the spread below 1 is no feat by itself:
read `liveliness` beside it. The runs begin where their own past has left them, the prediction from three frames of
the first: where that matters more than what comes after, `error` blames the prediction for the start. Where the
spread is nearly 0 (a contracting scene) an error over it is a huge number that only says how repeatable the reference
is. Runs that are not finite over these frames are left out, and the value is noted.
"""

import math

import numpy as np

from garmentbench.metrics.l2 import l2
from garmentbench.metrics.metric import Metric, Motion
from garmentbench.metrics.spread import Run, finite_runs, spread


def error(predicted: Run, runs: list[Run]) -> float:
    """Mean distance from the runs [cm], of positions [m], each of shape (T, V, 3); NaN without a finite run, or if a
    predicted position is not finite."""
    apart = [l2(predicted, run) for run in finite_runs(runs)]
    return float(np.mean(apart)) if apart else math.nan


def error_over_spread(predicted: Run, runs: list[Run]) -> float:
    """The error over the spread [1]; as `error`, and NaN where the spread is 0 or not known."""
    apart = spread(runs)
    return error(predicted, runs) / apart if apart > 0 else math.nan


def energy_score(predicted: Run, runs: list[Run]) -> float:
    """The error less half the spread [cm]; as `error`, and NaN where the spread is not known."""
    return error(predicted, runs) - spread(runs) / 2


def has_runs(motion: Motion) -> bool:
    """Is the reference an ensemble?"""
    return motion.runs is not None


ERROR = Metric("error", "cm", "error", lambda m: error(m.predicted, m.ensemble), applies=has_runs, whole=False)
ERROR_OVER_SPREAD = Metric(
    "error_over_spread",
    "1",
    "error / spread",
    lambda m: error_over_spread(m.predicted, m.ensemble),
    applies=has_runs,
    whole=False,
)
ENERGY_SCORE = Metric(
    "energy_score", "cm", "energy score", lambda m: energy_score(m.predicted, m.ensemble), applies=has_runs, whole=False
)
