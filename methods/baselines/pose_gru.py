"""A small recurrent network on the pose: what it knows of the garment is in its own state, which begins from two codes.

    h_t = GRU(f_t, h_t-1),    z_t = W [h_t, f_t] + w,    z: PCA codes of the garment, f: those of the body's seed points

Recurrent networks on the pose are what Santesteban et al. 2019, "Learning-based animation of clothing for virtual
try-on", and SNUG (2022) predict clothes with.
"""

from dataclasses import replace

import torch
from torch import Tensor, nn

from garmentbench.methods.baselines import rollouts
from garmentbench.methods.baselines.rollouts import CodeNet, Config, TrainedDynamics

__all__ = ["Config", "PoseGru", "config_for"]


def config_for(size: str) -> Config:
    """The configuration at a network size. A state that is only seen through codes takes longer roll-outs."""
    config = rollouts.config_for(size)
    return replace(config, width=min(config.width, 128), unroll=32, training=replace(config.training, batch=32))


class _Net(CodeNet):
    def build(self, width: int, codes: int, inputs: int) -> None:
        self.first = nn.Linear(2 * codes, width)
        self.cell = nn.GRUCell(inputs, width)
        self.out = nn.Linear(width + inputs, codes)

    def start(self, last: Tensor, before: Tensor, seen: Tensor) -> Tensor:
        known = torch.cat([(last - self.mean) / self.codes, (last - before) / self.changes], dim=-1)
        return torch.tanh(self.first(known))

    def forward(self, memory: Tensor, seen: Tensor) -> tuple[Tensor, Tensor]:
        near = self.near(seen)
        memory = self.cell(near, memory)
        return self.within(self.mean + self.codes * self.out(torch.cat([memory, near], dim=-1))), memory


class PoseGru(TrainedDynamics):
    """A recurrent network of the seed points."""

    name = "pose_gru"
    Net = _Net
