"""Stretch and bending against the strength of materials."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from sheets import HARD, TO_REST, equilateral, grid, run

GRAVITY = 9.81


def hang(points: np.ndarray) -> np.ndarray:
    """A sheet turned so that its x axis points down."""
    return np.stack([0 * points[:, 0], points[:, 1], -points[:, 0]], axis=1).astype(np.float64)


@pytest.mark.parametrize("stretch", [300.0, 900.0])
def test_strip_hanging_by_its_own_weight(stretch):
    """u(H) = rho g H^2 / (2 E), with E a third of the spring modulus on equilateral triangles."""
    columns, rows, edge = 40, 4, 0.02
    pins = [j * (columns + 1) for j in range(rows + 1)]
    strip = equilateral(columns, rows, edge, pins)
    out = run(strip, 61, replace(HARD, stretch=stretch), start=hang(strip.rest), settings=TO_REST)
    end = [j * (columns + 1) + columns for j in range(rows + 1)]
    stretched = (out.positions[0, end, 2] - out.positions[-1, end, 2]).mean()
    expected = HARD.density * GRAVITY * (columns * edge) ** 2 / (2 * stretch / 3)
    assert stretched == pytest.approx(expected, rel=0.03)


def sag(bending: float) -> float:
    """Sag [m] of a strip of length 0.8 m between two points 0.5 m apart."""
    columns = 40
    strip = grid(columns, 1, 0.8, 0.04, pins=[0, columns, columns + 1, 2 * columns + 1])
    x = strip.rest[:, 0].astype(np.float64)
    start = np.column_stack([x * 0.5 / 0.8, strip.rest[:, 1], -np.minimum(x, 0.8 - x) * np.sqrt(1 - (0.5 / 0.8) ** 2)])
    material = replace(HARD, stretch=5000.0, bending=bending, bend_damping=1e-3)
    return -run(strip, 91, material, start=start, settings=replace(TO_REST, settling=15.0)).positions[-1, :, 2].min()


def test_strip_becomes_a_catenary_as_bending_goes_to_zero():
    a = brentq(lambda a: 2 * a * np.sinh(0.25 / a) - 0.8, 0.05, 1.0)
    catenary = a * np.cosh(0.25 / a) - a
    error = [abs(sag(b) - catenary) / catenary for b in (0.05, 5e-3, 5e-4)]
    assert error[0] > error[1] > error[2]
    assert error[2] < 0.005


def droop(bending: float) -> float:
    """How far the tip of a strip clamped at one end hangs down [m]; free length 0.2 m."""
    columns, rows, edge = 12, 3, 0.02
    pins = [j * (columns + 1) + i for j in range(rows + 1) for i in (0, 1, 2)]
    strip = equilateral(columns, rows, edge, pins)
    tip = [j * (columns + 1) + columns for j in range(rows + 1)]
    out = run(strip, 61, replace(HARD, bending=bending, bend_damping=1e-4), settings=TO_REST)
    return -out.positions[-1, tip, 2].mean()


def test_cantilever_droops_more_the_softer_it_is():
    found = [droop(b) for b in (0.05, 5e-3, 5e-4, 5e-5)]
    assert found[0] < found[1] < found[2] < found[3] < 0.21
    assert found[3] > 0.17  # as good as hanging


def test_stiff_cantilever_against_beam_theory():
    """rho g L^4 / (8 D (1 - nu^2)): the sides are free, and the mesh's flexural Poisson ratio is -1/3."""
    rigidity = 0.05 * (1 - 1 / 9)
    assert droop(0.05) == pytest.approx(HARD.density * GRAVITY * 0.2**4 / (8 * rigidity), rel=0.08)
