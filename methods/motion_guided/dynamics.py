"""The dynamic-aware encoder (section 5): C and E^Dyn."""

from collections.abc import Iterable

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from garmentbench.methods.motion_guided.config import Model, Stage2
from garmentbench.methods.motion_guided.inputs import Inputs
from garmentbench.methods.motion_guided.networks import Encoder, MotionFeatures, make_faint


class DynamicEncoder(nn.Module):
    """The garment's last state and the body's present one to the present latent code.

    Args:
        options: Sizes.
        seeds: Seed points.
        given: `force`: without it there is no such branch. `pose_path`: it is solved in closed form and stays as it
            is, hence no parameter.
    """

    path_weight: Tensor
    path_bias: Tensor
    motion_unit: Tensor
    force_unit: Tensor

    def __init__(self, options: Model, seeds: int, given: Stage2) -> None:
        super().__init__()
        self.motion_block = MotionFeatures(seeds if given.force else None, options.width)
        self.encoder = Encoder(2 * options.width, options.map_size, options.width, options.latent)
        self.register_buffer("motion_unit", torch.ones(6, 1, 1))
        self.register_buffer("force_unit", torch.ones(()))
        self.pose_path = given.pose_path
        if given.pose_path:
            self.register_buffer("path_weight", torch.zeros(options.latent, 6 * seeds))
            self.register_buffer("path_bias", torch.zeros(options.latent))
            make_faint(self.encoder.linear)

    def set_units(self, parts: Iterable[Inputs], covered: int) -> None:
        """Take the root mean squares of inputs in the chart's `covered` pixels for units (option `Stage2.units`)."""
        squares, count = torch.zeros(3, dtype=torch.float64), 0
        for part in parts:
            maps = [part.motion[:, :3], part.motion[:, 3:], *([] if part.strength is None else [part.strength])]
            for k, x in enumerate(maps):
                squares[k] += x.square().sum().double().cpu() / x.shape[1]
            count += covered * len(part.motion)
        units = (squares / max(count, 1)).sqrt()
        velocity, acceleration, force = torch.where(units > 0, units, 1.0).tolist()
        self.motion_unit[:3], self.motion_unit[3:] = velocity, acceleration
        self.force_unit.fill_(force)

    def forward(self, inputs: Inputs) -> Tensor:
        """Z_t = E^Dyn(S(M^P_{t-1}), E_t), with E_t = C(M^V_{t-1}, C_t), shape (batch, latent)."""
        strength = None if inputs.strength is None else inputs.strength / self.force_unit
        change = self.motion_block(inputs.motion / self.motion_unit, strength, inputs.normals)
        return self._code(inputs.features, change, inputs.place)

    def still(self, inputs: Inputs) -> Tensor:
        """Z^v_{t-1} = E^Dyn(S(M^P_{t-1}), 0): the virtual sample, in which nothing changes."""
        return self._code(inputs.features, torch.zeros_like(inputs.features), inputs.still_place)

    def _code(self, features: Tensor, change: Tensor, place: Tensor) -> Tensor:
        code = self.encoder(torch.cat([features, change], dim=1))
        return code + F.linear(place, self.path_weight, self.path_bias) if self.pose_path else code
