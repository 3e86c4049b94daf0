"""Stage 2: training of the dynamic-aware encoder (section 5), teacher-forced, one step ahead."""

from dataclasses import dataclass, replace

import numpy as np
import torch
from torch import Tensor

from garmentbench.method import FitRun
from methods.motion_guided.config import Model, Stage2
from methods.motion_guided.dynamics import DynamicEncoder
from methods.motion_guided.generative import GenerativeModel
from methods.motion_guided.inputs import Inputs, Past, dynamic_inputs, past_of
from methods.motion_guided.losses import dynamic_pair, latent_regulariser
from methods.motion_guided.pose_noise import PoseNoise
from methods.motion_guided.stage1 import TrainingFrames
from methods.motion_guided.training import batch_at, generator, train

FIRST = 3  # the first frame with a velocity and an acceleration before it
CHUNK = 16  # frames at once where no gradient is needed


@dataclass(frozen=True)
class Teacher:
    """The training frames as stage 2 sees them, the generative model frozen.

    Attributes:
        frames: Training frames.
        past: What is before each frame of `FIRST` on.
        codes: Z* = E^Sta of the true garments, shape (T, latent).
        inputs: Of frames `FIRST` on, where they are cached (option `cache_inputs`).
    """

    frames: TrainingFrames
    past: Past
    codes: Tensor
    inputs: Inputs | None


@torch.no_grad()
def teacher(
    model: GenerativeModel, frames: TrainingFrames, garments: np.ndarray, options: Stage2, touches: bool
) -> Teacher:
    """What stage 2 learns from. `garments`: true world positions [m], shape (T, V, 3)."""
    predicted = torch.arange(FIRST, len(frames))
    past = past_of(garments[:-1], frames.body.at(predicted - 1), frames.body.at(predicted))
    chunks = torch.arange(len(frames)).split(CHUNK)
    codes = torch.cat([model.encode(frames.garments[c], frames.body.seeds[c]) for c in chunks])
    plain = Teacher(frames, past, codes, None)
    if not options.cache_inputs:
        return plain
    cached = Inputs.joined([inputs_at(model, plain, c, options, touches) for c in predicted.split(CHUNK)])
    return Teacher(frames, past, codes, cached)


def inputs_at(model: GenerativeModel, teacher: Teacher, t: Tensor, options: Stage2, touches: bool) -> Inputs:
    """Teacher-forced inputs at frames `t` (of `FIRST` on), shape (batch,)."""
    if teacher.inputs is not None:
        return teacher.inputs.at(t - FIRST)
    body, distance = teacher.frames.body, options.force_distance if touches else None
    return dynamic_inputs(model, teacher.past.at(t - FIRST), body.at(t - 1), body.at(t), distance)


def fit_stage2(
    model: GenerativeModel, teacher: Teacher, sizes: Model, options: Stage2, touches: bool, run: FitRun
) -> None:
    """Train C and E^Dyn with S, D, R and the radii fixed; their weights go into the run's folder."""
    torch.manual_seed(run.seed)
    dynamics = DynamicEncoder(sizes, len(model.canonical_seeds) if touches else None).to(teacher.codes.device)

    noise = PoseNoise(model, options.pose_noise) if options.pose_noise else None

    def loss(step: int) -> dict[str, Tensor]:
        t = FIRST + batch_at(step, options.training.batch, len(teacher.frames) - FIRST, run.seed)
        inputs = inputs_at(model, teacher, t, options, touches)
        if noise:
            garment, seeds = teacher.frames.garments[t - 1], teacher.frames.body.seeds[t - 1]
            with torch.no_grad():
                inputs = replace(inputs, features=model.features(*noise(garment, seeds, generator(run.seed, step))))
        return stage2_loss(model, dynamics, teacher, t, inputs, options)

    train(dynamics, loss, options.training, run, "stage 2: dynamics")


def stage2_loss(
    model: GenerativeModel, dynamics: DynamicEncoder, teacher: Teacher, t: Tensor, inputs: Inputs, options: Stage2
) -> dict[str, Tensor]:
    """Terms of eq. 2 at frames `t`, shape (batch,): each once for the frame and once for the virtual sample."""
    codes, frames = dynamics(inputs), t
    if options.virtual_sample:
        codes, frames = torch.cat([codes, dynamics.still(inputs.features)]), torch.cat([t, t - 1])
    body = teacher.frames.body.at(frames)
    posed = model.pose(model.displaced(codes), body.seeds, body.rotations)
    kinds = 2 if options.virtual_sample else 1  # a mean over both kinds, times their number, is a sum of two means
    terms = {
        "geometry": kinds * dynamic_pair(posed, teacher.frames.garments[frames]),
        "code": kinds * dynamic_pair(codes, teacher.codes[frames]),
        "latent": kinds * latent_regulariser(codes),
    }
    total = options.pair_weight * (terms["geometry"] + terms["code"]) + options.latent_weight * terms["latent"]
    return {"total": total, **terms}
