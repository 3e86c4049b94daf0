"""The dynamic-aware encoder (section 5): C and E^Dyn."""

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from garmentbench.methods.motion_guided.config import Model
from garmentbench.methods.motion_guided.inputs import Inputs
from garmentbench.methods.motion_guided.networks import Encoder, MotionFeatures, make_faint


class DynamicEncoder(nn.Module):
    """The garment's last state and the body's present one to the present latent code.

    Args:
        options: Sizes.
        seeds: Seed points.
        touches: They push the garment; where there is nothing to touch there is no such input.
        pose_path: The option of `Stage2`. The path is solved in closed form and stays as it is, hence no parameter.
    """

    path_weight: Tensor
    path_bias: Tensor

    def __init__(self, options: Model, seeds: int, touches: bool, pose_path: bool) -> None:
        super().__init__()
        self.motion_block = MotionFeatures(seeds if touches else None, options.width)
        self.encoder = Encoder(2 * options.width, options.map_size, options.width, options.latent)
        self.pose_path = pose_path
        if pose_path:
            self.register_buffer("path_weight", torch.zeros(options.latent, 6 * seeds))
            self.register_buffer("path_bias", torch.zeros(options.latent))
            make_faint(self.encoder.linear)

    def forward(self, inputs: Inputs) -> Tensor:
        """Z_t = E^Dyn(S(M^P_{t-1}), E_t), with E_t = C(M^V_{t-1}, C_t), shape (batch, latent)."""
        change = self.motion_block(inputs.motion, inputs.strength, inputs.normals)
        return self._code(inputs.features, change, inputs.place)

    def still(self, inputs: Inputs) -> Tensor:
        """Z^v_{t-1} = E^Dyn(S(M^P_{t-1}), 0): the virtual sample, in which nothing changes."""
        return self._code(inputs.features, torch.zeros_like(inputs.features), inputs.still_place)

    def _code(self, features: Tensor, change: Tensor, place: Tensor) -> Tensor:
        code = self.encoder(torch.cat([features, change], dim=1))
        return code + F.linear(place, self.path_weight, self.path_bias) if self.pose_path else code
