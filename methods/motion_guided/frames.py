"""What the networks are given of each frame, as tensors, in the frame's own coordinates.

Their origin is the mean of the seeds. That keeps float32 at its best however far the scene is from the world's origin,
and changes nothing else, since all that the networks see is relative to the body. Their axes are the world's (paper and
code) or turn with the body (ours, option `Model.axes`).
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
        origin: Mean of the seeds [m], world, shape (T, 1, 3), float64.
        axes: Columns are the frame's axes in the world's, shape (T, 3, 3), float64.
        seeds: b_t in the frame's coordinates [m], shape (T, N, 3).
        normals: n_t in the frame's axes, shape (T, N, 3).
        rotations: R_t from the canonical pose into the frame's axes, shape (T, N, 3, 3).
    """

    origin: np.ndarray
    axes: np.ndarray
    seeds: Tensor
    normals: Tensor
    rotations: Tensor

    def at(self, frames: Tensor) -> "BodyFrames":
        """Some of the frames, by index."""
        return BodyFrames(*(x[frames.numpy() if isinstance(x, np.ndarray) else frames] for x in vars(self).values()))

    def local(self, points: np.ndarray) -> Tensor:
        """World points [m], shape (T, V, 3), in the frames' coordinates."""
        return to_tensor((points - self.origin) @ self.axes, self.seeds.device)

    def turned(self, vectors: np.ndarray) -> Tensor:
        """World vectors, shape (T, V, 3), in the frames' axes."""
        return to_tensor(vectors @ self.axes, self.seeds.device)

    def world(self, points: Tensor) -> np.ndarray:
        """The frames' points [m], shape (T, V, 3), in the world, float32."""
        return (points.cpu().numpy() @ np.swapaxes(self.axes, -1, -2) + self.origin).astype(np.float32)


def body_frames(body: np.ndarray, seeds: SeedPoints, rotation: str, axes: str, device: torch.device) -> BodyFrames:
    """From body vertices [m], shape (T, B, 3); `rotation` and `axes` are the options of `Model`."""
    positions, rotations, normals = seed_frames(body, seeds)
    if rotation == "normal":
        rotations = smallest_rotations(seeds.frames[..., 2], normals)
    origin = positions.mean(axis=-2, keepdims=True, dtype=np.float64)
    relative = positions - origin
    turn = frame_axes(relative, seeds.rest, axes)
    local = (relative @ turn, normals @ turn, np.swapaxes(turn, -1, -2)[:, None] @ rotations)
    return BodyFrames(origin, turn, *(to_tensor(x, device) for x in local))


def frame_axes(relative: np.ndarray, rest: np.ndarray, axes: str) -> np.ndarray:
    """The frames' axes, shape (T, 3, 3): "world"; "body": the rotation that brings the canonical seeds, shape (N, 3),
    nearest to the present ones about their mean, shape (T, N, 3) (Kabsch 1976); "heading": its turn about the vertical.
    """
    if axes == "world":
        return np.broadcast_to(np.eye(3), (len(relative), 3, 3))
    canonical = rest - rest.mean(axis=0)
    if axes == "heading":
        flat = relative[..., None, :2] * canonical[:, :2, None]
        angle = np.arctan2((flat[..., 0, 1] - flat[..., 1, 0]).sum(-1), (flat[..., 0, 0] + flat[..., 1, 1]).sum(-1))
        cos, sin, one, zero = np.cos(angle), np.sin(angle), np.ones_like(angle), np.zeros_like(angle)
        return np.stack([cos, -sin, zero, sin, cos, zero, zero, zero, one], axis=-1).reshape(-1, 3, 3)
    u, _, vt = np.linalg.svd(np.swapaxes(relative, -1, -2) @ canonical)
    u[..., -1] *= np.linalg.det(u @ vt)[..., None]
    return u @ vt


def to_tensor(array: np.ndarray, device: torch.device) -> Tensor:
    """A float32 tensor on the device."""
    return torch.from_numpy(np.ascontiguousarray(array, np.float32)).to(device)


def smallest_rotations(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The smallest rotations that carry unit vectors `start`, shape (N, 3), to `end`, shape (..., N, 3)."""
    middle = start + end
    squared = middle[..., :, None] * middle[..., None, :]
    twice = 2 * end[..., :, None] * start[..., None, :]
    return np.eye(3) + twice - squared / (1 + np.sum(start * end, axis=-1))[..., None, None]
