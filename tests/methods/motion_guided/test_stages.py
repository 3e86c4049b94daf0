"""Stages are shared between variants, and what a scene does not need is not there."""

import json
from dataclasses import asdict

import numpy as np
import pytest
import torch

from garmentbench.method import BodyFrame, History
from garmentbench.methods import training
from garmentbench.methods.motion_guided import MotionGuided
from garmentbench.methods.motion_guided.config import SIZES, VARIANTS, Config, config_for, config_from
from garmentbench.storage.runs import RunStore


def _stages(store: RunStore) -> dict[str, list[str]]:
    kinds: dict[str, list[str]] = {}
    for run in store.list():
        if run.kind != "train":
            kinds.setdefault(run.kind, []).append(run.id)
    return kinds


def test_variants_share_all_stages_that_they_do_not_change(sequence, config, tmp_path):
    store = RunStore(tmp_path)
    counts = {}
    for name, change in VARIANTS.items():
        with store.open("train", {"seed": 0, "variant": name}) as run:
            MotionGuided.fit((sequence,), change(config), run)
        counts[name] = tuple(len(_stages(store).get(kind, [])) for kind in ("sdf", "stage1", "stage2"))
    assert counts == {
        "full": (1, 1, 1),
        "fixed_weights": (1, 2, 2),
        "no_virtual_sample": (1, 2, 3),
        "no_velocity": (1, 2, 4),
        "no_force": (1, 2, 5),
        "pose_only": (1, 2, 6),
        "no_collision": (1, 2, 6),
        "push_out": (1, 2, 6),
        "linear_paths": (1, 3, 7),
    }


def test_beside_an_object_there_is_no_sdf_no_collision_stage_and_one_radius(object_sequence, linear_config, tmp_path):
    store = RunStore(tmp_path)
    with store.open("train", {"seed": 0}) as run:
        method = MotionGuided.fit((object_sequence,), linear_config, run)
    assert set(_stages(store)) == {"stage1", "stage2"}
    assert "sdf" not in store.list({"kind": "stage1"})[0].metrics()[0]
    assert method.generative.log_radii.shape == (1,)
    assert not method.config.stage2.pose_path and linear_config.stage2.pose_path
    state = method.begin(object_sequence.template, History.before(object_sequence, 3))
    garment, state = method.step(state, BodyFrame(object_sequence.body[3]))
    assert np.isfinite(garment).all()
    assert state.collision is None and state.residual is None and state.before_collision is None


def test_a_radius_for_each_part_that_has_seeds(trained):
    assert trained.generative.log_radii.shape == (2,)


def test_the_seed_of_the_run_decides_the_weights(sequence, config, store, trained):
    with store.open("train", {"seed": 1}) as run:
        other = MotionGuided.fit((sequence,), config, run)
    with store.open("train", {"seed": 0, "again": True}) as run:
        same = MotionGuided.fit((sequence,), config, run)
    weight = trained.dynamics.encoder.linear.weight
    assert torch.equal(same.dynamics.encoder.linear.weight, weight)
    assert not torch.equal(other.dynamics.encoder.linear.weight, weight)


def test_a_fit_killed_in_any_stage_goes_on_to_the_same_bits(sequence, config, tmp_path, monkeypatch, trained):
    monkeypatch.setattr(training, "CHECKPOINT_SECONDS", -1.0)
    store = RunStore(tmp_path)
    adam_step, calls = torch.optim.AdamW.step, []

    def killed_now_and_then(self, *args, **kwargs):
        calls.append(1)
        if len(calls) % 4 == 0:
            raise KeyboardInterrupt
        return adam_step(self, *args, **kwargs)

    monkeypatch.setattr(torch.optim.AdamW, "step", killed_now_and_then)
    kills = 0
    while True:
        try:
            with store.open("train", {"seed": 0}) as run:
                method = MotionGuided.fit((sequence,), config, run)
            break
        except KeyboardInterrupt:
            kills += 1
    assert kills >= 3
    for ours, theirs in ((method.generative, trained.generative), (method.dynamics, trained.dynamics)):
        other = theirs.state_dict()
        assert all(torch.equal(value, other[name]) for name, value in ours.state_dict().items())


@pytest.mark.parametrize("name", SIZES)
def test_a_configuration_survives_json(name):
    for change in VARIANTS.values():
        config = change(config_for(name))
        assert config_from(json.loads(json.dumps(asdict(config)))) == config


def test_the_paper_preset_is_the_paper():
    assert config_for("paper") == Config()
