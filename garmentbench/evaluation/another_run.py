"""Another run of the simulator in a method's place: what nobody can be asked to do better.

Its errors against the ensemble are the spread. What else compares with the reference (the roll-out error against the
first run, jitter, liveliness) is the mean over the further runs, each in a prediction's place: it says what a value is
worth where the cloth itself does not repeat it.
"""

import math
from dataclasses import replace

import numpy as np

from garmentbench.evaluation.results import RUN_BROKE, Row
from garmentbench.evaluation.rollout import DIVERGED, OK, ROLL_OUT, RollOut
from garmentbench.evaluation.score import score, spread_by_horizon
from garmentbench.method import HISTORY
from garmentbench.metrics.ensemble import ENERGY_SCORE, ERROR, ERROR_OVER_SPREAD
from garmentbench.metrics.push_growth import PUSH_GROWTH
from garmentbench.metrics.spread import SPREAD, finite_runs
from garmentbench.sequence import Sequence

ANOTHER_RUN = "another_run"  # its name among the methods in results.csv


def another_run_rows(sequence: Sequence) -> list[Row]:
    """Rows of results.csv of a sequence with further runs.

    Runs that are not finite are left out of every value, and then the values are noted and the line's status is
    "diverged", with the first frame in which one broke.
    """
    bad = broken_at(sequence)
    ended = {"status": OK if bad is None else DIVERGED, "first_bad_frame": bad}
    rows = [replace(row, **ended) for row in _against_the_ensemble(sequence) + _against_the_first(sequence)]
    return rows if bad is None else [row.noted(RUN_BROKE) for row in rows]


def broken_at(sequence: Sequence) -> int | None:
    """The first predicted frame in which a further run is not finite; None where all are whole."""
    good = [np.isfinite(frame).all() for frame in np.stack(_further(sequence), axis=1)]
    return next((t for t in range(HISTORY, len(good)) if not good[t]), None)


def another_roll_out(sequence: Sequence) -> RollOut:
    """The first whole further run, or the first if none is whole, as what a method made of the sequence."""
    runs = _further(sequence)
    return _roll_out((finite_runs(runs) or runs)[0])


def _further(sequence: Sequence) -> list[np.ndarray]:
    return [] if sequence.runs is None else list(sequence.runs)


def _roll_out(run: np.ndarray) -> RollOut:
    return RollOut(ROLL_OUT, HISTORY, run, None, np.full((len(run), 3), np.nan))


def _against_the_ensemble(sequence: Sequence) -> list[Row]:
    """E|y - y'| as the error, and what follows from it."""
    whole, spreads = len(sequence), spread_by_horizon(sequence, HISTORY)
    found = {h: math.nan if cm is None else cm for h, cm in spreads.items()}
    rows = [Row.of(ERROR, cm, horizon=horizon, spread=spreads[horizon]) for horizon, cm in found.items()]
    rows += [
        Row.of(ERROR_OVER_SPREAD, 1.0 if found[whole] > 0 else math.nan, horizon=whole),
        Row.of(ENERGY_SCORE, found[whole] / 2, horizon=whole, spread=spreads[whole]),
        Row.of(SPREAD, found[whole], horizon=whole, spread=spreads[whole]),
    ]
    if sequence.push_growth is not None:
        rows.append(Row.of(PUSH_GROWTH, sequence.push_growth, horizon=whole))
    return rows


def _against_the_first(sequence: Sequence) -> list[Row]:
    """The mean over the further runs of all that compares with the first run."""
    spreads, found = spread_by_horizon(sequence, HISTORY), {}
    alone = replace(sequence, runs=None)
    for run in finite_runs(_further(sequence)):
        for row in score(_roll_out(run), None, alone, only=lambda metric: metric.compares):
            found.setdefault((row.metric, row.horizon), []).append(row)
    return [
        replace(rows[0], value=float(np.mean([row.value for row in rows])), note="", spread=spreads[horizon])
        if rows[0].unit == "cm"
        else replace(rows[0], value=float(np.mean([row.value for row in rows])), note="")
        for (_, horizon), rows in found.items()
    ]
