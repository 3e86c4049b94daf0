"""What the dynamic-aware encoder is given: the garment's last state beside the body's present one (section 5)."""

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from methods.motion_guided.descriptor import force_strength
from methods.motion_guided.frames import BodyFrames
from methods.motion_guided.generative import GenerativeModel


@dataclass(frozen=True)
class Inputs:
    """Inputs at some frames t.

    Attributes:
        features: S(M^P_{t-1}), shape (batch, width, S, S).
        motion: Map of velocity and acceleration at t - 1 [m a frame], shape (batch, 6, S, S).
        strength: Map of the interaction force, shape (batch, N, S, S); None where there is nothing to touch.
        normals: Seed normals at t, shape (batch, N, 3); None likewise.
    """

    features: Tensor
    motion: Tensor
    strength: Tensor | None
    normals: Tensor | None

    def at(self, chosen: Tensor) -> "Inputs":
        """Some of the frames, by index."""
        return Inputs(*(None if x is None else x[chosen] for x in vars(self).values()))

    @classmethod
    def joined(cls, parts: list["Inputs"]) -> "Inputs":
        """Inputs of several batches, one after another."""
        columns = zip(*(vars(part).values() for part in parts), strict=True)
        return cls(*(None if column[0] is None else torch.cat(column) for column in columns))


@dataclass(frozen=True)
class Past:
    """The garment before frames t, as tensors.

    Attributes:
        garment: g_{t-1} in the coordinates of frame t - 1 [m], shape (batch, V, 3).
        carried: g_{t-1} in the coordinates of frame t [m], shape (batch, V, 3).
        motion: Velocity x_{t-1} - x_{t-2} and acceleration v_{t-1} - v_{t-2} in the axes of frame t - 1 [m a frame],
            shape (batch, V, 6). No division by the time step.
    """

    garment: Tensor
    carried: Tensor
    motion: Tensor

    def at(self, chosen: Tensor) -> "Past":
        """Some of the frames, by index."""
        return Past(*(x[chosen] for x in vars(self).values()))


def past_of(garments: np.ndarray, before: BodyFrames, now: BodyFrames) -> Past:
    """What is before frames t.

    Args:
        garments: World positions from three frames before the first t to one before the last [m], shape (T + 2, V, 3).
        before: The body in frames t - 1.
        now: The body in frames t.
    """
    velocity = np.diff(garments, axis=0)
    motion = torch.cat([before.turned(velocity[1:]), before.turned(np.diff(velocity, axis=0))], dim=-1)
    return Past(before.local(garments[2:]), now.local(garments[2:]), motion)


@torch.no_grad()
def dynamic_inputs(
    model: GenerativeModel, past: Past, before: BodyFrames, now: BodyFrames, force_distance: str | None
) -> Inputs:
    """Inputs at frames t.

    Args:
        model: The trained generative model.
        past: The garment before.
        before: The body at t - 1.
        now: The body at t.
        force_distance: The option `Stage2.force_distance`; None where there is nothing to touch.
    """
    features, motion = model.features(past.garment, before.seeds), model.to_map(past.motion)
    if force_distance is None:
        return Inputs(features, motion, None, None)
    previous = now.local(before.world(before.seeds)) if force_distance == "previous" else None
    strength = force_strength(past.carried, now.seeds, now.normals, previous)
    return Inputs(features, motion, model.to_map(strength), now.normals)
