"""What a small model of the published configuration has learnt: its error falls, and what it is given matters."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import torch
from swaying_tube import ringing_sequence, sized

from garmentbench.methods.motion_guided import MotionGuided
from garmentbench.methods.motion_guided.config import Stage2, Training, config_for
from garmentbench.methods.motion_guided.frames import Pose
from garmentbench.methods.motion_guided.inputs import Inputs
from garmentbench.methods.motion_guided.samples import Recorded, Sample
from garmentbench.methods.motion_guided.stage1 import TrainingFrames, training_frames
from garmentbench.methods.motion_guided.stage2 import sample_inputs, stage2_loss

CPU = torch.device("cpu")


@pytest.fixture(scope="module")
def learned(store) -> tuple[MotionGuided, TrainingFrames]:
    """Four hundred steps a stage on a tube that rings: where it is does not tell whether it swells or shrinks."""
    sequence = ringing_sequence(60)
    published = config_for("smoke")
    config = sized(published, Training(steps=400, batch=2, learning_rate=4e-3, schedule="one_cycle"))
    sdf = replace(published.sdf, batch=64, training=replace(published.sdf.training, steps=150))
    config = replace(config, sdf=sdf, model=replace(config.model, width=8, latent=16))
    with store.open("train", {"seed": 0, "ringing": True}) as run:
        method = MotionGuided.fit((sequence,), config, run)
    return method, training_frames((sequence,), method.canonical, config.model, CPU)


@pytest.fixture(scope="module")
def step(learned) -> tuple[Sample, Inputs]:
    """All training samples, and their inputs."""
    method, frames = learned
    recorded = Recorded(method.generative, frames)
    sample = recorded.at(recorded.targets)
    return sample, sample_inputs(method.generative, sample, method.config.stage2)


@torch.no_grad()
def _predicted(method: MotionGuided, sample: Sample, inputs: Inputs) -> torch.Tensor:
    return method.generative.pose(method.generative.displaced(method.dynamics(inputs)), sample.now)


def _cm(a: torch.Tensor, b: torch.Tensor) -> float:
    return 100 * (a - b).norm(dim=-1).mean().item()


@torch.no_grad()
def test_training_lowers_the_error_of_both_stages(learned, step):
    (method, frames), (sample, inputs) = learned, step
    model, pose = method.generative, frames.body.pose
    constant = _cm(model.pose(model.displaced(torch.zeros(len(frames), 16)), pose), frames.garments)
    mean = _cm(frames.garments, frames.garments.mean(dim=0))
    coded = _cm(model.pose(model.displaced(model.encode(frames.garments, pose.seeds)), pose), frames.garments)
    assert coded < 0.6 * min(constant, mean)
    assert _cm(_predicted(method, sample, inputs), sample.garment) < 0.6 * mean


@pytest.mark.parametrize(("name", "millimetres"), [("velocity", 1.0), ("force", 0.3)])
def test_what_guides_the_motion_moves_the_garment(learned, step, name, millimetres):
    method, (sample, inputs) = learned[0], step
    without = replace(inputs, strength=torch.zeros_like(inputs.strength))
    if name == "velocity":
        without = replace(inputs, motion=torch.cat([0 * inputs.motion[:, :3], inputs.motion[:, 3:]], dim=1))
    moved = 10 * _cm(_predicted(method, sample, without), _predicted(method, sample, inputs))
    assert moved > millimetres


def test_velocity_acceleration_and_force_are_given_in_units_of_their_own_spread(learned, step):
    method, (_, inputs) = learned[0], step
    covered = method.generative.to_map.mask.sum()
    scaled = inputs.motion / method.dynamics.motion_unit
    for x in (scaled[:, :3], scaled[:, 3:], inputs.strength / method.dynamics.force_unit):
        rms = (x.square().sum() / (len(x) * x.shape[1] * covered)).sqrt()
        assert rms.item() == pytest.approx(1, abs=1e-3)


@torch.no_grad()
def test_an_output_of_one_is_what_displacements_measure(learned):
    method, frames = learned
    model = method.generative
    away = frames.garments - model.pose(model.rest.expand(len(frames), -1, -1), frames.body.pose)
    assert model.unit.item() == pytest.approx(away.square().mean().sqrt().item(), rel=0.1)


@torch.no_grad()
def test_codes_answer_to_the_seeds_and_to_the_garment(learned):
    method, frames = learned
    model, seeds = method.generative, frames.body.pose.seeds
    codes = model.encode(frames.garments, seeds)
    spread = codes.std(dim=0).norm()

    def answer(garments: torch.Tensor, seeds: torch.Tensor) -> float:
        return ((model.encode(garments, seeds) - codes).norm(dim=1).mean() / spread).item()

    assert answer(frames.garments.roll(5, 0), seeds) > 0.3
    assert answer(frames.garments, seeds + torch.tensor([0.02, 0.0, 0.0])) > 0.1


class _Fixed:
    """A dynamic encoder and a generative model that give what is known: a code's first three numbers are the vertex."""

    def __init__(self, moved: list[float], still: list[float]) -> None:
        self.moved, self.kept = torch.tensor([moved]).float(), torch.tensor([still]).float()

    def __call__(self, inputs: object) -> torch.Tensor:
        return self.moved

    def still(self, inputs: object) -> torch.Tensor:
        return self.kept


@pytest.mark.parametrize("virtual", [True, False])
def test_stage2_loss_by_hand(virtual):
    """Codes (1, 2, 3) for (1, 2, 4) and, where nothing changes, (0, 0, 2) for (0, 0, 0); one vertex each."""
    options = Stage2(virtual_sample=virtual, pair_weight=0.5, code_weight=2.0, latent_weight=0.1)
    model = SimpleNamespace(displaced=lambda code: code[:, None], pose=lambda displaced, pose: displaced)
    pose = Pose(*(torch.zeros(1, 1, 3) for _ in range(4)))
    past = SimpleNamespace(garment=torch.tensor([[[0.0, 0, 1]]]))
    now, code, before = torch.tensor([[[1.0, 2, 3.5]]]), torch.tensor([[1.0, 2, 4]]), torch.zeros(1, 3)
    sample = SimpleNamespace(code=code, garment=now, now=pose, before=pose, past=past, code_before=before)
    terms = stage2_loss(model, _Fixed([1, 2, 3], [0, 0, 2]), sample, None, options)
    geometry, codes, latent = 0.5 / 3, 1 / 3, 14 / 3 - 1
    if virtual:
        geometry, codes, latent = geometry + 1 / 3, codes + 2 / 3, latent + 4 / 3 - 1
    expected = {"geometry": geometry, "code": codes, "latent": latent}
    assert {name: terms[name].item() for name in expected} == pytest.approx(expected)
    assert terms["total"].item() == pytest.approx(0.5 * (geometry + 2 * codes) + 0.1 * latent)
    assert np.isfinite(terms["total"].item())
