import pytest
import torch
from torch import nn

from garmentbench.methods.motion_guided.config import config_for
from garmentbench.methods.motion_guided.networks import (
    Decoder,
    DisplacementMLP,
    Encoder,
    GeometryFeatures,
    MotionFeatures,
    encoder_widths,
)


def _millions(*blocks: nn.Module) -> float:
    return sum(p.numel() for block in blocks for p in block.parameters()) / 1e6


def test_paper_sizes_have_the_authors_parameter_counts():
    m = config_for("paper").model
    with torch.device("meta"):
        assert _millions(GeometryFeatures(m.seeds, m.width)) == pytest.approx(9.65, abs=0.005)
        assert _millions(MotionFeatures(m.seeds, m.width)) == pytest.approx(9.96, abs=0.005)
        assert _millions(Encoder(m.width, m.map_size, m.width, m.latent)) == pytest.approx(25.48, abs=0.005)
        assert _millions(Encoder(2 * m.width, m.map_size, m.width, m.latent)) == pytest.approx(25.63, abs=0.01)
        decoder = Decoder(m.map_size, m.width, m.latent)
        assert _millions(decoder, DisplacementMLP(m.width // 2, 32, m.mlp_width)) == pytest.approx(45.08, abs=0.005)


def test_paper_widths():
    assert encoder_widths(128, 128) == [128, 256, 512, 1024, 1024, 1024]


@pytest.mark.parametrize("size", [4, 8, 16, 32])
def test_encoders_and_decoder_fit_every_map_size(size):
    code = Encoder(4, size, 4, 5)(torch.randn(3, 4, size, size))
    assert code.shape == (3, 5)
    assert Decoder(size, 4, 5)(code).shape == (3, 2, 2 * size, 2 * size)


def test_motion_features_without_anything_to_touch_have_no_force_branch():
    block = MotionFeatures(None, 4)
    assert not any("force" in name for name, _ in block.named_parameters())
    assert block(torch.randn(2, 6, 8, 8), None, None).shape == (2, 4, 8, 8)


def test_displacement_mlp_equals_the_plain_concatenation():
    torch.manual_seed(0)
    block = DisplacementMLP(3, 5, 4).double()
    features, uv = torch.randn(2, 7, 3).double(), torch.randn(7, 5).double()
    act = nn.LeakyReLU(0.01)
    encoded = uv
    for layer in block.uv:
        encoded = act(layer(encoded))
    inputs = torch.cat([features, encoded.expand(2, -1, -1)], dim=-1)
    x = act(block.first(inputs))
    for layer in block.residual:
        x = x + act(layer(x))
    plain = block.last[1](act(block.last[0](torch.cat([x, inputs], dim=-1))))
    assert (block(features, uv) - plain).abs().max() < 1e-12
