"""Training samples of stage 2: four frames in a row, as they were recorded or in random poses."""

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from garmentbench.methods.motion_guided.displacement_space import undo_pose
from garmentbench.methods.motion_guided.frames import Link, Pose, link
from garmentbench.methods.motion_guided.generative import GenerativeModel
from garmentbench.methods.motion_guided.inputs import Past, past_of
from garmentbench.methods.motion_guided.posing import RandomPoses
from garmentbench.methods.motion_guided.stage1 import TrainingFrames

FIRST = 3  # the first frame of a sequence with a velocity and an acceleration before it
CHUNK = 16  # frames at once where no gradient is needed


@dataclass(frozen=True)
class Sample:
    """What is known before frames t, and what is to be found at them.

    Attributes:
        past: The garment before.
        before: The body at t - 1.
        now: The body at t.
        on: From the coordinates of frame t - 1 to those of frame t.
        garment: G*_t [m], shape (batch, V, 3).
        code: Z*_t, shape (batch, latent).
        code_before: Z*_{t-1}.
    """

    past: Past
    before: Pose
    now: Pose
    on: Link
    garment: Tensor
    code: Tensor
    code_before: Tensor


class Recorded:
    """Samples of the training frames as they are.

    Attributes:
        targets: Frames t with three frames of the same sequence before them, shape (samples,).
    """

    def __init__(self, model: GenerativeModel, frames: TrainingFrames) -> None:
        body, steps = frames.body, torch.arange(1, len(frames))
        self.garments, self.pose = frames.garments, body.pose
        self.links = link(body.at(steps - 1), body.at(steps))
        self.codes = encode_all(model, frames)
        ends = np.cumsum(frames.lengths)
        spans = [torch.arange(end - length + FIRST, end) for length, end in zip(frames.lengths, ends, strict=True)]
        self.targets = torch.cat(spans)

    def at(self, t: Tensor) -> Sample:
        """Samples of frames `t` (some of `targets`), shape (batch,)."""
        garments = [self.garments[t - k] for k in (3, 2, 1, 0)]
        links = [self.links.at(t - k - 1) for k in (2, 1, 0)]
        poses = [self.pose.at(t - k) for k in (1, 0)]
        return _sample(garments, links, poses, self.codes[t], self.codes[t - 1])


class Reposed:
    """Samples in random poses: the same turns in all four frames, and the garments carried along (option `posing`)."""

    def __init__(self, model: GenerativeModel, frames: TrainingFrames, recorded: Recorded, poses: RandomPoses) -> None:
        self.model, self.recorded, self.poses = model, recorded, poses
        self.displaced = undo_pose(model, frames.garments, frames.body.pose)

    @torch.no_grad()
    def at(self, t: Tensor, random: torch.Generator) -> Sample:
        """Samples of frames `t` (some of `Recorded.targets`), shape (batch,)."""
        recorded, model = self.recorded, self.model
        whole, limbs = self.poses.draw(len(t), random)
        pose = [self.poses.turned(recorded.pose.at(t - k), whole, limbs) for k in (3, 2, 1, 0)]
        links = [_turned(recorded.links.at(t - k - 1), whole) for k in (2, 1, 0)]
        displaced, code_before = [self.displaced[t - k] for k in (3, 2, 1, 0)], recorded.codes[t - 1]
        if self.poses.options.code_spread:
            drawn = torch.randn(len(t), model.options.latent, generator=random).to(whole.device)
            offset = self.poses.options.code_spread * drawn
            moved = (offset @ model.space_basis).unflatten(-1, (-1, 3))
            displaced, code_before = [d + moved for d in displaced[:3]] + displaced[3:], code_before + offset
        garments = [model.pose(d, p) for d, p in zip(displaced, pose, strict=True)]
        return _sample(garments, links, pose[2:], recorded.codes[t], code_before)


@torch.no_grad()
def encode_all(model: GenerativeModel, frames: TrainingFrames) -> Tensor:
    """Z* = E^Sta of the true garments, shape (T, latent)."""
    chunks = torch.arange(len(frames)).split(CHUNK)
    return torch.cat([model.encode(frames.garments[c], frames.body.pose.seeds[c]) for c in chunks])


def _sample(garments: list[Tensor], links: list[Link], poses: list[Pose], code: Tensor, before: Tensor) -> Sample:
    """From four frames' garments, the links between them, and the last two frames' poses."""
    third, second, last, now = garments
    past = past_of(links[1](links[0](third)), links[1](second), last, links[2])
    earlier, present = poses
    return Sample(past, earlier, present, links[2], now, code, before)


def _turned(on: Link, whole: Tensor) -> Link:
    """The link between two frames that are both turned about their origins."""
    return Link(whole @ on.turn @ whole.transpose(1, 2), on.move @ whole.transpose(1, 2))
