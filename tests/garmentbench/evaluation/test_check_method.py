"""What is wrong with a method is told to its author; methods that keep the contract pass."""

from dataclasses import replace

import pytest
from foreign_methods import (
    Config,
    FitRaises,
    Forgets,
    Good,
    HidesState,
    Nameless,
    NaN,
    Raises,
    Random,
    Writes,
    WrongShape,
)

from garmentbench.evaluation.check_method import check_method
from garmentbench.methods import METHODS, load_method
from garmentbench.pipeline import choose_method
from garmentbench.scenes.presets import preset


@pytest.mark.parametrize(
    ("method", "where", "what"),
    [
        (FitRaises, "fit", "raised ZeroDivisionError: no data"),
        (Raises, "step", "frame 7 failed: raised ZeroDivisionError"),
        (WrongShape, "step", "frame 7 failed: returned float32 of shape"),
        (NaN, "step", "frame 7 diverged"),
        (Forgets, "load", "predicts something else"),
        (HidesState, "step", "disturb each other"),
        (Random, "step", "twice, gives different garments"),
        (Writes, "step", "writes into the history"),
    ],
)
def test_a_broken_contract_is_told(method, where, what):
    problems = check_method(method, Config())
    assert len(problems) == 1 and problems[0].where.startswith(where) and what in problems[0].what and problems[0].do


def test_missing_parts_are_told_all_at_once():
    assert [p.where for p in check_method(Nameless, Config())] == ["name", "step"]


def test_a_good_method_passes():
    assert check_method(Good, Config()) == []


@pytest.mark.parametrize("name", METHODS)
def test_our_own_methods_keep_the_contract(name):
    method = load_method(name)
    config = choose_method(method, "full", preset("smoke")).config
    if name == "motion_guided":
        for stage in ("sdf", "stage1", "stage2"):
            options = getattr(config, stage)
            config = replace(config, **{stage: replace(options, training=replace(options.training, steps=3))})
    assert check_method(method, config) == []
