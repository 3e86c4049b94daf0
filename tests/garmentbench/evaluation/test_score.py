"""Rows of a roll-out: what a scene needs and nothing else, and nothing lost when it ends early."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from garmentbench.evaluation.results import BELOW_HALF_SPREAD, COLUMNS, EXACTLY_ZERO, RUN_BROKE, UNDER_LOAD, Row
from garmentbench.evaluation.rollout import RollOut
from garmentbench.evaluation.score import score
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.metrics import METRICS, metric
from garmentbench.reference import reference_scores

ENSEMBLE = {"error", "error_over_spread", "energy_score"}
BODY_METRICS = {"interpenetration", "interpenetration_strict", "depth_p95", "faces_inside", "skin_frames"}
TIMES = {"ms_per_frame", "ms_per_frame_p95", "ms_prepare", "ms_predict", "ms_collide"}
OTHERS = {
    "rollout_l2",
    "one_step_l2",
    "self_intersection",
    "strain_p95",
    "jitter",
    "liveliness",
    "stable_frames",
    "dihedral_rms",
    "normal_angle",
    "displacement_spectrum",
} | TIMES


def shifted(sequence, metres=0.01, kind="roll_out"):
    """A roll-out that is wrong by so many metres in x."""
    garment = sequence.garment.copy()
    garment[3:] += np.float32([metres, 0, 0])
    ms = np.full((len(sequence), 3), np.nan)
    ms[3:] = [1, 2, 3]
    return RollOut(kind, 3, garment, None, ms)


def ended(roll, frame, status="diverged"):
    garment, ms = roll.garment.copy(), roll.ms.copy()
    garment[frame:], ms[frame:] = np.nan, np.nan
    return replace(roll, garment=garment, ms=ms, status=status, first_bad_frame=frame, message="bad")


def with_another_run(sequence, metres=0.002):
    """A second run of it, that far away in x: the spread is that far."""
    return replace(sequence, runs=sequence.garment[None] + np.float32([metres, 0, 0]))


def by_name(rows):
    return {(r.metric, r.horizon): r for r in rows}


def test_rows_of_a_whole_roll_out():
    sequence = with_another_run(tiny_sequence(60))
    sequence.info["simulation"] = {"ms_per_frame": 44.0}
    rows = by_name(score(shifted(sequence), shifted(sequence, 0.005, "one_step"), sequence))
    assert {m for m, _ in rows} == BODY_METRICS | OTHERS | ENSEMBLE
    assert [h for m, h in rows if m == "rollout_l2"] == [h for m, h in rows if m == "error"] == [50, 60]
    assert rows["rollout_l2", 50].value == pytest.approx(1.0, rel=1e-4)
    assert rows["one_step_l2", 1].value == pytest.approx(0.5, rel=1e-4)
    for name, horizon in (("rollout_l2", 50), ("rollout_l2", 60), ("error", 50), ("error", 60), ("energy_score", 60)):
        assert rows[name, horizon].spread == pytest.approx(0.2, rel=1e-3)
    assert [rows["error", h].value for h in (50, 60)] == pytest.approx([(1.0 + 0.8) / 2] * 2, rel=1e-3)
    assert rows["error_over_spread", 60].value == pytest.approx(0.9 / 0.2, rel=1e-3)
    assert rows["energy_score", 60].value == pytest.approx(0.9 - 0.2 / 2, rel=1e-3)
    assert rows["one_step_l2", 1].spread is None and rows["jitter", 60].spread is None
    assert rows["rollout_l2", 60].reference_value is None
    assert rows["jitter", 60].value == pytest.approx(0, abs=1e-3)
    assert rows["liveliness", 60].value == pytest.approx(1, abs=1e-4)
    assert rows["liveliness", 60].reference_value == 1.0
    assert rows["strain_p95", 60].value == pytest.approx(rows["strain_p95", 60].reference_value, abs=1e-3)
    assert rows["stable_frames", 60].value == 57
    assert rows["ms_per_frame", 60].value == 6 and rows["ms_per_frame", 60].reference_value == 44.0
    assert rows["ms_collide", 60].value == 3
    assert all(r.unit == METRICS[r.metric].unit and r.status == "ok" for r in rows.values())


def test_the_horizon_is_over_predicted_frames():
    sequence = tiny_sequence(60)
    roll = shifted(sequence)
    roll.garment[53:] += np.float32([0.01, 0, 0])  # after 50 predicted frames
    rows = by_name(score(roll, None, sequence))
    assert rows["rollout_l2", 50].value == pytest.approx(1.0, rel=1e-4)
    assert rows["rollout_l2", 60].value == pytest.approx((50 * 1 + 7 * 2) / 57, rel=1e-4)
    assert ("one_step_l2", 1) not in rows


@pytest.mark.parametrize(("frames", "horizons"), [(53, [53]), (54, [50, 54]), (4, [4])])
def test_no_horizon_twice(frames, horizons):
    sequence = tiny_sequence(frames)
    rows = by_name(score(shifted(sequence), None, sequence))
    assert [h for m, h in rows if m == "rollout_l2"] == horizons


@pytest.mark.parametrize("kind", ["object", None])
def test_without_a_human_body_its_metrics_are_absent(kind):
    sequence = tiny_sequence(20, kind)
    roll = replace(shifted(sequence), before_collision=sequence.garment)
    rows = score(roll, shifted(sequence, kind="one_step"), sequence)
    assert {r.metric for r in rows} == OTHERS


def test_the_garment_beneath_is_measured_against_like_a_skin():
    sequence = tiny_sequence(20, "garment")
    roll = replace(shifted(sequence), before_collision=sequence.garment)
    rows = by_name(score(roll, shifted(sequence, kind="one_step"), sequence))
    assert {m for m, _ in rows} == BODY_METRICS | OTHERS | {"interpenetration_before"}


@pytest.mark.parametrize("status", ["diverged", "failed"])
def test_a_roll_out_that_ended_keeps_its_rows(status):
    sequence = tiny_sequence(70)
    roll = ended(shifted(sequence), 60, status)
    rows = by_name(score(roll, ended(shifted(sequence, kind="one_step"), 7, "failed"), sequence))
    assert {m for m, _ in rows} == BODY_METRICS | OTHERS
    assert rows["rollout_l2", 50].value == pytest.approx(1.0, rel=1e-4)
    assert rows["stable_frames", 70].value == 57
    assert rows["ms_per_frame", 70].value == 6
    for name in {"rollout_l2", "strain_p95", "jitter", "liveliness"} | BODY_METRICS:
        assert math.isnan(rows[name, 70].value), name
    assert rows["interpenetration", 70].reference_value == 0.0
    assert math.isnan(rows["one_step_l2", 1].value)
    assert (rows["one_step_l2", 1].status, rows["one_step_l2", 1].first_bad_frame) == ("failed", 7)
    assert all((r.status, r.first_bad_frame) == (status, 60) for (m, _), r in rows.items() if m != "one_step_l2")


def test_a_roll_out_that_never_began_keeps_its_rows():
    sequence = tiny_sequence(20)
    rows = score(ended(shifted(sequence), 3, "failed"), None, sequence)
    assert {r.metric for r in rows} == BODY_METRICS | OTHERS - {"one_step_l2"}
    assert by_name(rows)["stable_frames", 20].value == 0


def test_interpenetration_before_and_after_the_collision_stage():
    sequence = tiny_sequence(20)
    roll = shifted(sequence, 0.0)
    before = roll.garment.copy()
    centre = sequence.body.mean(axis=1, keepdims=True)
    before[3:] = (centre + 0.7 * (before - centre))[3:]
    before[10:] = np.nan  # no collision stage needed from here on
    rows = by_name(score(replace(roll, before_collision=before), None, sequence))
    assert rows["interpenetration_before", 20].value == pytest.approx(100 * 7 / 17)
    assert rows["interpenetration", 20].value == 0.0
    ended_rows = by_name(score(ended(replace(roll, before_collision=before), 15), None, sequence))
    assert math.isnan(ended_rows["interpenetration_before", 20].value)


def test_the_reference_own_penetration_is_measured_or_taken_from_the_sequence():
    sequence = tiny_sequence(20)
    centre = sequence.body.mean(axis=1, keepdims=True)
    sequence.garment[:] = centre + 0.8 * (sequence.garment - centre)
    rows = by_name(score(shifted(sequence, 0.0), None, sequence))
    for name in BODY_METRICS:
        row = rows[name, 20]
        assert row.reference_value == row.value > 0
    sequence.info["scores"] = {"interpenetration": 7.0, "interpenetration_strict": 2.0, "depth_p95": 1.5}
    rows = by_name(score(shifted(sequence, 0.0), None, sequence))
    assert [rows[m, 20].reference_value for m in ("interpenetration", "interpenetration_strict", "depth_p95")] == [
        7,
        2,
        1.5,
    ]


@pytest.mark.parametrize("kind", ["human", "object", "garment", None])
def test_the_reference_is_scored_by_putting_it_in_the_predictions_place(kind):
    """All copies of the reference's own penetration are this one code (D11)."""
    sequence = tiny_sequence(20, kind)
    rows = score(shifted(sequence, 0.0), None, sequence)
    own = [row for row in rows if METRICS[row.metric].whole]
    assert own and all(row.value == row.reference_value for row in own)
    assert all(row.reference_value is None for row in rows if not METRICS[row.metric].whole)


def test_what_a_reference_keeps_is_under_the_metrics_names():
    sequence = tiny_sequence(20)
    sequence.info["simulation"] = {"ms_per_frame": 44.0, "strain_mean": 1.0, "strain_p99_max": 3.0}
    sequence.info["scores"] = reference_scores(sequence)
    assert all(metric(name) for name in sequence.scores)
    assert sequence.scores.keys() >= BODY_METRICS | {"self_intersection", "ms_per_frame"}
    rows = by_name(score(shifted(sequence), None, sequence))
    for name in (BODY_METRICS | {"self_intersection", "ms_per_frame"}) & sequence.scores.keys():
        assert rows[name, 20].reference_value == sequence.scores[name]


@pytest.mark.parametrize(("metres", "note"), [(0.0, EXACTLY_ZERO), (0.0009, BELOW_HALF_SPREAD), (0.0011, "")])
def test_a_roll_out_nearer_than_half_the_spread_is_noted(metres, note):
    """N7: a method that reads the reference gets 0 cm; the value stays. Not so early: it knows the first frames."""
    sequence = with_another_run(tiny_sequence(60))
    rows = by_name(score(shifted(sequence, metres), shifted(sequence, 0.00005, "one_step"), sequence))
    assert rows["rollout_l2", 60].note == note
    assert rows["rollout_l2", 50].note == ("" if metres else EXACTLY_ZERO)
    assert rows["rollout_l2", 60].value == pytest.approx(100 * metres, rel=1e-3)
    assert rows["one_step_l2", 1].note == ""  # three true frames are given: it may be nearer
    unknown = "" if metres else EXACTLY_ZERO
    assert by_name(score(shifted(sequence, metres), None, tiny_sequence(60)))["rollout_l2", 60].note == unknown


def test_a_run_that_broke_is_left_out_from_the_horizon_on_in_which_it_did_and_noted():
    sequence = tiny_sequence(60)
    runs = np.stack([sequence.garment + np.float32([d, 0, 0]) for d in (0.002, 0.006)])
    runs[1, 55:] = np.nan
    rows = by_name(score(shifted(sequence), None, replace(sequence, runs=runs)))
    assert rows["error", 50].value == pytest.approx((1.0 + 0.8 + 0.4) / 3, rel=1e-3)
    assert rows["error", 50].spread == pytest.approx((0.2 + 0.6 + 0.4) / 3, rel=1e-3)
    assert rows["error", 60].value == pytest.approx(0.9, rel=1e-3)
    assert rows["error", 60].spread == pytest.approx(0.2, rel=1e-3)
    assert (rows["error", 50].note, rows["error", 60].note) == ("", RUN_BROKE)
    assert rows["energy_score", 60].note == RUN_BROKE and rows["rollout_l2", 60].note == rows["jitter", 60].note == ""


def test_errors_of_a_roll_out_that_ended_early_are_those_of_the_frames_that_it_has():
    sequence = with_another_run(tiny_sequence(60))
    rows = by_name(score(ended(shifted(sequence), 54), None, sequence))
    assert rows["error", 50].value == pytest.approx(0.9, rel=1e-3) and math.isnan(rows["error", 60].value)
    assert math.isnan(rows["energy_score", 60].value) and math.isnan(rows["error_over_spread", 60].value)


def test_times_taken_under_load_are_noted():
    """N12: wall time far above processor time."""
    sequence = tiny_sequence(60)
    roll = replace(shifted(sequence), processor_ms=np.full(60, 2.0))  # of 6 ms
    rows = by_name(score(roll, None, sequence))
    assert rows["ms_per_frame", 60].note == rows["ms_predict", 60].note == UNDER_LOAD
    assert rows["ms_processor", 60].value == 2.0 and rows["ms_processor", 60].note == ""
    rows = by_name(score(replace(roll, processor_ms=np.full(60, 5.9)), None, sequence))
    assert not any(row.note for row in rows.values())


def test_a_row_is_kept_as_plain_values_and_read_back():
    sequence = tiny_sequence(20)
    for row in score(shifted(sequence), None, sequence):
        assert Row(**json.loads(json.dumps(row.measured))) == row
    assert COLUMNS[:3] == ["preset", "experiment", "scene"] and COLUMNS[-2:] == ["train_scenes", "note"]


@pytest.mark.parametrize(("metres", "note"), [(0.0, EXACTLY_ZERO), (0.00005, ""), (0.01, "")])
@pytest.mark.parametrize("metres_apart", [0.002, None])
def test_a_single_step_is_noted_where_it_makes_no_error_at_all(metres, note, metres_apart):
    """An honest rule may beat the spread there, which gathers over a whole run."""
    sequence = tiny_sequence(60)
    if metres_apart:
        sequence = with_another_run(sequence, metres_apart)
    rows = by_name(score(shifted(sequence), shifted(sequence, metres, "one_step"), sequence))
    assert rows["one_step_l2", 1].note == note
