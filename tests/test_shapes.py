"""Arrays of a wrong shape are found by the annotations, in every package whose shapes are checked."""

import importlib

import numpy as np
import pytest
from jaxtyping import TypeCheckError
from shape_checks import CHECKED, checked_modules

from garmentbench.geometry.mesh import edge_lengths, vertex_normals
from garmentbench.sequence import Garment

TRIANGLE = np.array([[0, 1, 2]], np.int32)
CORNERS = np.eye(3, dtype=np.float32)


def test_right_shapes_pass_whatever_comes_before_them():
    assert vertex_normals(CORNERS, TRIANGLE).shape == (3, 3)
    assert vertex_normals(np.stack([CORNERS, CORNERS]), TRIANGLE).shape == (2, 3, 3)


@pytest.mark.parametrize(
    "positions, faces",
    [
        (CORNERS[:, :2], TRIANGLE),  # two coordinates
        (CORNERS, TRIANGLE.ravel()),  # no rows
        (CORNERS, TRIANGLE.astype(np.float32)),  # indices that are no whole numbers
    ],
)
def test_a_wrong_shape_or_kind_is_found(positions, faces):
    with pytest.raises(TypeCheckError):
        vertex_normals(positions, faces)


def test_sizes_that_must_agree_are_compared():
    with pytest.raises(TypeCheckError, match="uv"):
        Garment("g", CORNERS, TRIANGLE, np.zeros((4, 2), np.float32), np.zeros((0, 2), np.int32))
    with pytest.raises(TypeCheckError):
        edge_lengths(CORNERS, np.zeros((4, 3), np.int32))


def test_every_package_that_is_named_has_shapes():
    """A name in `CHECKED` that nothing stands behind, or whose modules state no shape, checks nothing."""
    modules = checked_modules()
    for place in CHECKED:
        name = f"garmentbench.{place.removesuffix('.py').replace('/', '.')}"
        own = [m for m in modules if m == name or m.startswith(f"{name}.")]
        assert any(hasattr(importlib.import_module(m), kind) for m in own for kind in ("Float", "Int", "Bool")), place
