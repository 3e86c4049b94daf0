"""Polygons are filled once, without overlap, in the orientation that they have."""

import numpy as np
import pytest

from garmentbench.importing.meshes.polygons import triangulate, what_was_cut


def area(positions, triangles):
    """Signed areas about z, shape (F,)."""
    a, b, c = np.moveaxis(positions[triangles], 1, 0)
    return np.cross(b - a, c - a)[:, 2] / 2


def test_mixed_polygons_keep_their_order_and_orientation():
    positions = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]], float)
    cut = triangulate(np.array([3, 4]), np.array([1, 4, 2, 0, 1, 2, 3]), positions)
    assert cut.tolist() == [[0, 1, 2], [3, 4, 5], [3, 5, 6]]
    assert what_was_cut(np.array([3, 4, 4, 7])) == ("2 quads and 1 face of more than 4 corners cut into triangles",)
    assert what_was_cut(np.array([3])) == ()


@pytest.mark.parametrize("shift", range(4))
def test_a_concave_quad_is_cut_along_the_diagonal_that_lies_in_it(shift):
    dart = np.roll(np.array([[0, 0, 0], [2, 0, 0], [0.5, 0.5, 0], [0, 2, 0]], float), shift, axis=0)
    found = area(dart, triangulate(np.array([4]), np.arange(4), dart))
    assert (found > 0).all() and found.sum() == pytest.approx(1.0)


@pytest.mark.parametrize("tilt", [0.0, 0.7, np.pi / 2, 2.5])
def test_ears_of_a_star_fill_it(tilt):
    angle = np.arange(10) * np.pi / 5
    flat = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1) * np.where(np.arange(10) % 2, 0.4, 1.0)[:, None]
    c, s = np.cos(tilt), np.sin(tilt)
    turned = flat @ np.array([[1, 0, 0], [0, c, s], [0, -s, c]])
    cut = triangulate(np.array([10]), np.arange(10), turned)
    found = area(flat, cut)
    shoelace = 10 * 0.5 * 0.4 * np.sin(np.pi / 5)
    assert cut.shape == (8, 3) and (found > 0).all() and found.sum() == pytest.approx(shoelace)


def test_a_polygon_without_area_is_cut_all_the_same():
    assert triangulate(np.array([6]), np.arange(6), np.zeros((6, 3))).shape == (4, 3)


@pytest.mark.parametrize("corners", [2, 101])
def test_odd_polygons_are_refused(corners):
    with pytest.raises(ValueError, match=f"face 1 has {corners} corners"):
        triangulate(np.array([3, corners]), np.zeros(3 + corners, int), np.zeros((1, 3)))
