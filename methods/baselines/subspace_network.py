"""A small network in the subspace, trained on roll-outs: `linear_subspace` with a network in place of its linear map.

    z_t = z_t-1 + net(z_t-1, z_t-2, f_t),    z: PCA codes of the garment, f: PCA codes of the body's seed points

in the manner of Holden et al. 2019, "Subspace Neural Physics".
"""

from itertools import pairwise

import torch
from torch import Tensor, nn

from garmentbench.methods.baselines.rollouts import CodeNet, Config, TrainedDynamics, config_for

__all__ = ["Config", "SubspaceNetwork", "config_for"]

Memory = tuple[Tensor, Tensor]  # the last code and the one before it


class _Net(CodeNet):
    def build(self, width: int, codes: int, inputs: int) -> None:
        sizes = (2 * codes + inputs, width, width)
        hidden = [part for a, b in pairwise(sizes) for part in (nn.Linear(a, b), nn.ELU())]
        self.layers = nn.Sequential(*hidden, nn.Linear(width, codes))

    def start(self, last: Tensor, before: Tensor, seen: Tensor) -> Memory:
        return last, before

    def forward(self, memory: Memory, seen: Tensor) -> tuple[Tensor, Memory]:
        last, before = memory
        known = torch.cat([(last - self.mean) / self.codes, (last - before) / self.changes, self.near(seen)], dim=-1)
        code = self.within(last + self.changes * self.layers(known))
        return code, (code, last)


class SubspaceNetwork(TrainedDynamics):
    """A network of PCA codes, their predecessors and the seed points."""

    name = "subspace_network"
    Net = _Net
