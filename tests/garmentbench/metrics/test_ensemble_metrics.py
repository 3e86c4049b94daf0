"""Metrics against an ensemble of runs, computed by hand."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.metrics import metric
from garmentbench.metrics.ensemble import energy_score, error, error_over_spread
from garmentbench.metrics.metric import Motion
from garmentbench.metrics.push_growth import push_growth, regime
from garmentbench.metrics.spread import spread


def at(*metres):
    """One run a number: two vertices in two frames, so far along x [m]."""
    return [np.full((2, 2, 3), [x, 0, 0]) for x in metres]


RUNS = at(0.0, 0.01, 0.04)  # pairs are 1, 4 and 3 cm apart: the spread is 8/3 cm


def test_the_spread_is_the_mean_over_pairs():
    assert spread(RUNS) == pytest.approx(8 / 3)
    assert spread(RUNS[:2]) == pytest.approx(1.0)
    assert math.isnan(spread(RUNS[:1])) and math.isnan(spread([]))


def test_the_spread_is_a_mean_over_frames_and_vertices():
    moved = np.zeros((2, 2, 3))
    moved[1, 0] = [0.03, 0.04, 0]  # 5 cm at one of four places
    assert spread([np.zeros((2, 2, 3)), moved]) == pytest.approx(5 / 4)


def test_errors_against_the_ensemble():
    (predicted,) = at(0.02)  # 2, 1 and 2 cm from the runs
    assert error(predicted, RUNS) == pytest.approx(5 / 3)
    assert error_over_spread(predicted, RUNS) == pytest.approx(5 / 8)
    assert energy_score(predicted, RUNS) == pytest.approx(5 / 3 - 4 / 3)


def test_another_run_errs_by_the_spread_on_average():
    """Each run left out and scored against the others: the mean is the spread, and error over spread is 1."""
    left_out = [error(run, RUNS[:k] + RUNS[k + 1 :]) for k, run in enumerate(RUNS)]
    assert np.mean(left_out) == pytest.approx(spread(RUNS))


def test_the_middle_of_the_runs_errs_by_less_than_one_of_them_and_by_more_than_half_the_spread():
    rng = np.random.default_rng(0)
    runs = list(rng.normal(size=(60, 3, 50, 3)))
    middle = np.mean(runs, axis=0)
    assert 0.5 < error(middle, runs) / spread(runs) < 0.75  # 1/sqrt(2) for a normal distribution
    assert energy_score(middle, runs) > 0


def test_runs_that_are_not_finite_are_left_out_and_a_prediction_that_is_not_has_no_error():
    broken = at(1.0)[0]
    broken[1, 1] = np.nan
    assert spread([*RUNS, broken]) == pytest.approx(8 / 3)
    assert error(at(0.02)[0], [*RUNS, broken]) == pytest.approx(5 / 3)
    assert math.isnan(error(broken, RUNS)) and math.isnan(error(RUNS[0], [broken]))


def test_a_spread_of_0_has_no_ratio():
    same = at(0.0, 0.0)
    assert spread(same) == 0 and math.isnan(error_over_spread(at(0.01)[0], same))
    assert energy_score(at(0.01)[0], same) == pytest.approx(1.0)


def test_a_push_s_growth_is_that_of_the_last_fifth():
    first = np.zeros((10, 4, 3))
    pushed = [first.copy(), first.copy()]
    pushed[0][8:, :, 2] = 0.003  # 3 mm in the last fifth
    pushed[0][:8, :, 2] = 0.5  # whatever was before
    pushed[1][9, :2] = [0.0, 0.004, 0]  # 4 mm at a quarter of its places: 1 mm
    assert push_growth(first, pushed, 1e-3) == pytest.approx((3 + 1) / 2)
    assert push_growth(first, pushed[1:], 2e-3) == pytest.approx(0.5)
    pushed[0][9] = np.nan
    assert push_growth(first, pushed, 1e-3) == pytest.approx(1.0)
    assert math.isnan(push_growth(first, [], 1e-3))
    pushed[1][3] = np.nan  # earlier: what counts is how it ends
    assert push_growth(first, pushed[1:], 1e-3) == pytest.approx(1.0)


def test_a_scene_is_contracting_or_chaotic():
    assert [regime(x) for x in (0.0, 1.0, 1.01, 40.0)] == ["contracting", "contracting", "chaotic", "chaotic"]
    assert regime(None) == regime(math.nan) == "unknown"


def test_they_do_not_depend_on_place_heading_or_vertex_order():
    sequence = tiny_sequence(12, runs=3)
    rng = np.random.default_rng(0)
    predicted = sequence.garment + rng.normal(scale=0.02, size=sequence.garment.shape)
    runs = [x.astype(np.float64) for x in (sequence.garment, *sequence.runs)]
    turn, order = Rotation.from_euler("xyz", [0.3, -0.8, 2.0]).as_matrix(), rng.permutation(predicted.shape[1])

    def values(x, runs):
        growth = push_growth(runs[0], runs[1:3], 1e-3)
        return [spread(runs), error(x, runs), error_over_spread(x, runs), energy_score(x, runs), growth]

    def move(x):
        return (x @ turn.T + [3.0, -2.0, 1.0])[:, order]

    assert all(v > 0 for v in values(predicted, runs))
    assert values(move(predicted), [move(x) for x in runs]) == pytest.approx(values(predicted, runs), rel=1e-6)
    assert values(predicted, runs[:1] + runs[:0:-1])[:4] == pytest.approx(values(predicted, runs)[:4])


def test_a_sequence_of_one_run_has_none_of_them():
    alone, ensemble = Motion.of(tiny_sequence(8)), Motion.of(tiny_sequence(8, runs=2))
    for name in ("error", "error_over_spread", "energy_score", "spread"):
        assert not metric(name).applies(alone) and metric(name).applies(ensemble)
    assert len(alone.ensemble) == 1 and len(ensemble.ensemble) == 3
