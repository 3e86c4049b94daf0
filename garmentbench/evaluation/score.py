"""All metrics of a roll-out, as rows for results.csv."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from garmentbench.evaluation.results import BELOW_HALF_SPREAD, RUN_BROKE, UNDER_LOAD, Row
from garmentbench.evaluation.rollout import COMPLETE, RollOut
from garmentbench.metrics import METRICS, Metric, Motion
from garmentbench.metrics.ensemble import ENERGY_SCORE, ERROR, ERROR_OVER_SPREAD
from garmentbench.metrics.l2 import ONE_STEP_L2, ROLLOUT_L2
from garmentbench.metrics.ms_per_frame import under_load
from garmentbench.metrics.spread import SPREAD, finite_runs
from garmentbench.sequence import Sequence

SHORT_HORIZON = 50  # of the paper's Table 3; its other one is the whole sequence


def score(
    roll: RollOut,
    one: RollOut | None,
    sequence: Sequence,
    only: Callable[[Metric], bool] = lambda metric: True,
    motion: Motion | None = None,
) -> list[Row]:
    """Rows of all metrics that apply to a free roll-out, and the error of single steps, of a sequence's reference.

    Args:
        roll: The free roll-out.
        one: The single steps; None where there are none.
        sequence: What it was rolled out on. Errors against the ensemble need its further runs.
        only: Which of the metrics.
        motion: `predicted(roll, sequence)`, where somebody has it already.

    A metric over the whole roll-out is NaN when it ended early; what could be computed stays. The reference's own value
    is the one that the sequence keeps, or else the same metric with the reference in the prediction's place.
    """
    motion = predicted(roll, sequence) if motion is None else motion
    rows, spreads = [], spread_by_horizon(sequence, roll.start)
    for horizon, spread in spreads.items():
        first = _first(motion, horizon)
        rows += [
            _row(metric, roll, first, sequence, horizon, spread)
            for metric in (ROLLOUT_L2, ERROR)
            if only(metric) and metric.applies(first)
        ]
    if one is not None:
        rows.append(_row(ONE_STEP_L2, one, predicted(one, sequence), sequence, 1))
    truth = motion.truth
    for metric in METRICS.values():
        if metric not in (ROLLOUT_L2, ONE_STEP_L2, ERROR) and metric.applies(motion) and only(metric):
            row = _row(metric, roll, motion, sequence, len(sequence), spreads[len(sequence)])
            rows.append(replace(row, reference_value=_reference_value(metric, truth, sequence)))
    return rows


def spread_by_horizon(sequence: Sequence, start: int) -> dict[int, float | None]:
    """What another run errs by over the frames of each horizon [cm]: the short one, where there is more than that, and
    the length of the sequence. None where there is no other run.

    Args:
        sequence: The reference.
        start: The first predicted frame.
    """
    predicted = len(sequence) - start
    horizons = [SHORT_HORIZON, len(sequence)] if predicted > SHORT_HORIZON else [len(sequence)]
    found = {}
    for horizon in horizons:
        frames = sequence.frames(start, min(start + horizon, len(sequence)))
        cm = math.nan if frames.runs is None else SPREAD.compute(Motion.of(frames))
        found[horizon] = cm if math.isfinite(cm) else None
    return found


def _first(motion: Motion, horizon: int) -> Motion:
    """The garments of the first frames, up to the horizon."""
    runs = None if motion.runs is None else motion.runs[:, :horizon]
    return Motion(motion.predicted[:horizon], motion.reference[:horizon], None, motion.template, runs=runs)


def predicted(roll: RollOut, sequence: Sequence) -> Motion:
    """The predicted frames of a roll-out, beside the reference's."""
    frames, before = slice(roll.start, None), None
    if roll.before_collision is not None:  # a frame may have needed no collision stage
        before = np.where(np.isfinite(roll.before_collision), roll.before_collision, roll.garment)[frames]
    body = None if sequence.body is None else sequence.body[frames]
    processor_ms = None if roll.processor_ms is None else roll.processor_ms[frames]
    return Motion(
        roll.garment[frames],
        sequence.garment[frames],
        body,
        sequence.template,
        before,
        roll.ms[frames],
        processor_ms,
        None if roll.novelty is None else roll.novelty[frames],
        None if sequence.runs is None else sequence.runs[:, frames],
    )


def _row(
    metric: Metric, roll: RollOut, motion: Motion, sequence: Sequence, horizon: int, spread: float | None = None
) -> Row:
    value = math.nan if metric.whole and roll.status not in COMPLETE else metric.compute(motion)
    columns = {"horizon": horizon, "status": roll.status, "first_bad_frame": roll.first_bad_frame}
    row = Row.of(metric, value, spread=spread if metric.unit == "cm" else None, **columns)
    if metric is ROLLOUT_L2 and spread is not None and horizon == len(sequence) and 0 < value < spread / 2:
        row = row.noted(BELOW_HALF_SPREAD)
    if metric in (ERROR, ERROR_OVER_SPREAD, ENERGY_SCORE) and len(finite_runs(motion.ensemble)) < len(motion.ensemble):
        row = row.noted(RUN_BROKE)
    return row.noted(UNDER_LOAD) if metric.unit == "ms" and under_load(motion, metric) else row


def _reference_value(metric: Metric, truth: Motion, sequence: Sequence) -> float | None:
    """The reference's own value: as the sequence keeps it, or else measured; None where it has none."""
    kept = sequence.scores.get(metric.name.removesuffix("_before"))  # it has no collision stage
    if kept is not None:
        return kept
    return metric.compute(truth) if metric.whole else None
