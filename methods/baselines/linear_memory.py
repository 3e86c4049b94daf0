"""A linear map of the pose, and of what the garment was beside it a memory that fades.

    z_t = P f_t + q + keep (z_t-1 - P f_t-1 - q),    z: PCA codes of the garment, f: PCA codes of the body's seed points

with a factor `keep` in (0, 1) for each component of the code, so that it can't run away. All of it is trained on free
roll-outs.
"""

from dataclasses import replace

import torch
from torch import Tensor, nn

from garmentbench.methods.baselines import rollouts
from garmentbench.methods.baselines.rollouts import CodeNet, Config, TrainedDynamics

__all__ = ["Config", "LinearMemory", "config_for"]

_KEPT = 2.0  # what `keep` starts from, before the sigmoid: 0.88


def config_for(size: str) -> Config:
    """The configuration at a network size. What is linear, and starts from nothing, learns in larger steps."""
    config = rollouts.config_for(size)
    return replace(config, training=replace(config.training, learning_rate=1e-2))


class _Net(CodeNet):
    def build(self, width: int, codes: int, inputs: int) -> None:
        self.pose = nn.Linear(inputs, codes)
        nn.init.zeros_(self.pose.weight)
        nn.init.zeros_(self.pose.bias)
        self.kept = nn.Parameter(torch.full((codes,), _KEPT))

    def start(self, last: Tensor, before: Tensor, seen: Tensor) -> Tensor:
        return last - self.posed(seen)

    def forward(self, memory: Tensor, seen: Tensor) -> tuple[Tensor, Tensor]:
        beside = torch.sigmoid(self.kept) * memory
        return self.within(self.posed(seen) + beside), beside

    def posed(self, seen: Tensor) -> Tensor:
        """What the pose alone says, shape (B, K)."""
        return self.mean + self.codes * self.pose(self.near(seen))


class LinearMemory(TrainedDynamics):
    """A linear map of the pose with a fading memory of the garment."""

    name = "linear_memory"
    Net = _Net
