"""What the dynamic-aware encoder is given: the garment's last state beside the body's present one (section 5)."""

from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor

from garmentbench.methods.motion_guided.config import Stage2
from garmentbench.methods.motion_guided.descriptor import force_strength
from garmentbench.methods.motion_guided.frames import Link, Pose
from garmentbench.methods.motion_guided.generative import GenerativeModel

PLACE_UNIT, STEP_UNIT = 0.1, 0.03  # [m], [m a frame]


@dataclass(frozen=True)
class Inputs:
    """Inputs at some frames t.

    Attributes:
        features: S(M^P_{t-1}), shape (batch, width, S, S).
        motion: Map of velocity and acceleration at t - 1 [m a frame], shape (batch, 6, S, S).
        strength: Map of the interaction force, shape (batch, N, S, S); None without the option `Stage2.force`.
        normals: Seed normals at t, shape (batch, N, 3); None likewise.
        place: Where the seeds are at t, and how they have moved since t - 1, in `PLACE_UNIT` and `STEP_UNIT`, shape
            (batch, 6 N). Used with the option `Stage2.pose_path` only.
        still_place: The same at t - 1 had nothing moved.
    """

    features: Tensor
    motion: Tensor
    strength: Tensor | None
    normals: Tensor | None
    place: Tensor
    still_place: Tensor

    def at(self, chosen: Tensor) -> "Inputs":
        """Some of the frames, by index."""
        parts: list[Any] = [None if x is None else x[chosen] for x in vars(self).values()]
        return Inputs(*parts)

    @classmethod
    def joined(cls, parts: list["Inputs"]) -> "Inputs":
        """Inputs of several batches, one after another."""
        columns = zip(*(vars(part).values() for part in parts), strict=True)
        joined: list[Any] = [None if column[0] is None else torch.cat(column) for column in columns]
        return cls(*joined)


@dataclass(frozen=True)
class Past:
    """The garment before frames t.

    Attributes:
        garment: g_{t-1} in the coordinates of frame t - 1 [m], shape (batch, V, 3).
        carried: g_{t-1} in the coordinates of frame t [m], shape (batch, V, 3).
        motion: Velocity x_{t-1} - x_{t-2} and acceleration v_{t-1} - v_{t-2} in the axes of frame t - 1 [m a frame],
            shape (batch, V, 6). No division by the time step.
    """

    garment: Tensor
    carried: Tensor
    motion: Tensor


def past_of(third: Tensor, second: Tensor, last: Tensor, on: Link) -> Past:
    """What is before frames t.

    Args:
        third: g_{t-3} in the coordinates of frame t - 1 [m], shape (batch, V, 3).
        second: g_{t-2}, likewise.
        last: g_{t-1}, likewise.
        on: From these to the coordinates of frame t.
    """
    velocity = last - second
    return Past(last, on(last), torch.cat([velocity, velocity - (second - third)], dim=-1))


@torch.no_grad()
def dynamic_inputs(model: GenerativeModel, past: Past, before: Pose, now: Pose, on: Link, options: Stage2) -> Inputs:
    """Inputs at frames t.

    Args:
        model: The trained generative model.
        past: The garment before.
        before: The body at t - 1.
        now: The body at t.
        on: From the coordinates of frame t - 1 to those of frame t.
        options: What the encoder is given.
    """
    if not options.garment:
        features = model.features(model.pose(model.rest.expand(len(now.seeds), -1, -1), now), now.seeds)
    else:
        features = model.features(past.garment, before.seeds)
    motion = model.to_map(past.motion if options.velocity else torch.zeros_like(past.motion))
    previous = on(before.seeds)
    place, still = flat_place(model, now.seeds, previous), flat_place(model, before.seeds, before.seeds)
    if not options.force:
        return Inputs(features, motion, None, None, place, still)
    distance_to = previous if options.force_distance == "previous" else None
    strength = force_strength(past.carried, now.seeds, now.normals, distance_to)
    return Inputs(features, motion, model.to_map(strength), now.normals, place, still)


def flat_place(model: GenerativeModel, seeds: Tensor, previous: Tensor) -> Tensor:
    """`Inputs.place` of seeds now and before, in the coordinates of now [m], shape (batch, N, 3)."""
    place, step = (seeds - model.mean_seeds) / PLACE_UNIT, (seeds - previous) / STEP_UNIT
    return torch.cat([place, step], dim=1).flatten(1)
