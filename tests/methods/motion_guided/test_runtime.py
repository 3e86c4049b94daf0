"""The fast path of a roll-out against the plain functions that the model was trained as."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from garmentbench.method import BodyFrame, History
from garmentbench.methods.motion_guided import MotionGuided
from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.methods.motion_guided.config import VARIANTS, for_scene
from garmentbench.methods.motion_guided.dynamics import DynamicEncoder
from garmentbench.methods.motion_guided.frames import link
from garmentbench.methods.motion_guided.generative import GenerativeModel
from garmentbench.methods.motion_guided.inputs import dynamic_inputs, past_of

EQUAL = 1e-5  # [m]


def _plain(method: MotionGuided, state, body: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Garment, world, and B of the next frame by the functions that training uses."""
    now, on = method._body(body), link(state.body, method._body(body))
    past = past_of(*(state.body.local(g[None]) for g in state.garments), on)
    inputs = dynamic_inputs(method.generative, past, state.body.pose, now.pose, on, method.config.stage2)
    displaced = method.generative.displaced(method.dynamics(inputs))
    posed = method.generative.pose(displaced, now.pose)
    return now.world(posed)[0], method.generative.directions(displaced, now.pose)[0].numpy()


def _method(sequence, config) -> MotionGuided:
    """With random weights, none of them idle, and units, means and paths that are not those of an untrained model."""
    torch.manual_seed(0)
    config = for_scene(config, sequence.template.needs)
    config = replace(config, collision=replace(config.collision, enabled=False))
    canonical = Canonical.of(sequence.template, config.model)
    model = GenerativeModel(canonical, config.model).requires_grad_(False)
    dynamics = DynamicEncoder(config.model, len(canonical.seeds.rest), config.stage2).requires_grad_(False)
    dynamics.motion_unit.copy_(0.01 + torch.rand(6, 1, 1) / 50)
    dynamics.force_unit.fill_(0.01)
    for name in ("mean_garment", "mean_seeds", *("space_basis",) * config.model.linear_paths):
        getattr(model, name).copy_(0.01 * torch.randn_like(getattr(model, name)))
    if config.stage2.pose_path:
        dynamics.path_weight.copy_(0.01 * torch.randn_like(dynamics.path_weight))
    return MotionGuided(canonical, config, model, dynamics)


@pytest.mark.parametrize("kind", ["sequence", "object_sequence"])
@pytest.mark.parametrize("variant", [*VARIANTS, "previous", "world_axes"])
@torch.no_grad()
def test_every_step_is_the_plain_ones(request, config, kind, variant):
    sequence = request.getfixturevalue(kind)
    config = VARIANTS.get(variant, VARIANTS["full"])(config)
    if variant == "previous":
        config = replace(config, stage2=replace(config.stage2, force_distance="previous"))
    if variant == "world_axes":
        config = replace(config, model=replace(config.model, axes="world", map_border=0.0, centred_descriptor=False))
    method = _method(sequence, config)
    pressed = sequence.garment - 0.3 * (sequence.garment - sequence.body.mean(axis=1, keepdims=True))  # into the body
    state = method.begin(sequence.template, History.before(replace(sequence, garment=pressed), 3))
    for t in range(3, 8):
        garment, directions = _plain(method, state, sequence.body[t])
        now = method._body(sequence.body[t])
        _, rotations = method.runtime.garment(method.runtime.code(state.garments, state.body, now), now.pose)
        np.testing.assert_allclose(method.runtime.directions(rotations), directions, atol=1e-4)
        _, state = method.step(state, BodyFrame(sequence.body[t]))
        np.testing.assert_allclose(state.garments[-1], garment, atol=EQUAL)


@torch.no_grad()
def test_a_trained_models_too(trained, sequence):
    state = trained.begin(sequence.template, History.before(sequence, 3))
    state = replace(state, collision=None)
    for t in range(3, 12):
        garment, _ = _plain(trained, state, sequence.body[t])
        _, state = trained.step(state, BodyFrame(sequence.body[t]))
        np.testing.assert_allclose(state.garments[-1], garment, atol=EQUAL)
