"""Exact values against numbers that books print."""

import math

import numpy as np
import pytest

from garmentbench.evals.validation import exact


def test_numbers_that_books_print():
    assert exact.self_buckling_weight() == pytest.approx(7.8373, abs=1e-4)  # Timoshenko and Gere, Elastic stability
    assert exact.cantilever_root() == pytest.approx(1.8751, abs=1e-4)  # Blevins
    assert exact.chain_frequency(1, exact.GRAVITY) == pytest.approx(1.2024, abs=1e-4)
    assert exact.cantilever_frequency(1.0, 1.0, 1.0) == pytest.approx(3.5160 / (2 * math.pi), rel=1e-4)
    assert exact.euler_load(1.0, 1.0) == pytest.approx(39.478, abs=1e-3)


@pytest.mark.parametrize("weight", [0.01, 0.1])
def test_a_stiff_elastica_is_a_beam(weight):
    """Deflection w L^4 / (8 B)."""
    assert math.radians(exact.elastica_chord(weight)) == pytest.approx(weight / 8, rel=1e-3)


def test_the_cantilever_test_is_made_for_its_angle():
    """Peirce: at 41.5 degrees a strip's bending length is half of what hangs over, w L^3 / B = 8."""
    assert exact.elastica_chord(8.0) == pytest.approx(41.5, abs=0.05)


def test_a_taut_catenary_is_a_parabola():
    """Length over span 1 + 8/3 (sag over span)^2."""
    sag = 0.02
    assert exact.catenary_sag(1 + 8 / 3 * sag**2, 2.0, 1e9) == pytest.approx(sag, rel=2e-3)


def test_shapes_begin_at_the_hold_and_end_at_one():
    assert exact.cantilever_shape(np.array([0.0, 1.0])) == pytest.approx([0.0, 1.0])
    assert exact.chain_shape(2, np.array([0.0, 1.0])) == pytest.approx([1.0, 0.0], abs=1e-12)


def test_a_small_swing_loses_what_the_formula_of_weak_damping_says():
    """Lost part 2/3 drag air a / rho times integral |shape|^3 / integral shape^2, to first order in amplitude a."""
    x = np.linspace(0, 1, 20_001)
    shape = exact.chain_shape(1, x)
    cube, square = np.trapezoid(np.abs(shape) ** 3, x), np.trapezoid(shape**2, x)
    small = 1e-3
    lost = 1 - exact.swing_left(0.2, 1.2, 0.5, small)
    assert lost == pytest.approx(2 / 3 * 1.2 * exact.AIR * small / 0.2 * cube / square, rel=0.02)


def test_friction_and_air_that_balance_weight():
    assert exact.sliding(30.0, 0.6) == 0.0
    assert exact.sliding(30.0, 0.0) == pytest.approx(exact.GRAVITY / 2)
    speed = exact.terminal_speed(0.2, 1.2)
    assert 1.2 * exact.AIR * speed**2 / 2 == pytest.approx(0.2 * exact.GRAVITY)
