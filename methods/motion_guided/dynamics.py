"""The dynamic-aware encoder (section 5): C and E^Dyn."""

import torch
from torch import Tensor, nn

from methods.motion_guided.config import Model
from methods.motion_guided.inputs import Inputs
from methods.motion_guided.networks import Encoder, MotionFeatures


class DynamicEncoder(nn.Module):
    """The garment's last state and the body's present one to the present latent code.

    Args:
        options: Sizes.
        seeds: How many seed points push the garment; None where there is nothing to touch, and no such input.
    """

    def __init__(self, options: Model, seeds: int | None) -> None:
        super().__init__()
        self.motion_block = MotionFeatures(seeds, options.width)
        self.encoder = Encoder(2 * options.width, options.map_size, options.width, options.latent)

    def forward(self, inputs: Inputs) -> Tensor:
        """Z_t = E^Dyn(S(M^P_{t-1}), E_t), with E_t = C(M^V_{t-1}, C_t), shape (batch, latent)."""
        change = self.motion_block(inputs.motion, inputs.strength, inputs.normals)
        return self.encoder(torch.cat([inputs.features, change], dim=1))

    def still(self, features: Tensor) -> Tensor:
        """Z^v_{t-1} = E^Dyn(S(M^P_{t-1}), 0): the virtual sample, in which nothing changes."""
        return self.encoder(torch.cat([features, torch.zeros_like(features)], dim=1))
