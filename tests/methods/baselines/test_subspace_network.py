"""The network in the subspace: it learns, it comes back from its errors, it can't run away, and it resumes."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from garmentbench.errors import UserError
from garmentbench.evaluation.check_method import parametrize_with_checks
from garmentbench.evaluation.rollout import roll_out
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.methods import training
from garmentbench.methods.baselines.subspace_network import SubspaceNetwork, config_for
from garmentbench.metrics.l2 import l2
from garmentbench.pipeline import training_run

SMALL = replace(config_for("smoke"), seeds=20, codes=8, body_codes=16)
TINY = replace(SMALL, training=replace(SMALL.training, steps=5))


def fitted(config=SMALL, train=None, seed=0, folder=None):
    return SubspaceNetwork.fit(train or (tiny_sequence(100),), config, training_run(folder, seed))


@parametrize_with_checks([(SubspaceNetwork, TINY)])
def test_it_keeps_the_contract(method, check):
    check(method)


def test_training_lowers_the_error():
    test = tiny_sequence(60, phase=1.0)
    errors = [l2(roll_out(m, test).garment[3:], test.garment[3:]) for m in (fitted(TINY), fitted())]
    assert errors[1] < 0.5 * errors[0] and errors[1] < 0.5


def test_the_seed_decides_and_nothing_else():
    test = tiny_sequence(12, phase=1.0)
    first, again, other = (roll_out(fitted(TINY, seed=seed), test).garment for seed in (0, 0, 1))
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 1e-6


def test_an_interrupted_training_ends_as_one_that_was_not(tmp_path, monkeypatch):
    whole = fitted(TINY)
    monkeypatch.setattr(training, "CHECKPOINT_SECONDS", 0.0)
    monkeypatch.setattr(training, "learning_rate", _killed_at(3))
    with pytest.raises(KeyboardInterrupt):
        fitted(TINY, folder=tmp_path)
    monkeypatch.undo()
    resumed = fitted(TINY, folder=tmp_path)
    for mine, its in zip(whole.net.state_dict().values(), resumed.net.state_dict().values(), strict=True):
        assert torch.equal(mine, its)


def _killed_at(step):
    rate = training.learning_rate

    def learning_rate(options, now):
        if now == step:
            raise KeyboardInterrupt
        return rate(options, now)

    return learning_rate


def test_codes_stay_where_training_was_whatever_comes():
    """Wild weights and a body from elsewhere: after hundreds of steps the garment is as near as training's farthest."""
    method = fitted(TINY)
    with torch.no_grad():
        for weight in method.net.layers.parameters():
            weight.mul_(50.0)
    rng = np.random.default_rng(0)
    memory = tuple(rng.normal(size=(2, len(method.garment.basis))))
    for _ in range(300):
        code, memory = method.following(memory, 100 * rng.normal(size=len(method.body.basis)))
        assert np.linalg.norm(code / method.net.codes.numpy()) <= 1.0001 * method.net.reach.item()


def test_nothing_crosses_from_one_sequence_into_the_next():
    """Steps over a border would be jumps of half a metre: the spread of changes in a frame would show them."""
    one = tiny_sequence(40)
    off = replace(one, garment=one.garment + np.float32([0, 0, 0.5]))
    changes = [fitted(TINY, train).net.changes.max() for train in ((one,), (one, off))]
    assert changes[1] < 2 * changes[0]


def test_too_short_a_sequence_is_told():
    with pytest.raises(UserError, match="has 5 frames; wanted at least 6"):
        fitted(train=(tiny_sequence(40), tiny_sequence(5)))
