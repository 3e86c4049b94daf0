"""What the dynamic-aware encoder is given: the garment's last state beside the body's present one (section 5)."""

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from methods.motion_guided.descriptor import force_strength
from methods.motion_guided.frames import BodyFrames, to_tensor
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


def motion_of(garments: np.ndarray) -> np.ndarray:
    """Velocity x_t - x_{t-1} and acceleration v_t - v_{t-1} [m a frame], shape (T - 2, V, 6), of frames 2 on.

    No division by the time step. `garments`: world positions [m], shape (T, V, 3).
    """
    velocity = np.diff(garments, axis=0)
    return np.concatenate([velocity[1:], np.diff(velocity, axis=0)], axis=-1)


def force_map(
    model: GenerativeModel, garment: Tensor, before: BodyFrames, now: BodyFrames, distance_to: str
) -> Tensor:
    """Map of the interaction force's size, shape (batch, N, S, S).

    Args:
        model: For its UV map.
        garment: g_{t-1} relative to the centre of `before` [m], shape (batch, V, 3).
        before: The body at t - 1.
        now: The body at t.
        distance_to: The option `Stage2.force_distance`.
    """
    moved = to_tensor(now.centre - before.centre, garment.device)
    previous = before.seeds - moved if distance_to == "previous" else None
    return model.to_map(force_strength(garment - moved, now.seeds, now.normals, previous))


@torch.no_grad()
def dynamic_inputs(
    model: GenerativeModel,
    garment: Tensor,
    motion: Tensor,
    before: BodyFrames,
    now: BodyFrames,
    force_distance: str,
    touches: bool,
) -> Inputs:
    """Inputs at frames t.

    Args:
        model: The trained generative model.
        garment: g_{t-1} relative to the centre of `before` [m], shape (batch, V, 3).
        motion: Velocity and acceleration at t - 1 [m a frame], shape (batch, V, 6).
        before: The body at t - 1.
        now: The body at t.
        force_distance: The option `Stage2.force_distance`.
        touches: There is something to touch.
    """
    features = model.features(garment, before.seeds)
    strength = force_map(model, garment, before, now, force_distance) if touches else None
    return Inputs(features, model.to_map(motion), strength, now.normals if touches else None)
