"""Refinement by the middles of edges: the same surface, the same vertices and more, seams and pins kept."""

import numpy as np
import pytest

from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.geometry.mesh import unique_edges
from garmentbench.geometry.subdivide import subdivided
from garmentbench.geometry.weld import weld
from garmentbench.scenes.garments import load_garment
from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import Garment
from garmentbench.simulation.assembly import assemble

SQUARE = Garment(
    "square",
    np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], np.float32),
    np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32),
    np.zeros((0, 2), np.int32),
    np.array([0, 1], np.int32),
)


def normals(garment: Garment) -> np.ndarray:
    """Area-weighted normals [m^2], shape (F, 3)."""
    a, b, c = garment.rest[garment.faces].transpose(1, 0, 2)
    return np.cross(b - a, c - a) / 2


def test_a_square_by_hand():
    fine = subdivided(SQUARE)
    middles = {tuple(p) for p in fine.rest[4:].tolist()}
    assert middles == {(1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 1, 0), (1, 2, 0)}
    np.testing.assert_array_equal(fine.rest[:4], SQUARE.rest)
    np.testing.assert_array_equal(normals(fine), np.tile([0, 0, 0.5], (8, 1)))
    assert fine.uv[4:].tolist() == (fine.rest[4:, :2] / 2).tolist()
    assert fine.rest[fine.pins].tolist() == [[0, 0, 0], [2, 0, 0], [1, 0, 0]]  # the edge between the two pins


def test_a_seam_stays_closed():
    """A tube cut open along a line: welded, the fine one is as closed as the coarse one."""
    tube = tiny_sequence(1).template.garment
    fine = subdivided(tube)
    particle, count = weld(len(fine.rest), fine.seams)
    edges, faces = len(unique_edges(particle[fine.faces])), len(fine.faces)
    assert len(fine.seams) == 2 * len(tube.seams) - 1
    assert count - edges + faces == 0  # Euler's number of a tube
    np.testing.assert_allclose(fine.rest[fine.seams[:, 0]], fine.rest[fine.seams[:, 1]], atol=1e-7)


def test_a_vertex_of_many_seams():
    """Four squares that meet in a corner, cut along all their sides: one particle there, before and after."""
    corners = [np.array([x, y, 0], np.float32) for y in (-2, 0) for x in (-2, 0)]
    rest = np.concatenate([SQUARE.rest + c for c in corners])
    faces = np.concatenate([SQUARE.faces + 4 * k for k in range(4)])
    same = [(i, j) for i in range(16) for j in range(i) if np.array_equal(rest[i], rest[j])]
    cut = Garment("cut", rest, faces, rest[:, :2], np.array(same, np.int32))
    assert weld(16, cut.seams)[1] == 9
    fine = subdivided(cut)
    assert weld(len(fine.rest), fine.seams)[1] == 25


@pytest.mark.parametrize("name", ["tshirt", "sheet"])
def test_a_garment_keeps_its_area_mass_and_manifold(name):
    coarse = load_garment(name, "smoke")
    fine = subdivided(coarse)
    np.testing.assert_array_equal(fine.rest[: len(coarse.rest)], coarse.rest)
    areas = [np.linalg.norm(normals(g), axis=1).sum() for g in (coarse, fine)]
    assert areas[1] == pytest.approx(areas[0], rel=1e-5)
    masses = [assemble(g, Material(), Settings(mass_floor=0.0)).mass.sum() for g in (coarse, fine)]
    assert masses[1] == pytest.approx(masses[0], rel=1e-4)
    particle, _ = weld(len(fine.rest), fine.seams)
    sides = np.sort(particle[fine.faces][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert np.unique(sides, axis=0, return_counts=True)[1].max() == 2
