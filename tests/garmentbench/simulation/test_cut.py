"""Cloth cut otherwise than it is put on comes to the lengths of its flat pattern, in the solver and in the metric."""

from dataclasses import replace

import numpy as np
import pytest

from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.geometry.cloth_rest import cloth_at_rest, rest_areas, rest_lengths
from garmentbench.geometry.subdivide import subdivided
from garmentbench.metrics.strain import strain_p95
from garmentbench.scenes.garments import load_garment
from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import Garment
from garmentbench.sequence_file.read_write import load, save
from garmentbench.simulation.assembly import assemble
from garmentbench.simulation.drive import drive

WEIGHTLESS = Settings(gravity=0.0)
CUT_FIELDS = ("mass", "length", "stiffness", "curvature", "bend_stiffness")


def square(wider: float, side: int = 6, edge: float = 0.03) -> Garment:
    """A flat square of cloth, cut `wider` times as wide as it is put on."""
    y, x = np.mgrid[0:side, 0:side] * edge
    rest = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1).astype(np.float32)
    number = np.arange(side * side).reshape(side, side)
    a, b, c, d = (n.ravel() for n in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]))
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)
    cut = (rest[:, :2] * [wider, 1]).astype(np.float32)
    return Garment("square", rest, faces, rest[:, :2] / rest[:, :2].max(), np.zeros((0, 2), np.int32), cut=cut)


def two_panels(second: float) -> Garment:
    """Two triangles sewn along a side of 10 cm, which the second panel's pattern has `second` times as long."""
    rest = np.array([[0, 0, 0], [0.1, 0, 0], [0.05, 0.08, 0], [0, 0, 0], [0.1, 0, 0], [0.05, -0.08, 0]], np.float32)
    faces = np.array([[0, 1, 2], [4, 3, 5]], np.int32)
    cut = rest[:, :2].copy()
    cut[3:] *= np.float32(second)
    cut[3:, 0] += 1  # panels lie apart
    return Garment("panels", rest, faces, rest[:, :2] + 0.2, np.array([[0, 3], [1, 4]], np.int32), cut=cut)


def test_a_square_cut_wider_comes_to_that_length_without_load():
    garment = square(1.08)
    still = replace(Material(), bending=1e-3)  # so stiff to bending that it stays flat
    run = drive(garment, garment.rest, None, 90, 30.0, still, replace(WEIGHTLESS, settling=20.0))
    start, right, above = run.positions[-1, [0, 5, 30]]
    sides = np.linalg.norm(right - start), np.linalg.norm(above - start)
    assert sides == pytest.approx((1.08 * 0.15, 0.15), rel=1e-3)
    assert run.strain[1, 0] > 0.005 and run.strain[-1, 1] < 1e-4


def test_the_metric_measures_against_the_solvers_lengths():
    garment = square(1.08)
    laid = cloth_at_rest(garment)
    assert strain_p95(laid[None], *rest_lengths(garment)) == pytest.approx(0, abs=1e-4)
    fabric, (edges, lengths) = assemble(garment, Material(), Settings()), rest_lengths(garment)
    np.testing.assert_array_equal(fabric.edges, edges)
    np.testing.assert_array_equal(fabric.length, lengths)
    assert fabric.mass.sum() == pytest.approx(Material().density * 1.08 * 0.15**2, rel=1e-5)


def test_the_two_sides_of_a_seam_are_sewn_to_their_mean_length():
    garment = two_panels(1.1)
    edges, lengths = rest_lengths(garment)
    sewn = {tuple(edge): length for edge, length in zip(edges.tolist(), lengths, strict=True)}
    assert sewn[0, 1] == sewn[3, 4] == pytest.approx(0.105)
    assert sewn[3, 5] == pytest.approx(1.1 * sewn[0, 2], rel=1e-5)
    np.testing.assert_allclose(rest_areas(garment), [0.004, 1.21 * 0.004], rtol=1e-5)
    fabric = assemble(garment, Material(), Settings(mass_floor=0.0))
    assert len(fabric.edges) == 5 and fabric.length[0] == pytest.approx(0.105)
    assert fabric.mass.sum() == pytest.approx(Material().density * 2.21 * 0.004, rel=1e-5)


def test_bending_across_a_seam_takes_each_panels_own_angles():
    """Angles don't change with the scale of one panel, so nor do the coefficients."""
    plain, scaled = (assemble(two_panels(s), Material(), Settings()) for s in (1.0, 1.1))
    np.testing.assert_allclose(scaled.curvature, plain.curvature, rtol=1e-5)
    assert (scaled.bend_stiffness < plain.bend_stiffness).all()  # the area is larger


@pytest.mark.parametrize("name", ["tshirt", "pleated_skirt", "sheet"])
def test_without_a_cut_the_shape_as_put_on_decides(name):
    """And a flat garment whose cut is that shape is the same fabric."""
    garment = replace(load_garment(name, "smoke"), cut=None)
    fabric = assemble(garment, Material(), Settings())
    a, b = fabric.rest[fabric.edges].transpose(1, 0, 2)
    np.testing.assert_allclose(fabric.length, np.linalg.norm(a - b, axis=1), rtol=1e-6)
    np.testing.assert_array_equal(fabric.corners, garment.rest[garment.faces])
    flat = square(1.0)
    with_cut, without = (assemble(g, Material(), Settings()) for g in (flat, replace(flat, cut=None)))
    for field in CUT_FIELDS:
        np.testing.assert_allclose(getattr(with_cut, field), getattr(without, field), rtol=1e-5)


def test_the_cut_is_kept_in_files_and_by_subdivision(tmp_path):
    sequence = tiny_sequence(3)
    garment = sequence.template.garment
    cut = np.column_stack([garment.uv[:, 0], garment.uv[:, 1]]).astype(np.float32)
    cut *= np.ptp(garment.rest[:, 2]) / np.ptp(cut, axis=0)
    template = replace(sequence.template, garment=replace(garment, cut=cut))
    save(replace(sequence, template=template), tmp_path / "a.h5")
    np.testing.assert_array_equal(load(tmp_path / "a.h5").template.garment.cut, cut)
    fine = subdivided(template.garment)
    assert fine.cut.dtype == np.float32
    assert rest_areas(fine).sum() == pytest.approx(rest_areas(template.garment).sum(), rel=1e-5)
