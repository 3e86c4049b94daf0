"""What the networks are given of each frame, as tensors.

Positions are relative to the mean of the frame's seeds: that keeps float32 at its best however far the scene is from
the origin, and changes nothing else, since all that the networks see is relative to the body.
"""

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from garmentbench.geometry.seeds import SeedPoints, seed_frames


@dataclass(frozen=True)
class BodyFrames:
    """The body in T frames.

    Attributes:
        centre: Mean of the seeds [m], world, shape (T, 1, 3), float64 array.
        seeds: b_t relative to the centre [m], shape (T, N, 3).
        normals: n_t, shape (T, N, 3).
        rotations: R_t from the canonical pose, shape (T, N, 3, 3).
    """

    centre: np.ndarray
    seeds: Tensor
    normals: Tensor
    rotations: Tensor

    def at(self, frames: Tensor) -> "BodyFrames":
        """Some of the frames, by index."""
        return BodyFrames(self.centre[frames.numpy()], self.seeds[frames], self.normals[frames], self.rotations[frames])


def body_frames(body: np.ndarray, seeds: SeedPoints, rotation: str, device: torch.device) -> BodyFrames:
    """From body vertices [m], shape (T, B, 3). `rotation` is the option `Model.seed_rotation`."""
    positions, rotations, normals = seed_frames(body, seeds)
    if rotation == "normal":
        rotations = smallest_rotations(seeds.frames[..., 2], normals)
    centre = positions.mean(axis=-2, keepdims=True, dtype=np.float64)
    return BodyFrames(centre, *(to_tensor(x, device) for x in (positions - centre, normals, rotations)))


def to_tensor(array: np.ndarray, device: torch.device) -> Tensor:
    """A float32 tensor on the device."""
    return torch.from_numpy(np.ascontiguousarray(array, np.float32)).to(device)


def smallest_rotations(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The smallest rotations that carry unit vectors `start`, shape (N, 3), to `end`, shape (..., N, 3)."""
    middle = start + end
    squared = middle[..., :, None] * middle[..., None, :]
    twice = 2 * end[..., :, None] * start[..., None, :]
    return np.eye(3) + twice - squared / (1 + np.sum(start * end, axis=-1))[..., None, None]
