"""The difference of two simulations against values computed by hand."""

import numpy as np
import pytest

from garmentbench.metrics.difference import difference, difference_p95, distances_cm


def test_differences_by_hand():
    """20 distances of 0, 1, ... 19 cm: the mean is 9.5 cm, the 95th percentile 18.05 cm."""
    first = np.zeros((4, 5, 3), np.float32)
    second = first.copy()
    second[..., 1] = -np.arange(20).reshape(4, 5) / 100
    assert difference(first, second) == pytest.approx(9.5, rel=1e-6)
    assert difference_p95(first, second) == pytest.approx(18.05, rel=1e-6)
    assert distances_cm(first, second).shape == (4, 5)


def test_it_has_no_sides_and_no_place():
    rng = np.random.default_rng(0)
    a, b = rng.standard_normal((2, 3, 4, 3))
    assert difference(a, b) == difference(b, a) == pytest.approx(difference(a + [5, -3, 2], b + [5, -3, 2]))
    assert difference(a, a) == difference_p95(a, a) == 0
