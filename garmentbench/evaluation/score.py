"""All metrics of a roll-out, as rows for results.csv."""

import math
from dataclasses import replace

import numpy as np

from garmentbench.evaluation.results import UNDER_LOAD, Row
from garmentbench.evaluation.rollout import OK, RollOut
from garmentbench.metrics import METRICS, Metric, Motion
from garmentbench.metrics.l2 import ONE_STEP_L2, ROLLOUT_L2
from garmentbench.metrics.ms_per_frame import under_load
from garmentbench.sequence import Sequence

SHORT_HORIZON = 50  # of the paper's Table 3; its other one is the whole sequence


def score(roll: RollOut, one: RollOut | None, sequence: Sequence) -> list[Row]:
    """Rows of all metrics that apply to a free roll-out, and the error of single steps, of a sequence's reference.

    A metric over the whole roll-out is NaN when it ended early; what could be computed stays. The reference's own value
    is the one that the sequence keeps, or else the same metric with the reference in the prediction's place.
    """
    motion = _motion(roll, sequence)
    rows = []
    for horizon in _horizons(roll, sequence):
        first = Motion(motion.predicted[:horizon], motion.reference[:horizon], None, motion.template)
        rows.append(_row(ROLLOUT_L2, roll, first, sequence, horizon))
    if one is not None:
        rows.append(_row(ONE_STEP_L2, one, _motion(one, sequence), sequence, 1))
    truth = _truth(motion)
    for metric in METRICS.values():
        if metric not in (ROLLOUT_L2, ONE_STEP_L2) and metric.applies(motion):
            row = _row(metric, roll, motion, sequence, len(sequence))
            rows.append(replace(row, reference_value=_reference_value(metric, truth, sequence)))
    return rows


def _motion(roll: RollOut, sequence: Sequence) -> Motion:
    """The predicted frames of a roll-out."""
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
    )


def _truth(motion: Motion) -> Motion:
    """The reference in the prediction's place; it has no collision stage."""
    before = None if motion.before_collision is None else motion.reference
    return replace(motion, predicted=motion.reference, before_collision=before, ms=None, processor_ms=None)


def _horizons(roll: RollOut, sequence: Sequence) -> list[int]:
    """The short horizon, where there is more than that, and the length of the sequence."""
    predicted = len(sequence) - roll.start
    return [SHORT_HORIZON, len(sequence)] if predicted > SHORT_HORIZON else [len(sequence)]


def _row(metric: Metric, roll: RollOut, motion: Motion, sequence: Sequence, horizon: int) -> Row:
    value = math.nan if metric.whole and roll.status != OK else metric.compute(motion)
    columns = {"horizon": horizon, "status": roll.status, "first_bad_frame": roll.first_bad_frame}
    if metric.unit == "cm":
        columns["uncertainty"] = sequence.spread_cm
    if metric.unit == "ms" and under_load(motion, metric):
        columns["note"] = UNDER_LOAD
    return Row.of(metric, value, **columns)


def _reference_value(metric: Metric, truth: Motion, sequence: Sequence) -> float | None:
    """The reference's own value: as the sequence keeps it, or else measured; None where it has none."""
    kept = sequence.scores.get(metric.name.removesuffix("_before"))  # it has no collision stage
    if kept is not None:
        return kept
    return metric.compute(truth) if metric.whole else None
