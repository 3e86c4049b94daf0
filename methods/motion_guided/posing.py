"""Random poses near those of the recording. Ours, not the paper's.

The whole body is turned a little, and each limb about its joint. The garment is carried along by eq. 1, so its local
displacements, and hence its latent code, stay as they were: the encoders learn to read the code off the garment's place
among the seeds in poses that the recording does not have.
"""

import math

import torch
from torch import Tensor

from garmentbench.methods.motion_guided.config import Posing
from garmentbench.methods.motion_guided.frames import Pose
from garmentbench.methods.motion_guided.limbs import Limbs


class RandomPoses:
    """Draws turns of the whole body and of its limbs, and applies them."""

    def __init__(self, limbs: Limbs, canonical_seeds: Tensor, options: Posing) -> None:
        self.options, self.canonical = options, canonical_seeds
        self.joints, self.shares = (torch.as_tensor(x).to(canonical_seeds) for x in (limbs.joints, limbs.shares))
        self.carriers = torch.as_tensor(limbs.carriers)

    def draw(self, count: int, random: torch.Generator) -> tuple[Tensor, Tensor]:
        """Turns of the whole, shape (count, 3, 3), and rotation vectors of the limbs [rad], shape (count, L, 3)."""
        whole = rotation(self.options.whole_angle * torch.randn(count, 3, generator=random))
        limbs = self.options.limb_angle * torch.randn(count, len(self.joints), 3, generator=random)
        return whole.to(self.canonical), limbs.to(self.canonical)

    def turned(self, pose: Pose, whole: Tensor, limbs: Tensor) -> Pose:
        """Poses, shape (count, ...), turned about the frames' origin and at the joints."""
        seeds, rotations, normals, anchors = pose.seeds, pose.rotations, pose.normals, pose.anchors
        for k, carrier in enumerate(self.carriers.tolist()):
            arm = self.joints[k] - self.canonical[carrier]
            joint = (rotations[:, carrier] @ arm + seeds[:, carrier])[:, None]
            turn = rotation(self.shares[k][:, None] * limbs[:, k, None])
            seeds, anchors = joint + _apply(turn, seeds - joint), joint + _apply(turn, anchors - joint)
            rotations, normals = turn @ rotations, _apply(turn, normals)
        whole = whole[:, None]
        return Pose(_apply(whole, seeds), whole @ rotations, _apply(whole, normals), _apply(whole, anchors))


def _apply(turn: Tensor, vectors: Tensor) -> Tensor:
    return (turn @ vectors[..., None])[..., 0]


def rotation(vector: Tensor) -> Tensor:
    """Rotation matrices, shape (..., 3, 3), of rotation vectors [rad], shape (..., 3) (Rodrigues)."""
    x, y, z = vector.unbind(-1)
    zero = torch.zeros_like(x)
    cross = torch.stack([zero, -z, y, z, zero, -x, -y, x, zero], dim=-1).unflatten(-1, (3, 3))
    turns = (vector.norm(dim=-1) / math.pi)[..., None, None]
    return torch.eye(3).to(vector) + torch.sinc(turns) * cross + 0.5 * torch.sinc(turns / 2) ** 2 * (cross @ cross)
