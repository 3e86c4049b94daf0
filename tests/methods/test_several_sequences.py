"""A training set is one or more sequences, and nothing crosses from one into the next."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from garmentbench.errors import UserError
from garmentbench.evaluation.rollout import roll_out
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.methods import METHODS, load_method
from garmentbench.methods.baselines.code_dynamics import AGO
from garmentbench.methods.baselines.linear_subspace import LinearSubspace
from garmentbench.methods.baselines.ridge_dynamics import transitions
from garmentbench.methods.baselines.subspace import Sizes, recorded
from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.methods.motion_guided.config import config_for
from garmentbench.methods.motion_guided.generative import GenerativeModel
from garmentbench.methods.motion_guided.samples import Recorded
from garmentbench.methods.motion_guided.stage1 import training_frames
from garmentbench.metrics.l2 import l2
from garmentbench.pipeline.choice import choose_method
from garmentbench.scenes.presets import preset
from garmentbench.storage.runs import RunStore

CUT = 40


def wide(frames, scale=1.05):
    """The tiny sequence on a body, and with a garment, of another rest shape."""
    sequence = tiny_sequence(frames, phase=0.5)
    middle = sequence.body.mean(axis=1, keepdims=True)
    template = sequence.template
    return replace(
        sequence,
        garment=(middle + scale * (sequence.garment - middle)).astype(np.float32),
        body=(middle + scale * (sequence.body - middle)).astype(np.float32),
        template=replace(
            template,
            garment=replace(template.garment, rest=template.garment.rest * np.float32(scale)),
            body=replace(template.body, rest=template.body.rest * np.float32(scale)),
        ),
    )


def few_steps(name):
    config = choose_method(name, "full", preset("smoke")).config
    if name != "motion_guided":
        return config
    stages = {s: getattr(config, s) for s in ("sdf", "stage1", "stage2")}
    return replace(config, **{s: replace(o, training=replace(o.training, steps=3)) for s, o in stages.items()})


def test_two_halves_of_a_sequence_lack_only_the_steps_over_the_border():
    """Frame 40 begins the second half: its codes and inputs need three frames, and a step two codes before it."""
    whole = tiny_sequence(80)
    seeds = np.arange(0, 100, 10)
    codes, inputs = recorded(whole, seeds, AGO)
    x, y = transitions([(codes[3:], inputs)])  # row k is the step to frame k + 5
    halves = [recorded(whole.frames(a, b), seeds, AGO) for a, b in ((0, CUT), (CUT, 80))]
    x_halves, y_halves = transitions([(z[3:], f) for z, f in halves])
    kept = [t - 5 for t in (*range(5, CUT), *range(CUT + 5, 80))]
    np.testing.assert_array_equal(x_halves, x[kept])
    np.testing.assert_array_equal(y_halves, y[kept])


def test_steps_of_two_recordings_stand_one_after_another():
    rng = np.random.default_rng(0)
    recordings = [(rng.normal(size=(n, 2)), rng.normal(size=(n, 3))) for n in (12, 9)]
    x, y = transitions(recordings)
    assert x.shape == (10 + 7, 7) and y.shape == (17, 2)
    z, f = recordings[1]
    np.testing.assert_array_equal(x[10], np.concatenate([z[1], z[0], f[2]]))
    np.testing.assert_array_equal(y[10], z[2])


def test_a_sequence_given_twice_teaches_linear_subspace_what_it_teaches_once():
    """Twice the same steps: the same regression. The ridge is relative to the summed variances, so nothing changes."""
    train, test = tiny_sequence(60), tiny_sequence(40, phase=1.0)
    once, twice = (LinearSubspace.fit((train,) * n, Sizes(codes=12), None) for n in (1, 2))
    np.testing.assert_allclose(roll_out(twice, test).garment, roll_out(once, test).garment, atol=1e-5)


def test_samples_of_the_motion_guided_model_have_their_past_in_their_own_sequence():
    first, second = tiny_sequence(12), tiny_sequence(9, phase=1.0)
    config, cpu = config_for("smoke").model, torch.device("cpu")
    canonical = Canonical.of(first.template, config)
    model = GenerativeModel(canonical, config)
    frames = training_frames((first, second), canonical, config, cpu)
    recorded = Recorded(model, frames)
    assert recorded.targets.tolist() == [*range(3, 12), *range(15, 21)]
    alone = Recorded(model, training_frames((second,), canonical, config, cpu))
    for mine, its in ((recorded.at(torch.arange(15, 21)), alone.at(torch.arange(3, 9))),):
        assert torch.equal(mine.past.carried, its.past.carried) and torch.equal(mine.past.motion, its.past.motion)
        assert torch.equal(mine.garment, its.garment) and torch.equal(mine.on.move, its.on.move)
        torch.testing.assert_close(mine.code, its.code, atol=1e-5, rtol=1e-5)  # batches of other sizes


@pytest.mark.parametrize("name", METHODS)
def test_every_method_takes_several_motions_and_bodies(name, tmp_path):
    train, config = (tiny_sequence(40), tiny_sequence(30, phase=2.0), wide(30)), few_steps(name)
    with RunStore(tmp_path).open("train", {"seed": 0}) as run:
        method = load_method(name).fit(train, config, run)
    for test in (tiny_sequence(20, phase=1.0), wide(20)):
        roll = roll_out(method, test)
        assert roll.status == "ok", roll.message
        if name in ("linear_subspace", "static_ridge", "subspace_network"):
            assert l2(roll.garment[3:], test.garment[3:]) < 1.0


def test_a_body_seen_in_training_is_predicted_better():
    test = wide(40)
    alone, both = (
        LinearSubspace.fit(train, Sizes(codes=16), None)
        for train in ((tiny_sequence(60),), (tiny_sequence(60), wide(60)))
    )
    errors = [l2(roll_out(method, test).garment[3:], test.garment[3:]) for method in (alone, both)]
    assert errors[1] < 0.5 * errors[0]


def test_too_short_a_sequence_among_several_is_told():
    with pytest.raises(UserError, match="has 6 frames; wanted at least 7"):
        LinearSubspace.fit((tiny_sequence(40), tiny_sequence(6)), Sizes(), None)
