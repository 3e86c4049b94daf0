"""The authors' networks written anew for tests: plain torch on dense 3N-channel maps, with the names their files have.

Written from the description of their blocks; only names and shapes are theirs. Sizes are free, the paper's by default.
"""

from collections import OrderedDict
from itertools import pairwise

import torch
from torch import Tensor, nn


def conv(inputs: int, outputs: int, stride: int = 1) -> nn.Module:
    """`conv.0` is the convolution, then come the norm and the activation, which have no tensors."""
    layers = nn.Sequential(nn.Conv2d(inputs, outputs, 3, stride, 1), nn.InstanceNorm2d(outputs), nn.LeakyReLU(0.2))
    return nn.Sequential(OrderedDict(conv=layers))


def doubling(inputs: int, outputs: int) -> nn.Module:
    layers = nn.Sequential(nn.ConvTranspose2d(inputs, outputs, 4, 2, 1), nn.InstanceNorm2d(outputs), nn.LeakyReLU(0.2))
    return nn.Sequential(OrderedDict(transConv=layers))


def linear(inputs: int, outputs: int) -> nn.Module:
    return nn.Sequential(OrderedDict(FC=nn.Sequential(nn.Linear(inputs, outputs), nn.LeakyReLU(0.01))))


def chain(make, widths: list[int], *more) -> nn.Sequential:
    return nn.Sequential(*(make(i, o, *more) for i, o in pairwise(widths)))


def halved(size: int, width: int) -> list[int]:
    """128, 256, 512, 1024, 1024, 1024 for a map of 128 pixels."""
    widths, size = [width], size // 2
    while size > 2:
        widths, size = [*widths, min(2 * widths[-1], 8 * width)], size // 2
    return widths


class Relative(nn.Module):
    """S."""

    def __init__(self, seeds: int, width: int = 128) -> None:
        super().__init__()
        self.encoder_1 = chain(conv, [3 * seeds, 4 * width, 2 * width, width, width])

    def forward(self, relative_map: Tensor) -> Tensor:
        return self.encoder_1(relative_map)


class Encoder(nn.Module):
    """E^Sta and E^Dyn."""

    def __init__(self, inputs: int, size: int = 128, width: int = 128, latent: int = 64) -> None:
        super().__init__()
        widths = halved(size, width)
        self.encoder_1 = chain(conv, [inputs, *widths], 2)
        self.in_ZLinear = nn.Linear(4 * widths[-1], latent)

    def forward(self, x: Tensor) -> Tensor:
        return self.in_ZLinear(self.encoder_1(x).flatten(1))


class Residual(nn.Module):
    def __init__(self, width: int) -> None:
        super().__init__()
        self.MLP = linear(width, width)

    def forward(self, x: Tensor) -> Tensor:
        return x + self.MLP(x)


class Pointwise(nn.Module):
    def __init__(self, inputs: int, width: int) -> None:
        super().__init__()
        self.MLP_B = nn.Sequential(linear(inputs, width), *(Residual(width) for _ in range(4)))
        self.LinearGeo = nn.Sequential(linear(width + inputs, width), nn.Linear(width, 3))

    def forward(self, x: Tensor) -> Tensor:
        return self.LinearGeo(torch.cat([self.MLP_B(x), x], dim=-1))


class Decoder(nn.Module):
    """D and R: codes, four pixels (x, y) and weights a vertex, and its encoded UV, to displacements."""

    def __init__(self, size: int = 128, width: int = 128, latent: int = 64, mlp: int = 64) -> None:
        super().__init__()
        widths = halved(size, width)[::-1]
        self.out_ZLinear = linear(latent, 4 * widths[0])
        self.decoder = nn.Module()
        self.decoder.decoder1 = chain(doubling, [*widths, width // 2, width // 2])
        self.uvencoder = chain(linear, [32, mlp, mlp, mlp, mlp])
        self.MLP_pred = Pointwise(width // 2 + mlp, mlp)

    def forward(self, code: Tensor, pixels: Tensor, weights: Tensor, uv: Tensor) -> Tensor:
        features = self.decoder.decoder1(self.out_ZLinear(code).reshape(len(code), -1, 2, 2))
        corners = features[:, :, pixels[..., 1], pixels[..., 0]]  # (batch, channels, V, 4)
        sampled = (corners * weights).sum(-1).transpose(1, 2)
        return self.MLP_pred(torch.cat([sampled, self.uvencoder(uv).expand(len(code), -1, -1)], dim=-1))


class Change(nn.Module):
    """C."""

    def __init__(self, seeds: int, width: int = 128) -> None:
        super().__init__()
        self.encoder_1 = chain(conv, [3 * seeds, 4 * width, 2 * width, width])
        self.encoder_2 = chain(conv, [width + 6, width, width, width])

    def forward(self, force: Tensor, motion: Tensor) -> Tensor:
        return self.encoder_2(torch.cat([self.encoder_1(force), motion], dim=1))


class Implicit(nn.Module):
    """SDF_0: eight layers of 512, the point again at the fifth."""

    def __init__(self) -> None:
        super().__init__()
        widths = [3, 512, 512, 512, 512, 512, 512, 512, 512]
        for k, inputs in enumerate(widths):
            outputs = {3: 512 - 3, 8: 1}.get(k, 512)
            setattr(self, f"lin_{k}", nn.Linear(inputs, outputs))

    def forward(self, point: Tensor) -> Tensor:
        x = point
        for k in range(9):
            x = torch.cat([x, point], dim=-1) / 2**0.5 if k == 4 else x
            x = getattr(self, f"lin_{k}")(x)
            x = nn.functional.softplus(x, beta=100) if k < 8 else x
        return x[..., 0]


def encoded_uv(uv: Tensor) -> Tensor:
    """sin u, sin v, cos u, cos v of (u, v) * 256 by pi / 2, pi / 4 ..., shape (V, 32)."""
    waves = []
    for k in range(8):
        scaled = torch.pi / 2.0 ** (k + 1) * (256 * uv)
        waves += [torch.sin(scaled), torch.cos(scaled)]
    return torch.cat(waves, dim=1)


def posed(canonical: Tensor, seeds0: Tensor, radius: Tensor, rotations: Tensor, translations: Tensor) -> Tensor:
    """Blended rigid motions of one frame's canonical vertices, by softmax of -d^2 / (2 rho^2): (V, 3)."""
    distance = (canonical[:, None] - seeds0).norm(dim=-1)
    weights = torch.softmax(-(distance**2) / (2 * radius**2), dim=-1)
    carried = torch.einsum("nxy,vny->vnx", rotations, canonical[:, None] - seeds0) + seeds0 + translations
    return torch.einsum("vn,vnx->vx", weights, carried)


def map_of(values: Tensor, size: int, xy: Tensor, corners: Tensor, weights: Tensor) -> Tensor:
    """Values at vertices (V, C) in the pixels of a map, 0 elsewhere: (C, S, S)."""
    image = torch.zeros(values.shape[1], size, size, dtype=values.dtype)
    image[:, xy[:, 1], xy[:, 0]] = (values[corners] * weights[..., None]).sum(1).T
    return image


def relative(garment: Tensor, seeds: Tensor) -> Tensor:
    """g - b_j, seed by seed: (V, 3 N)."""
    return (garment[:, None] - seeds).flatten(1)


def force(garment: Tensor, seeds: Tensor, normals: Tensor, seeds_before: Tensor) -> Tensor:
    """The interaction force, fading with the distance to where the seeds were: (V, 3 N)."""
    depth = torch.relu(-((garment[:, None] - seeds) * normals).sum(-1))
    fade = torch.exp(-(garment[:, None] - seeds_before).square().sum(-1) / (2 * 0.04**2))
    return ((fade * depth)[..., None] * normals).flatten(1)
