"""Nearest frames: found by poses alone, and blended by how near they are."""

import numpy as np
import pytest

from garmentbench.evaluation.check_method import parametrize_with_checks
from garmentbench.evaluation.rollout import roll_out
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.methods.baselines.nearest import Config, Nearest
from garmentbench.metrics.l2 import l2

SMALL = Config(seeds=20, codes=8, body_codes=16)


@parametrize_with_checks([(Nearest, SMALL)])
def test_it_keeps_the_contract(method, check):
    check(method)


def test_what_it_was_trained_on_it_gives_back():
    """After the half second in which the roll-out's past is taken to have stood, as in training."""
    train = tiny_sequence(60)
    roll = roll_out(Nearest.fit((train,), Config(codes=57, body_codes=57), None), train)
    assert l2(roll.garment[20:], train.garment[20:]) < 1e-2


def test_training_lowers_the_error():
    train, test = tiny_sequence(150), tiny_sequence(60, phase=1.0)
    method = Nearest.fit((train,), Config(), None)
    rest = np.broadcast_to(test.template.garment.rest, test.garment.shape)
    assert l2(roll_out(method, test).garment[3:], test.garment[3:]) < 0.2 * l2(rest[3:], test.garment[3:])


@pytest.mark.parametrize(("count", "code"), [(1, 1.0), (2, 6 / 5), (9, 54 / 49)])
def test_blended_by_the_square_of_the_distance(count, code):
    """Codes 1, 2, 0 at 1, 2, 3 m: of two (1 + 2/4) / (1 + 1/4) = 6/5, of all (1 + 2/4) / (1 + 1/4 + 1/9) = 54/49."""
    fitted = Nearest.fit((tiny_sequence(30),), SMALL, None)
    codes, poses = np.array([[0.0], [1.0], [2.0]]), np.array([[3.0], [1.0], [-2.0]])
    frames = {"codes": codes, "poses": poses, "count": np.array(min(count, 3))}
    method = Nearest(fitted.seeds, fitted.garment, fitted.body, fitted.novelty, **frames)
    assert method.blended(np.zeros(1))[0] == pytest.approx(code)
