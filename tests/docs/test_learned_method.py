"""The example of a learned method: short, within the contract, and better than holding still."""

import sys
from pathlib import Path

import numpy as np
import pytest

import garmentbench as gb
from garmentbench.methods.baselines.hold import Hold
from garmentbench.metrics.l2 import l2

FOLDER = Path(__file__).parents[2] / "docs" / "examples"
sys.path.insert(0, str(FOLDER))
from learned_method import Config, PoseGRU  # noqa: E402


def test_it_has_at_most_60_lines():
    assert len((FOLDER / "learned_method.py").read_text().splitlines()) <= 60


@gb.parametrize_with_checks([(PoseGRU, Config(steps=2))])
def test_it_keeps_the_contract(method, check):
    check(method)


def test_it_is_better_than_holding_still(tmp_path):
    train, test = (gb.tiny_sequence(60), gb.tiny_sequence(60, phase=0.5)), gb.tiny_sequence(60, phase=1.0)
    errors = []
    for method, config in ((PoseGRU, Config()), (Hold, Hold.Config())):
        with gb.training_run(tmp_path / method.name) as run:
            roll = gb.roll_out(method.fit(train, config, run), test)
        assert roll.status == "ok"
        errors.append(l2(roll.garment[3:], test.garment[3:]))
    assert errors[0] < 0.5 * errors[1]


def test_it_trains_on_bodies_of_several_shapes_and_the_seed_decides(tmp_path):
    from dataclasses import replace

    one = gb.tiny_sequence(20)
    other = replace(one, body=one.body * np.float32(1.02), garment=one.garment * np.float32(1.02))
    rolls = []
    for k, seed in enumerate((0, 0, 1)):
        with gb.training_run(tmp_path / str(k), seed) as run:
            rolls.append(gb.roll_out(PoseGRU.fit((one, other), Config(steps=3), run), one).garment)
    np.testing.assert_array_equal(rolls[0], rolls[1])
    assert not np.array_equal(rolls[0], rolls[2])


@pytest.mark.parametrize("kind", [None])
def test_without_a_body_it_says_what_to_do(kind, tmp_path):
    with gb.training_run(tmp_path) as run, pytest.raises(gb.UserError, match="no body"):
        PoseGRU.fit((gb.tiny_sequence(20, kind),), Config(), run)
