"""The fast first layers against the plain 3N-channel convolutions that they replace, in float64."""

import pytest
import torch
import torch.nn.functional as F

from garmentbench.methods.motion_guided.first_layers import ForceConv, RelativeConv

SIZES = [(1, 1, 4, 3), (2, 5, 8, 7), (3, 11, 16, 4)]  # batch, seeds, pixels, channels


def _draw(batch: int, seeds: int, size: int) -> tuple[torch.Tensor, ...]:
    torch.manual_seed(seeds)
    mask = (torch.rand(size, size) < 0.6).double()
    positions = torch.randn(batch, 3, size, size, dtype=torch.double) * mask
    return mask, positions, torch.randn(batch, seeds, 3, dtype=torch.double)


def _same_with_gradients(fast, plain, inputs: list[torch.Tensor]) -> None:
    assert (fast - plain).abs().max() < 1e-12
    direction = torch.randn_like(plain)
    ours = torch.autograd.grad((fast * direction).sum(), inputs)
    theirs = torch.autograd.grad((plain * direction).sum(), inputs)
    for a, b in zip(ours, theirs, strict=True):
        assert (a - b).abs().max() < 1e-12 * max(1.0, b.abs().max().item())


@pytest.mark.parametrize(("batch", "seeds", "size", "channels"), SIZES)
def test_relative_convolution_is_that_of_the_descriptor_map(batch, seeds, size, channels):
    mask, positions, points = _draw(batch, seeds, size)
    layer = RelativeConv(seeds, channels).double()
    inputs = [positions.requires_grad_(), points.requires_grad_(), layer.weight]
    descriptor = (positions[:, None] - points[..., None, None]) * mask  # p_ij = g_i - b_j, 0 outside the chart
    masked = positions * mask
    plain = F.conv2d(descriptor.flatten(1, 2), layer.weight.flatten(1, 2), padding=1)
    _same_with_gradients(layer(masked, mask, points), plain, inputs)


@pytest.mark.parametrize(("batch", "seeds", "size", "channels"), SIZES)
def test_force_convolution_is_that_of_the_force_map(batch, seeds, size, channels):
    mask, _, normals = _draw(batch, seeds, size)
    strength = torch.rand(batch, seeds, size, size, dtype=torch.double) * mask
    layer = ForceConv(seeds, channels).double()
    inputs = [strength.requires_grad_(), normals.requires_grad_(), layer.weight]
    force = strength[:, :, None] * normals[..., None, None]
    plain = F.conv2d(force.flatten(1, 2), layer.weight.flatten(1, 2), padding=1)
    _same_with_gradients(layer(strength, normals), plain, inputs)


def test_centring_on_the_seeds_mean_changes_nothing():
    mask, positions, points = _draw(2, 6, 8)
    layer = RelativeConv(6, 5).double()
    centre = points.mean(dim=1, keepdim=True)
    centred = layer((positions - centre.transpose(1, 2)[..., None]) * mask, mask, points - centre)
    assert (centred - layer(positions, mask, points)).abs().max() < 1e-12
