import numpy as np
import pytest

from garmentbench.geometry.uvmap import bilinear_table, chart

SQUARE = np.array([[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75]])
TWO = np.array([[0, 1, 2], [0, 2, 3]])


def test_a_square_covers_the_pixels_whose_centres_lie_in_it():
    table = chart(SQUARE, TWO, 4)
    assert table.pixels.tolist() == [5, 6, 9, 10]


@pytest.mark.parametrize("size", [7, 16, 33])
@pytest.mark.parametrize("mirror", [False, True])
def test_barycentric_weights_give_back_the_pixel_centre(size, mirror):
    uv = SQUARE * [-1, 1] + [1, 0] if mirror else SQUARE
    table = chart(uv, TWO, size)
    at = np.einsum("pk,pkx->px", table.weights, uv[table.vertices])
    centre = np.stack([table.pixels % size, table.pixels // size], axis=1)
    np.testing.assert_allclose(at, (centre + 0.5) / size, atol=1e-12)
    assert (table.weights >= -1e-9).all() and len(np.unique(table.pixels)) == len(table.pixels)


def test_a_triangle_without_area_covers_nothing():
    assert chart(np.array([[0.1, 0.1], [0.5, 0.5], [0.9, 0.9]]), np.array([[0, 1, 2]]), 8).pixels.size == 0


def test_bilinear_table_reproduces_a_linear_function():
    uv = np.random.default_rng(0).uniform(0.1, 0.9, (50, 2))
    pixels, weights = bilinear_table(uv, 8)
    centres = (np.stack([pixels % 8, pixels // 8], axis=-1) + 0.5) / 8
    np.testing.assert_allclose(np.einsum("vk,vkx->vx", weights, centres), uv, atol=1e-12)


def test_bilinear_table_by_hand_and_at_the_border():
    pixels, weights = bilinear_table(np.array([[0.5, 0.25], [0.0, 1.0]]), 2)
    assert pixels.tolist()[0] == [0, 1, 2, 3]
    np.testing.assert_allclose(weights[0], [0.5, 0.5, 0, 0])
    np.testing.assert_allclose(weights[1] @ (pixels[1] == 2), 1)  # lower left corner in (row 1, column 0)
