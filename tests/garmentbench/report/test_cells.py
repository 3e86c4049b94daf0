import math
from dataclasses import replace

import numpy as np
import pytest

from garmentbench.evals.paper_numbers import paper_number
from garmentbench.evaluation.results import BELOW_HALF_SPREAD
from garmentbench.report.cells import best, number, value_cell
from garmentbench.report.lines import Value, confidence_95
from garmentbench.report.table import Cell


def value(mean, interval=None, endings=(), seeds=1, spread=math.nan, settled=True) -> Value:
    return Value(mean, interval, tuple(endings), seeds, math.nan, spread, settled)


@pytest.mark.parametrize(
    "x, text",
    [
        (0.0, "0.00"),
        (0.004, "< 0.01"),
        (1.234, "1.23"),
        (9.996, "10.0"),
        (45.67, "45.7"),
        (99.96, "100"),
        (1150, "1150"),
        (-0.5, "−0.50"),
        (-0.001, "> −0.01"),
    ],
)
def test_numbers_have_about_three_digits(x, text):
    assert number(x) == text


def test_the_confidence_interval_by_hand():
    """Mean of 1, 2, 3: s = 1, t(0.975, 2) = 4.30265, half-width 4.30265 / sqrt(3)."""
    assert confidence_95(np.array([1.0, 2.0, 3.0])) == pytest.approx(2.48414, abs=1e-4)


def test_cells_say_how_seeds_ended():
    assert value_cell(None) == Cell("–")
    assert value_cell(value(0.65, 0.12, seeds=3), bold=True) == Cell("0.65 ± 0.12", bold=True)
    assert value_cell(value(math.nan, endings=["diverged at frame 7"])) == Cell("diverged", bad=True)
    assert value_cell(value(math.nan, endings=["failed at frame 7", "diverged at frame 9"], seeds=2)) == Cell(
        "failed; diverged", bad=True
    )
    assert value_cell(value(0.65, endings=["diverged at frame 7"], seeds=3), bold=True) == Cell(
        "0.65 (1 of 3 diverged)", bad=True
    )
    assert value_cell(value(math.nan, endings=["ok"])) == Cell("–")


def test_a_noted_value_stands_but_does_not_win():
    """N7, N12: below half the spread, or timed under load."""
    noted = replace(value(0.0, spread=0.2), notes=(BELOW_HALF_SPREAD,))
    assert value_cell(noted, bold=True) == Cell("0.00 (below half the spread)", bad=True)
    honest = [value(0.9, spread=0.2), value(0.5, spread=0.2)]
    assert best([noted, *honest], "rollout_l2") is honest[1]


def test_the_best_is_best_by_more_than_the_spread():
    near = [value(0.9, spread=0.2), value(0.75, spread=0.2)]
    far = [value(0.9, spread=0.2), value(0.65, spread=0.2), None]
    assert best(near, "rollout_l2") is None
    assert best(far, "rollout_l2") is far[1]
    unknown = [value(0.9), value(0.1)]
    assert best(unknown, "rollout_l2") is None


def test_nothing_is_best_below_the_spread():
    """What errs by no more than another run of the simulator can't be told from it: a tie."""
    one = [value(0.19, spread=0.2), value(0.9, spread=0.2), value(1.5, spread=0.2)]
    two = [value(0.19, spread=0.2), value(0.05, spread=0.2), value(1.5, spread=0.2)]
    assert best(one, "error") is None and best(two, "error") is None
    above = [value(0.21, spread=0.2), value(0.42, spread=0.2)]
    assert best(above, "error") is above[0]


def test_the_best_has_an_interval_apart_from_all_others():
    overlapping = [value(0.9, 0.2, spread=0.01), value(0.65, 0.1, spread=0.01)]
    apart = [value(0.9, 0.1, spread=0.01), value(0.65, 0.1, spread=0.01), value(2.0, spread=0.01)]
    assert best(overlapping, "rollout_l2") is None and best(apart, "rollout_l2") is apart[1]


def test_beside_a_single_training_nothing_is_best():
    """Another seed or processor has moved errors by 0.1 to 0.3 cm; one training can't say by how much its own."""
    once = [value(0.56, spread=0.01), value(0.76, spread=0.01, settled=False)]
    assert best(once, "rollout_l2") is None


def test_what_failed_does_not_compete():
    values = [
        value(0.1, endings=["diverged at frame 9"], seeds=2, spread=0.2),
        value(0.9, spread=0.2),
        value(3.0, spread=0.2),
    ]
    assert best(values, "rollout_l2") is values[1]


def test_some_metrics_are_better_high_or_near_one():
    high = [value(0.2, spread=0.1), value(0.8, spread=0.1)]
    one = [value(0.7, spread=0.1), value(1.2, spread=0.1), value(2.0, spread=0.1)]
    assert best(high, "skill") is high[1] and best(one, "liveliness") is one[1]


def test_paper_numbers_of_the_main_experiment():
    def of(train_frames, metric, horizon):
        return paper_number("tshirt", "armspace-90", train_frames, metric, horizon).value

    assert [of(300, *m) for m in (("one_step_l2", 1), ("rollout_l2", 50), ("rollout_l2", 1150))] == [0.59, 0.83, 0.82]
    assert [of(n, "rollout_l2", 1150) for n in (50, 150, 900)] == [1.84, 0.84, 0.72]
    assert paper_number("tshirt", "armspace-90", 300, "rollout_l2", 297) is None
