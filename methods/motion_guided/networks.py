"""The network blocks S, C, E, D and R (figure 3, section 6.2). Their sizes follow from the map size and one width."""

import itertools
import math
from collections.abc import Sequence
from typing import cast

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn

from garmentbench.methods.motion_guided.first_layers import ForceConv, RelativeConv

SLOPE, MLP_SLOPE = 0.2, 0.01  # of LeakyReLU after convolutions, and after linear layers
FAINT = 0.1
CODE_MAP = 2  # the encoders go down to 2 x 2 pixels


def encoder_widths(map_size: int, width: int) -> list[int]:
    """Channels after each stride-2 layer from `map_size` down to 2 x 2 pixels: doubling, at most 8 x width."""
    return [width * min(2**k, 8) for k in range(int(math.log2(map_size // CODE_MAP)))]


def normalise(x: Tensor) -> Tensor:
    """What follows every convolution: instance norm (no affine, eps 1e-5) and LeakyReLU."""
    # A layer norm over a map is the instance norm of its channel, and three times as fast.
    return F.leaky_relu(F.layer_norm(x, x.shape[-2:], eps=1e-5), SLOPE)


def make_faint(last: nn.Linear) -> None:
    """Begin a network's last layer small and unbiased, beside a linear path that is solved already."""
    last.weight.data.mul_(FAINT)
    last.bias.data.zero_()


class ConvStack(nn.Module):
    """Convolutions, each followed by `normalise`, which makes biases idle: there are none.

    Args:
        widths: Channels before the first layer and after each.
        stride: 1 (kernel 3), 2 (kernel 3, halves the map) or -2 (transposed, kernel 4, doubles the map).
    """

    def __init__(self, widths: Sequence[int], stride: int = 1) -> None:
        super().__init__()
        pairs = itertools.pairwise(widths)
        if stride == -2:
            layers = [nn.ConvTranspose2d(i, o, 4, stride=2, padding=1, bias=False) for i, o in pairs]
        else:
            layers = [nn.Conv2d(i, o, 3, stride=stride, padding=1, bias=False) for i, o in pairs]
        self.layers = nn.ModuleList(layers)

    def forward(self, x: Tensor) -> Tensor:
        for layer in self.layers:
            x = normalise(layer(x))
        return x


class GeometryFeatures(nn.Module):
    """S: the body-relative descriptor map M^P to a feature map S(M^P), shape (batch, width, H, W)."""

    def __init__(self, seeds: int, width: int, chart: bool = False) -> None:
        super().__init__()
        self.first = RelativeConv(seeds, 4 * width, chart)
        self.rest = ConvStack([4 * width, 2 * width, width, width])

    def forward(
        self,
        positions: Float[Tensor, "batch 3 size size"],
        mask: Float[Tensor, "size size"],
        seeds: Float[Tensor, "batch seeds 3"],
    ) -> Float[Tensor, "batch width size size"]:
        return self.rest(normalise(self.first(positions, mask, seeds)))


class MotionFeatures(nn.Module):
    """C: velocity, acceleration and, where there is something to touch, the interaction force, to E_t (section 5)."""

    def __init__(self, seeds: int | None, width: int) -> None:
        super().__init__()
        self.force = None if seeds is None else ForceConv(seeds, 4 * width)
        self.force_rest = None if seeds is None else ConvStack([4 * width, 2 * width, width])
        self.both = ConvStack([6 + (0 if seeds is None else width), width, width, width])

    def forward(
        self,
        motion: Float[Tensor, "batch 6 size size"],
        strength: Float[Tensor, "batch seeds size size"] | None,
        normals: Float[Tensor, "batch seeds 3"] | None,
    ) -> Float[Tensor, "batch width size size"]:
        """E_t, shape (batch, width, H, W).

        Args:
            motion: Velocity and acceleration [m a frame], shape (batch, 6, H, W).
            strength: Interaction-force map, shape (batch, N, H, W).
            normals: Seed normals, shape (batch, N, 3).
        """
        if self.force is None or self.force_rest is None:
            return self.both(motion)
        force = self.force_rest(normalise(self.force(strength, normals)))
        return self.both(torch.cat([force, motion], dim=1))


class Encoder(nn.Module):
    """E^Sta and E^Dyn: a feature map to a latent code, shape (batch, latent)."""

    def __init__(self, in_channels: int, map_size: int, width: int, latent: int) -> None:
        super().__init__()
        widths = encoder_widths(map_size, width)
        self.convs = ConvStack([in_channels, *widths], stride=2)
        self.linear = nn.Linear(widths[-1] * CODE_MAP**2, latent)

    def forward(self, x: Float[Tensor, "batch channels size size"]) -> Float[Tensor, "batch latent"]:
        return self.linear(self.convs(x).flatten(1))


class Decoder(nn.Module):
    """D: a latent code to a feature map of twice the encoder's size, shape (batch, width / 2, 2 H, 2 W)."""

    def __init__(self, map_size: int, width: int, latent: int) -> None:
        super().__init__()
        widths = encoder_widths(map_size, width)[::-1]
        self.linear = nn.Linear(latent, widths[0] * CODE_MAP**2)
        self.convs = ConvStack([*widths, width // 2, width // 2], stride=-2)

    def forward(self, code: Float[Tensor, "batch latent"]) -> Float[Tensor, "batch channels size size"]:
        x = F.leaky_relu(self.linear(code), MLP_SLOPE)
        return self.convs(x.unflatten(1, (-1, CODE_MAP, CODE_MAP)))


class DisplacementMLP(nn.Module):
    """R: a vertex's geometry feature and its UV encoding to its local displacement (section 4.2)."""

    def __init__(self, features: int, uv_channels: int, width: int) -> None:
        super().__init__()
        self.uv = nn.ModuleList(nn.Linear(i, width) for i in (uv_channels, width, width, width))
        self.first = nn.Linear(features + width, width)
        self.residual = nn.ModuleList(nn.Linear(width, width) for _ in range(4))
        self.last = nn.ModuleList([nn.Linear(width + features + width, width), nn.Linear(width, 3)])

    def forward(
        self, features: Float[Tensor, "batch vertices channels"], uv: Float[Tensor, "vertices encoding"]
    ) -> Float[Tensor, "batch vertices 3"]:
        """Displacements, shape (batch, V, 3), of features, shape (batch, V, F), and UV encoding, shape (V, U)."""
        for layer in self.uv:
            uv = F.leaky_relu(layer(uv), MLP_SLOPE)
        x = F.leaky_relu(_of_parts(self.first, features, uv), MLP_SLOPE)
        for layer in self.residual:
            x = x + F.leaky_relu(layer(x), MLP_SLOPE)
        hidden = F.leaky_relu(_of_parts(self.to_hidden, x, features, uv), MLP_SLOPE)
        return self.to_offset(hidden)

    @property
    def to_hidden(self) -> nn.Linear:
        """The last layer but one."""
        return cast(nn.Linear, self.last[0])

    @property
    def to_offset(self) -> nn.Linear:
        """The last layer."""
        return cast(nn.Linear, self.last[1])


def _of_parts(layer: nn.Linear, *parts: Tensor) -> Tensor:
    """layer(cat(parts)), without the copy; a part that has no batch dimension is done once for the whole batch."""
    weights = layer.weight.split([part.shape[-1] for part in parts], dim=1)
    return sum(F.linear(part, weight) for part, weight in zip(parts, weights, strict=True)) + layer.bias
