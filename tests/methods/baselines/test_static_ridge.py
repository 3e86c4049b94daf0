"""The pose alone: the garment is not looked at, half a second of poses is."""

from dataclasses import replace

import numpy as np
import pytest

from garmentbench.evaluation.check_method import parametrize_with_checks
from garmentbench.evaluation.rollout import roll_out
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.method import BodyFrame, History
from garmentbench.methods.baselines.static_ridge import Config, StaticRidge, looked_at
from garmentbench.methods.baselines.subspace import features
from garmentbench.metrics.l2 import l2

SMALL = Config(seeds=20, codes=8, body_codes=16)


@parametrize_with_checks([(StaticRidge, SMALL)])
def test_it_keeps_the_contract(method, check):
    check(method)


def test_training_lowers_the_error():
    train, test = tiny_sequence(150), tiny_sequence(60, phase=1.0)
    method = StaticRidge.fit((train,), Config(), None)
    rest = np.broadcast_to(test.template.garment.rest, test.garment.shape)
    assert l2(roll_out(method, test).garment[3:], test.garment[3:]) < 0.1 * l2(rest[3:], test.garment[3:])


def test_the_garment_is_not_looked_at():
    """Whatever the garment did before, the prediction is the same."""
    test = tiny_sequence(30, phase=1.0)
    method = StaticRidge.fit((tiny_sequence(60),), SMALL, None)
    other = replace(
        test, garment=test.garment + np.float32(0.3) * np.random.default_rng(0).random(test.garment.shape, np.float32)
    )
    history, strange = History.before(test, 3), History.before(other, 3)
    garments = [method.step(method.begin(test.template, h), BodyFrame(test.body[3]))[0] for h in (history, strange)]
    np.testing.assert_array_equal(*garments)


def test_it_looks_back_half_a_second_whatever_the_rate():
    assert looked_at(30.0)[0] == 15 and looked_at(60.0)[0] == 30 and looked_at(30.0)[-1] == 0
    test = tiny_sequence(40, phase=1.0)
    method = StaticRidge.fit((tiny_sequence(60),), SMALL, None)

    def predicted(bodies):
        state = method.begin(test.template, History(test.garment[:3], bodies[:3]))
        for frame in range(3, 30):
            garment, state = method.step(state, BodyFrame(bodies[frame]))
        return garment

    plain = predicted(test.body)
    for ago, matters in ((15, True), (16, False)):
        moved = test.body.copy()
        moved[29 - ago, :, 0] += 0.1
        assert (np.abs(predicted(moved) - plain).max() > 1e-6) == matters


def test_before_the_first_frame_the_body_stands():
    sequence = tiny_sequence(10)
    skin = StaticRidge.fit((sequence,), SMALL, None).skin_of(sequence.template)
    stood = np.concatenate([np.repeat(sequence.body[:1], 12, axis=0), sequence.body[:4]])
    np.testing.assert_array_equal(features(skin, sequence.body[:4], (15, 3, 0)), features(skin, stood, (15, 3, 0)))


@pytest.mark.parametrize("frames", [1, 4])
def test_several_sequences_and_the_same_again(frames):
    train = (tiny_sequence(40), tiny_sequence(30, phase=2.0))
    test = tiny_sequence(10 + frames, phase=1.0)
    first, second = (roll_out(StaticRidge.fit(train, SMALL, None), test).garment for _ in range(2))
    np.testing.assert_array_equal(first, second)
