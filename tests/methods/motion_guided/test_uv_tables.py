import numpy as np
import pytest
import torch

from garmentbench.geometry.uvmap import Chart
from garmentbench.methods.motion_guided.uv_tables import UVTables, enlargement


@pytest.mark.parametrize("small", [2, 4, 8])
def test_enlargement_is_torchs(small):
    image = torch.randn(1, 1, small, small, dtype=torch.float64)
    large = torch.nn.UpsamplingBilinear2d(scale_factor=2)(image)
    np.testing.assert_allclose(enlargement(small, 2 * small) @ image.ravel().numpy(), large.ravel(), atol=1e-12)


def test_a_small_map_is_sampled_in_its_enlargement():
    random = np.random.default_rng(0)
    pixels, weights = random.integers(0, 64, (5, 4)), random.random((5, 4))
    empty = Chart(4, np.zeros(0, int), np.zeros((0, 3), int), np.zeros((0, 3)))
    tables = UVTables(empty, pixels, weights, np.zeros((5, 3, 3)))
    image = torch.randn(1, 1, 4, 4, dtype=torch.float64)
    large = torch.nn.UpsamplingBilinear2d(scale_factor=2)(image).ravel().numpy()
    expected = (weights * large[pixels]).sum(axis=1)
    np.testing.assert_allclose(tables.sampling(4) @ image.ravel().numpy(), expected, atol=1e-12)
    np.testing.assert_allclose(tables.sampling(8) @ large, expected, atol=1e-12)
    back = UVTables.from_arrays(tables.arrays())
    assert back.chart.size == 4 and np.array_equal(back.pixels, pixels)
    assert UVTables.from_arrays({}) is None
