"""What the networks are given of each frame, as tensors, in the frame's own coordinates.

Their origin is the mean of the seeds. That keeps float32 at its best however far the scene is from the world's origin,
and changes nothing else, since all that the networks see is relative to the body. Their axes are the world's (paper and
code) or turn with the body's heading (ours, option `Model.axes`).
"""

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from garmentbench.geometry.seeds import SeedPoints, seed_frames
from garmentbench.geometry.surface_seeds import SurfaceSeeds, surface_frames


@dataclass(frozen=True)
class Pose:
    """The seeds of some frames.

    Attributes:
        seeds: b_t [m], shape (T, N, 3).
        rotations: R_t from the canonical pose, shape (T, N, 3, 3).
        normals: n_t, shape (T, N, 3).
        anchors: Where eq. 1 takes the seeds to be [m], shape (T, N, 3): b_t; of an upright object where its root alone
            has carried them, while descriptor, force and normals keep to the material points b_t.
    """

    seeds: Tensor
    rotations: Tensor
    normals: Tensor
    anchors: Tensor

    def at(self, chosen: Tensor | slice) -> "Pose":
        """Some of the frames, by index."""
        return Pose(*(x[chosen] for x in vars(self).values()))

    @classmethod
    def joined(cls, parts: list["Pose"]) -> "Pose":
        """The frames of several, one after another."""
        return cls(*(torch.cat(column) for column in zip(*(vars(part).values() for part in parts), strict=True)))


@dataclass(frozen=True)
class BodyFrames:
    """The body in T frames.

    Attributes:
        origin: Mean of the seeds [m], world, shape (T, 1, 3), float64.
        axes: Columns are the frame's axes in the world's, shape (T, 3, 3), float64.
        pose: The seeds in the frame's coordinates.
    """

    origin: np.ndarray
    axes: np.ndarray
    pose: Pose

    def at(self, frames: Tensor) -> "BodyFrames":
        """Some of the frames, by index."""
        return BodyFrames(self.origin[frames.numpy()], self.axes[frames.numpy()], self.pose.at(frames))

    @classmethod
    def joined(cls, parts: list["BodyFrames"]) -> "BodyFrames":
        """The frames of several sequences, one after another."""
        origin, axes = (np.concatenate([getattr(part, name) for part in parts]) for name in ("origin", "axes"))
        return cls(origin, axes, Pose.joined([part.pose for part in parts]))

    def local(self, points: np.ndarray) -> Tensor:
        """World points [m], shape (T, V, 3), in the frames' coordinates."""
        return to_tensor((points - self.origin) @ self.axes, self.pose.seeds.device)

    def world(self, points: Tensor) -> np.ndarray:
        """The frames' points [m], shape (T, V, 3), in the world, float32."""
        turned = points.cpu().numpy().astype(np.float64) @ np.swapaxes(self.axes, -1, -2)
        return (turned + self.origin).astype(np.float32)


@dataclass(frozen=True)
class Link:
    """From the coordinates of frames before to those of frames now: p -> turn p + move.

    Attributes:
        turn: Shape (T, 3, 3).
        move: [m], shape (T, 1, 3).
    """

    turn: Tensor
    move: Tensor

    def __call__(self, points: Tensor) -> Tensor:
        """Points [m], shape (T, V, 3)."""
        return points @ self.turn.transpose(1, 2) + self.move

    def at(self, chosen: Tensor) -> "Link":
        """Some of the frames, by index."""
        return Link(self.turn[chosen], self.move[chosen])


def link(before: BodyFrames, now: BodyFrames) -> Link:
    """How the coordinates of frames `before` lie in those of frames `now`."""
    device = now.pose.seeds.device
    turn = np.swapaxes(now.axes, -1, -2) @ before.axes
    return Link(to_tensor(turn, device), to_tensor((before.origin - now.origin) @ now.axes, device))


def body_frames(
    body: np.ndarray,
    seeds: SeedPoints | SurfaceSeeds,
    rotation: str,
    axes: str,
    device: torch.device,
    upright: bool = False,
) -> BodyFrames:
    """From body vertices [m], shape (T, B, 3).

    Args:
        body: The vertices.
        seeds: The seed points.
        rotation, axes: The options of `Model`.
        device: Of the tensors.
        upright: Eq. 1 takes the body for its upright root (option `Model.upright_objects`).
    """
    turned = surface_frames(body, seeds) if isinstance(seeds, SurfaceSeeds) else seed_frames(body, seeds)
    positions, rotations, normals = turned
    if rotation == "normal":
        rotations = smallest_rotations(seeds.frames[..., 2], normals)
    origin = positions.mean(axis=-2, keepdims=True, dtype=np.float64)
    relative = positions - origin
    root = heading(relative, seeds.rest)
    turn = root if axes == "heading" else np.tile(np.eye(3), (len(body), 1, 1))
    anchors = relative
    if upright:
        rotations = np.repeat(root[:, None], len(seeds.rest), axis=1)
        anchors = (seeds.rest - seeds.rest.mean(axis=0)) @ np.swapaxes(root, -1, -2)
    local = (relative @ turn, np.swapaxes(turn, -1, -2)[:, None] @ rotations, normals @ turn, anchors @ turn)
    return BodyFrames(origin, turn, Pose(*(to_tensor(x, device) for x in local)))


def heading(relative: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """The turns about the vertical, shape (T, 3, 3), that bring the canonical seeds, shape (N, 3), nearest to the
    present ones about their mean, shape (T, N, 3)."""
    canonical = rest - rest.mean(axis=0)
    product = np.einsum("tni,nj->tij", relative, canonical)
    angle = np.arctan2(product[:, 1, 0] - product[:, 0, 1], product[:, 0, 0] + product[:, 1, 1])
    cos, sin, one, zero = np.cos(angle), np.sin(angle), np.ones_like(angle), np.zeros_like(angle)
    return np.stack([cos, -sin, zero, sin, cos, zero, zero, zero, one], axis=-1).reshape(-1, 3, 3)


def to_tensor(array: np.ndarray, device: torch.device) -> Tensor:
    """A float32 tensor on the device."""
    return torch.from_numpy(np.ascontiguousarray(array, np.float32)).to(device)


def smallest_rotations(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The smallest rotations that carry unit vectors `start`, shape (N, 3), to `end`, shape (..., N, 3)."""
    middle = start + end
    squared = middle[..., :, None] * middle[..., None, :]
    twice = 2 * end[..., :, None] * start[..., None, :]
    return np.eye(3) + twice - squared / (1 + np.sum(start * end, axis=-1))[..., None, None]
