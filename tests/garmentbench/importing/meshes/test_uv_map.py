"""Corner UV become vertex UV: cuts split vertices, tiles are packed, and nothing is made up."""

import numpy as np
import pytest

from garmentbench.errors import UserError
from garmentbench.geometry.unwrap import split_corners
from garmentbench.importing.meshes.mesh_sequence import MeshSequence
from garmentbench.importing.meshes.uv_map import seam_pairs, vertex_uv

# two triangles of a square, cut apart in UV along the diagonal 0-2
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
WHOLE = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], np.float32)
CUT = np.array([[[0, 0], [0.4, 0], [0.4, 0.4]], [[0.5, 0.5], [1, 1], [0.5, 1]]], np.float32)


def mesh(uv, faces=FACES, positions=SQUARE, **more):
    return MeshSequence("square", positions[None], faces, uv, **more)


def test_no_cut_no_split():
    origin, faces, uv = split_corners(FACES, WHOLE)
    assert origin.tolist() == [0, 1, 2, 3]
    np.testing.assert_array_equal(faces, FACES)
    np.testing.assert_array_equal(uv[faces], WHOLE)


def test_a_cut_splits_its_vertices_and_sews_them():
    origin, faces, uv = split_corners(FACES, CUT)
    assert origin.tolist() == [0, 0, 1, 2, 2, 3]
    np.testing.assert_array_equal(origin[faces], FACES)
    np.testing.assert_array_equal(uv[faces], CUT)
    assert seam_pairs(origin, faces, SQUARE[origin], SQUARE[None][:, origin]).tolist() == [[0, 1], [3, 4]]


def test_rounding_noise_is_no_cut():
    noisy = WHOLE.copy()
    noisy[1, 0] += 1e-7
    assert len(split_corners(FACES, noisy)[0]) == 4


def test_vertices_that_never_part_are_sewn_and_others_are_not():
    apart = SQUARE[[0, 1, 2, 0, 2, 3]]  # already split along the diagonal
    faces = np.array([[0, 1, 2], [3, 4, 5]], np.int32)
    frames = np.stack([apart, apart + 1])
    assert seam_pairs(np.arange(6), faces, apart, frames).tolist() == [[0, 3], [2, 4]]
    frames[1, 3] += 0.01  # an opening, not a seam
    assert seam_pairs(np.arange(6), faces, apart, frames).tolist() == [[2, 4]]


def test_many_copies_are_sewn_to_the_first():
    fan = np.array([0, 0, 0])
    faces = np.array([[0, 1, 2]], np.int32)
    assert seam_pairs(fan, faces, np.zeros((3, 3)), np.zeros((1, 3, 3))).tolist() == [[0, 1], [0, 2]]


@pytest.mark.parametrize(("shift", "tiles"), [((0, 0), 1), ((1, 0), 1), ((-3, 2), 1)])
def test_a_map_in_another_tile_is_moved(shift, tiles):
    found = vertex_uv(mesh(WHOLE + np.float32(shift)))
    np.testing.assert_allclose(found.uv[found.faces], WHOLE / tiles, atol=1e-6)
    assert bool(found.notes) == (shift != (0, 0))


def test_udim_tiles_are_packed_into_one():
    uv = WHOLE.copy()
    uv[1] += [2, 1]
    found = vertex_uv(mesh(uv))
    np.testing.assert_allclose(found.uv[found.faces], uv / 3, atol=1e-6)
    assert found.notes[0] == "UV map spanned [0, 3] x [0, 2]: moved and scaled by 1/3 into the unit square"


@pytest.mark.parametrize(
    ("uv", "says"),
    [
        (None, "has no UV map, which the methods need; unwrap the garment and export UV, or give --make-uv"),
        (np.zeros_like(WHOLE), "has a UV map without area"),
        (WHOLE * [1, 0], "has a UV map without area"),
        (WHOLE * np.nan, "has no UV, or none that is finite"),
        (WHOLE * 1e4, "spans 1e+04 tiles"),
        (WHOLE + np.float32(1e7), "has a UV map without area|spans|wanted"),
    ],
)
def test_maps_that_are_none(uv, says):
    with pytest.raises(UserError) as error:
        vertex_uv(mesh(None if uv is None else uv.astype(np.float32)))
    assert "\n" not in str(error.value) and any(part in str(error.value) for part in says.split("|"))


def test_xatlas_makes_one():
    pytest.importorskip("xatlas", reason="xatlas is an extra")
    found = vertex_uv(mesh(None), make_uv=True)
    np.testing.assert_array_equal(found.origin[found.faces], FACES)
    assert found.uv.min() >= 0 and found.uv.max() <= 1 and np.ptp(found.uv, axis=0).min() > 0.1
    assert found.notes == ("UV map made by xatlas: 0 vertices split along its cuts",)
