"""A method says how far a frame is from what it was trained on, and means it."""

from dataclasses import replace

import numpy as np
import pytest

from garmentbench.evaluation.rollout import RollOut, roll_out
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.methods import load_method
from garmentbench.methods.baselines.rollouts import config_for
from garmentbench.methods.novelty import NEIGHBOURS, Novelty
from garmentbench.metrics import METRICS
from garmentbench.metrics.novelty import rank_correlation
from garmentbench.pipeline.train import training_run


def test_the_distance_to_the_nearest_frame_in_units_of_their_own():
    """Frames on two far places a step apart; the third recording is 0.4 off the first one's."""
    there = np.repeat([[0.0, 0.0], [10.0, 0.0]], NEIGHBOURS + 1, axis=0)
    bodies, codes = np.concatenate([there, there[:1] + [0.0, 0.4]]), np.zeros((2 * NEIGHBOURS + 3, 1))
    known = Novelty.of(bodies, codes, [len(there), 1])
    spread = np.sqrt(bodies.var(axis=0).sum())
    assert known.spread == pytest.approx([spread, 1e-9])
    # To the nearest of all that is not a neighbour in time: 0.4 of the lonely frame and those that it is near to (17),
    # 10 of those at the far place but the last, which is 16 frames from the first (and 10 from it).
    of_each = np.sort(np.r_[np.full(NEIGHBOURS + 2, 0.4), np.full(NEIGHBOURS + 1, 10.0)])
    assert known.unit * spread == pytest.approx(np.percentile(of_each, 99), rel=1e-5)
    assert known(np.array([10.0, 5.0]), np.zeros(1)) == pytest.approx(5 / (known.unit * spread), rel=1e-5)


def test_frames_that_are_all_neighbours_in_time_say_nothing():
    known = Novelty.of(np.arange(10.0)[:, None], np.zeros((10, 1)), [10])
    assert np.isnan(known(np.array([1e6]), np.zeros(1)))


def test_it_is_read_back(tmp_path):
    rng = np.random.default_rng(0)
    known = Novelty.of(rng.normal(size=(60, 4)), rng.normal(size=(60, 3)), [40, 20])
    known.save(tmp_path / "novelty.npz")
    again = Novelty.load(tmp_path / "novelty.npz")
    assert again(np.ones(4), np.ones(3)) == known(np.ones(4), np.ones(3)) > 0


@pytest.mark.parametrize("name", ["linear_subspace", "static_ridge", "pose_gru"])
def test_a_body_that_was_never_seen_so_is_novel_and_one_trained_on_is_not(name):
    sequence = tiny_sequence(60)
    method = load_method(name)
    config = config_for("smoke") if name == "pose_gru" else method.Config()
    trained = method.fit((sequence,), config, training_run())
    strange = sequence.body.copy()
    strange[30:] *= np.float32([1.5, 1.5, 0.8])
    same, other = (roll_out(trained, s).novelty for s in (sequence, replace(sequence, body=strange)))
    assert same is not None and other is not None
    assert np.isnan(same[:3]).all() and np.isfinite(same[3:]).all()
    assert other[50:].min() > 1.2 * max(1.0, same[3:].max())  # static_ridge looks at half a second


def test_it_is_kept_with_the_roll_out_and_not_invented(tmp_path):
    sequence = tiny_sequence(12)
    roll = roll_out(
        load_method("linear_subspace").fit((sequence,), load_method("linear_subspace").Config(), training_run()),
        sequence,
    )
    roll.save(tmp_path / "a.h5")
    np.testing.assert_array_equal(RollOut.load(tmp_path / "a.h5").novelty, roll.novelty)
    silent = roll_out(
        load_method("skinning").fit((sequence,), load_method("skinning").Config(), training_run()), sequence
    )
    silent.save(tmp_path / "b.h5")
    assert RollOut.load(tmp_path / "b.h5").novelty is None


def test_rank_correlation_by_hand():
    a = np.array([1.0, 2.0, 3.0, 4.0, np.nan])
    assert rank_correlation(a, np.array([10.0, 100.0, 1000.0, 9999.0, 0.0])) == pytest.approx(1.0)
    assert rank_correlation(a, np.array([4.0, 3.0, 2.0, 1.0, 0.0])) == pytest.approx(-1.0)
    assert rank_correlation(a, np.array([1.0, 3.0, 2.0, 4.0, 0.0])) == pytest.approx(1 - 6 * 2 / (4 * 15))
    assert np.isnan(rank_correlation(a, np.ones(5)))


def test_the_metrics_are_of_methods_that_say_it():
    correlation, share = METRICS["novelty_correlation"], METRICS["novel_frames"]
    from garmentbench.metrics import Motion

    sequence = tiny_sequence(8)
    motion = Motion.of(sequence)
    assert not correlation.applies(motion) and not share.applies(motion)
    off = sequence.garment + np.linspace(0, 0.1, 8, dtype=np.float32)[:, None, None]
    told = replace(motion, predicted=off, novelty=np.linspace(0.3, 1.7, 8))
    assert correlation.compute(told) == pytest.approx(1.0)
    assert share.compute(told) == pytest.approx(50.0)
    assert not correlation.applies(told.truth)
