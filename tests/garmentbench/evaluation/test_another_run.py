"""The simulator's own spread as a line among the methods."""

import math
from dataclasses import replace

import numpy as np
import pytest

from garmentbench.evaluation.another_run import another_roll_out, another_run_rows
from garmentbench.evaluation.results import RUN_BROKE
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.metrics.jitter import jitter


def sequence(*metres, frames=60):
    """Runs that far from the first in x."""
    first = tiny_sequence(frames)
    runs = np.stack([first.garment + np.float32([d, 0, 0]) for d in metres])
    return replace(first, runs=runs, info=first.info | {"ensemble": {"push_growth": 2.5}})


def by_name(rows):
    return {(r.metric, r.horizon): r for r in rows}


def test_its_error_is_the_spread_and_its_roll_out_the_distance_from_the_first():
    rows = by_name(another_run_rows(sequence(0.01, 0.04)))
    for horizon in (50, 60):
        assert rows["error", horizon].value == rows["error", horizon].spread == pytest.approx(8 / 3, rel=1e-4)
        assert rows["rollout_l2", horizon].value == pytest.approx(5 / 2, rel=1e-4)
        assert rows["rollout_l2", horizon].spread == pytest.approx(8 / 3, rel=1e-4)
    assert rows["error_over_spread", 60].value == 1
    assert rows["energy_score", 60].value == pytest.approx(4 / 3, rel=1e-4)
    assert rows["spread", 60].value == pytest.approx(8 / 3, rel=1e-4) and rows["push_growth", 60].value == 2.5
    assert all(row.status == "ok" and row.note == "" for row in rows.values())


def test_what_compares_with_the_reference_is_measured_and_nothing_else():
    rows = by_name(another_run_rows(tiny_sequence(20, runs=2)))
    names = {"error", "error_over_spread", "energy_score", "spread", "rollout_l2", "jitter", "liveliness"}
    assert {name for name, _ in rows} == names
    first = tiny_sequence(20, runs=2)
    by_hand = [jitter(run[3:], first.garment[3:], 30.0) for run in first.runs]
    assert rows["jitter", 20].value == pytest.approx(np.mean(by_hand)) and rows["jitter", 20].spread is None


def test_a_run_that_broke_is_told_in_its_line():
    broken = sequence(0.01, 0.04)
    broken.runs[1, 55:] = np.nan
    rows = by_name(another_run_rows(broken))
    assert rows["error", 60].value == rows["rollout_l2", 60].value == pytest.approx(1.0, rel=1e-4)
    assert rows["error", 50].value == pytest.approx(8 / 3, rel=1e-4)
    assert all(r.status == "diverged" and r.first_bad_frame == 55 and r.note == RUN_BROKE for r in rows.values())
    assert np.array_equal(another_roll_out(broken).garment, broken.runs[0])


def test_without_a_whole_run_nothing_is_known():
    lost = sequence(0.01)
    lost.runs[:, 10:] = np.nan
    rows = by_name(another_run_rows(lost))
    assert math.isnan(rows["error", 60].value) and rows["error", 60].spread is None
    assert ("rollout_l2", 60) not in rows and rows["error", 60].status == "diverged"
    assert len(another_roll_out(lost).garment) == 60
