"""Fitting the other engine's stiffness, and the strips in the reference, against the strength of materials."""

from dataclasses import replace

import pytest

from garmentbench.evals.crosscheck.match_material import CLOSE, cantilever, fitted, hanging, reference_fall
from garmentbench.evals.crosscheck.model import VbdSettings
from garmentbench.scenes.material import Material, Settings

GRAVITY = 9.81
SLOW = replace(Material(), drag=0.0, drag_along=0.0)
TO_REST = Settings(settling=40.0)


@pytest.mark.parametrize("power, true", [(1.0, 1.7), (0.4, 0.6), (0.7, 3.0)])
def test_a_stiffness_is_found_whatever_the_power_of_its_fall(power, true):
    found, ratio = fitted("bending", VbdSettings(), lambda v: (true / v.bending) ** power)
    assert found.bending == pytest.approx(true, rel=1e-6) and ratio == pytest.approx(1)
    assert found.membrane == 1.0


def test_a_fall_that_is_no_power_law_is_matched_all_the_same():
    """A droop d = L k0 / (k + k0) that should be 0.5 L: k = k0."""
    found, ratio = fitted("bending", VbdSettings(), lambda v: 2 * 0.6 / (v.bending + 0.6))
    assert found.bending == pytest.approx(0.6, rel=0.02)
    assert ratio == pytest.approx(2 * 0.6 / (found.bending + 0.6))


def test_a_close_match_is_left_alone():
    calls = []
    fitted("membrane", VbdSettings(), lambda v: calls.append(v) or 1 + CLOSE / 2)
    assert len(calls) == 1


def test_the_hanging_strip_in_the_reference():
    """rho g H^2 / (2 E), E a third of the spring modulus."""
    strip = hanging(0.02)
    expected = SLOW.density * GRAVITY * (strip.columns * strip.edge) ** 2 / (2 * SLOW.stretch / 3)
    assert reference_fall(strip, SLOW, TO_REST) == pytest.approx(expected, rel=0.05)


def test_the_clamped_strip_droops_by_about_half_its_length_whatever_the_cloth():
    for bending in (3e-5, 3e-4):
        cloth = replace(SLOW, bending=bending)
        strip = cantilever(cloth, GRAVITY, 0.01)
        length = (strip.columns - strip.clamped + 1) * strip.edge
        assert 0.3 < reference_fall(strip, cloth, TO_REST) / length < 0.8
