"""The fast part of the validation table: every case passes, as `make validation` judges it."""

import math

import pytest

from garmentbench.evals.validation.case import Case, order
from garmentbench.evals.validation.cases import CASES

QUICK = [case for case in CASES.values() if case.fast]


@pytest.mark.parametrize("case", QUICK, ids=lambda case: case.name)
def test_the_simulator_gives_what_the_textbook_says(case: Case):
    label, size = list(case.sizes.items())[-1]
    value, wanted = case.simulate(size), case.wanted()
    assert case.holds(wanted, value), f"{value} at {label}, wanted {case.band(wanted)}"


def test_an_order_needs_errors_that_fall():
    assert order([4.0, 1.0], [10.0, 20.0], 1.0) == pytest.approx(2.0)
    assert order([9.0, 3.0, -1.0], [9.0, 3.0, 1.0], 1.0) == pytest.approx(1.0)
    assert math.isnan(order([1.0, 1.0], [1.0, 2.0], 1.0)) and math.isnan(order([1.0], [1.0], 1.0))
    assert math.isnan(order([1e-3, 1e-5], [1.0, 2.0], 1.0))
