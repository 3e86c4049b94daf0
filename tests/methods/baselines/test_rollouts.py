"""The networks in the subspace: they learn, come back from their errors, can't run away, and resume."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from garmentbench.errors import UserError
from garmentbench.evaluation.check_method import parametrize_with_checks
from garmentbench.evaluation.rollout import roll_out
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.methods import training
from garmentbench.methods.baselines.linear_memory import LinearMemory
from garmentbench.methods.baselines.pose_gru import PoseGru
from garmentbench.methods.baselines.rollouts import TrainedDynamics, config_for
from garmentbench.methods.baselines.subspace_network import SubspaceNetwork
from garmentbench.metrics.l2 import l2
from garmentbench.pipeline.train import training_run

KINDS = (SubspaceNetwork, LinearMemory, PoseGru)
SMALL = replace(config_for("smoke"), seeds=20, codes=8, body_codes=16)
TINY = replace(SMALL, training=replace(SMALL.training, steps=5))


@pytest.fixture(params=KINDS, ids=lambda kind: kind.name)
def kind(request):
    return request.param


def fitted(config=SMALL, train=None, seed=0, folder=None, kind: type[TrainedDynamics] = SubspaceNetwork):
    return kind.fit(train or (tiny_sequence(100),), config, training_run(folder, seed))


@parametrize_with_checks([(kind, TINY) for kind in KINDS])
def test_it_keeps_the_contract(method, check):
    check(method)


def test_training_lowers_the_error(kind):
    test, quick = tiny_sequence(60, phase=1.0), replace(SMALL, training=replace(SMALL.training, learning_rate=3e-2))
    errors = [
        l2(roll_out(m, test).garment[3:], test.garment[3:]) for m in (fitted(TINY, kind=kind), fitted(quick, kind=kind))
    ]
    assert errors[1] < 0.5 * errors[0] and errors[1] < 0.5


def test_the_seed_decides_and_nothing_else():
    test = tiny_sequence(12, phase=1.0)
    first, again, other = (roll_out(fitted(TINY, seed=seed), test).garment for seed in (0, 0, 1))
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 1e-6


def test_an_interrupted_training_ends_as_one_that_was_not(kind, tmp_path, monkeypatch):
    whole = fitted(TINY, kind=kind)
    monkeypatch.setattr(training, "CHECKPOINT_SECONDS", 0.0)
    monkeypatch.setattr(training, "learning_rate", _killed_at(3))
    with pytest.raises(KeyboardInterrupt):
        fitted(TINY, folder=tmp_path, kind=kind)
    monkeypatch.undo()
    resumed = fitted(TINY, folder=tmp_path, kind=kind)
    for mine, its in zip(whole.net.state_dict().values(), resumed.net.state_dict().values(), strict=True):
        assert torch.equal(mine, its)


def _killed_at(step):
    rate = training.learning_rate

    def learning_rate(options, now):
        if now == step:
            raise KeyboardInterrupt
        return rate(options, now)

    return learning_rate


def test_codes_stay_where_training_was_whatever_comes(kind):
    """Wild weights and a body from elsewhere: after hundreds of steps the garment is as near as training's farthest."""
    method = fitted(TINY, kind=kind)
    with torch.no_grad():
        for weight in method.net.parameters():
            weight.mul_(50.0)
    rng, mean = np.random.default_rng(0), method.net.mean.numpy()
    last, before = rng.normal(size=(2, len(method.garment.basis)))
    memory = method.start(last, before, rng.normal(size=len(method.body.basis)))
    for _ in range(300):
        code, memory = method.following(memory, 100 * rng.normal(size=len(method.body.basis)))
        assert np.linalg.norm((code - mean) / method.net.codes.numpy()) <= 1.0001 * method.net.reach.item()


def test_a_memory_fades_and_the_pose_stays():
    """On a body that stands still, the linear map goes to what the pose says, by the factors that it keeps."""
    method = fitted(kind=LinearMemory)
    still = np.zeros(len(method.body.basis))
    last, before = np.zeros((2, len(method.garment.basis)))
    memory, codes = method.start(last, before, still), []
    for _ in range(3):
        code, memory = method.following(memory, still)
        codes.append(code)
    posed = method.net.posed(torch.zeros(1, len(still)))[0].detach().numpy()
    kept = torch.sigmoid(method.net.kept).detach().numpy()
    assert np.all((kept > 0) & (kept < 1))
    for k, code in enumerate(codes, start=1):
        np.testing.assert_allclose(code, posed - kept**k * posed, atol=1e-5)


def test_nothing_crosses_from_one_sequence_into_the_next():
    """Steps over a border would be jumps of half a metre: the spread of changes in a frame would show them."""
    one = tiny_sequence(40)
    off = replace(one, garment=one.garment + np.float32([0, 0, 0.5]))
    changes = [fitted(TINY, train).net.changes.max() for train in ((one,), (one, off))]
    assert changes[1] < 2 * changes[0]


def test_too_short_a_sequence_is_told():
    with pytest.raises(UserError, match="has 5 frames; wanted at least 6"):
        fitted(train=(tiny_sequence(40), tiny_sequence(5)))
