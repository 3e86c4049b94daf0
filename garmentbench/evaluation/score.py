"""All metrics of a roll-out, as rows for results.csv."""

import math

import numpy as np

from garmentbench.evaluation.rollout import OK, RollOut
from garmentbench.metrics import METRICS
from garmentbench.metrics.interpenetration import interpenetration
from garmentbench.metrics.interpenetration_strict import depth_p95, interpenetration_strict, signed_distances
from garmentbench.metrics.jitter import jitter
from garmentbench.metrics.l2 import frame_l2
from garmentbench.metrics.liveliness import liveliness
from garmentbench.metrics.ms_per_frame import time_per_frame
from garmentbench.metrics.self_intersection import crossing_faces, self_intersection
from garmentbench.metrics.stable_frames import stable_frames
from garmentbench.metrics.strain import strain_p95
from garmentbench.sequence import Garment, Sequence

SHORT_HORIZON = 50  # of the paper's Table 3; its other one is the whole sequence


def evaluate(roll: RollOut, one: RollOut | None, sequence: Sequence) -> list[dict]:
    """Rows of all metrics that the scene needs.

    A metric over the whole roll-out is NaN when it ended early; what could be computed stays.

    Returns:
        Dictionaries with metric, horizon [frames], value, unit, reference_value (the reference's own, or None),
        uncertainty [cm] (of l2's, or None), status and first_bad_frame (of the roll-out).
    """
    error = frame_l2(roll.garment, sequence.garment)[roll.start :]
    doubt = sequence.uncertainty_cm
    rows = [_row(roll, "rollout_l2", h, _mean(error, h), None, doubt) for h in _horizons(sequence, roll)]
    if one is not None:
        value = _mean(frame_l2(one.garment, sequence.garment)[one.start :], len(sequence))
        rows.append(_row(one, "one_step_l2", 1, value, None, doubt))
    whole = len(sequence)
    rows.append(_row(roll, "stable_frames", whole, float(stable_frames(error))))
    for name, (value, reference) in _measures(roll, sequence).items():
        rows.append(_row(roll, name, whole, value, reference))
    simulation = sequence.info.get("simulation", {}).get("ms_per_frame")
    for name, value in time_per_frame(roll.ms).items():
        rows.append(_row(roll, name, whole, value, simulation if name == "ms_per_frame" else None))
    return rows


def _row(
    roll: RollOut,
    metric: str,
    horizon: int,
    value: float,
    reference: float | None = None,
    uncertainty: float | None = None,
) -> dict:
    return {
        "metric": metric,
        "horizon": horizon,
        "value": value,
        "unit": METRICS[metric].unit,
        "reference_value": reference,
        "uncertainty": uncertainty,
        "status": roll.status,
        "first_bad_frame": roll.first_bad_frame,
    }


def _horizons(sequence: Sequence, roll: RollOut) -> list[int]:
    """The short horizon, where there is more than that, and the length of the sequence."""
    predicted = len(sequence) - roll.start
    return [SHORT_HORIZON, len(sequence)] if predicted > SHORT_HORIZON else [len(sequence)]


def _mean(error: np.ndarray, horizon: int) -> float:
    return float(error[:horizon].mean())


def _measures(roll: RollOut, sequence: Sequence) -> dict[str, tuple[float, float]]:
    """Values of the metrics that need the whole roll-out's shape, each with the reference's own."""
    template, frames, garment = sequence.template, slice(roll.start, None), sequence.template.garment
    reference, body = sequence.garment[frames], None if sequence.body is None else sequence.body[frames]
    own = {
        "self_intersection": _own_crossing(reference, garment, sequence.info),
        "strain_p95": strain_p95(reference, garment.rest, garment.faces),
        "jitter": 0.0,
        "liveliness": 1.0,
    }
    if template.needs.interpenetration:
        own |= _own_penetration(reference, body, template.body.faces, sequence.info)
        if roll.before_collision is not None:
            own["interpenetration_before"] = own["interpenetration"]
    if roll.status != OK:
        return {name: (math.nan, value) for name, value in own.items()}
    predicted = roll.garment[frames]
    found = {
        "self_intersection": self_intersection(crossing_faces(predicted, garment.faces, garment.seams)),
        "strain_p95": strain_p95(predicted, garment.rest, garment.faces),
        "jitter": jitter(predicted, reference, template.fps),
        "liveliness": liveliness(predicted, reference, body, garment.rest, garment.faces),
    }
    if template.needs.interpenetration:
        found |= _penetration(predicted, body, template.body.faces)
        if roll.before_collision is not None:
            before = roll.before_collision[frames]
            before = np.where(np.isfinite(before), before, predicted)  # a frame may have needed no collision stage
            found["interpenetration_before"] = interpenetration(before, body, template.body.faces)
    return {name: (found[name], value) for name, value in own.items()}


def _penetration(garment: np.ndarray, body: np.ndarray, faces: np.ndarray) -> dict[str, float]:
    distances = signed_distances(garment, body, faces)
    return {
        "interpenetration": interpenetration(garment, body, faces),
        "interpenetration_strict": interpenetration_strict(distances),
        "depth_p95": depth_p95(distances),
    }


def _own_penetration(reference: np.ndarray, body: np.ndarray, faces: np.ndarray, info: dict) -> dict[str, float]:
    """The reference's own: as the sequence notes it, or else measured."""
    noted = info.get("interpenetration", {})
    names = ("interpenetration", "interpenetration_strict", "depth_p95")
    keys = ("vertex_percent", "strict_percent", "depth_p95_mm")
    if all(key in noted for key in keys):
        return {name: noted[key] for name, key in zip(names, keys)}
    return _penetration(reference, body, faces)


def _own_crossing(reference: np.ndarray, garment: Garment, info: dict) -> float:
    """The reference's own self-intersection [%]: as the sequence notes it, or else measured."""
    noted = info.get("self_intersection", {})
    if "percent" in noted:
        return noted["percent"]
    return self_intersection(crossing_faces(reference, garment.faces, garment.seams))
