"""Fronts, times at equal error, exponents and verdicts, by hand."""

import math

import pytest

from garmentbench.evals.error_time.pareto import Point, comparable, dominated_by, exponent, front, needed
from garmentbench.evals.error_time.plot import pareto_plot
from garmentbench.evals.error_time.table import headline_table, points_table, verdict


def point(method, ms, error, **further):
    known = {"interval": None, "wall_ms": ms, "p95": ms, "processor_ms": ms, "minutes": math.nan, "spread": 0.5}
    return Point(label=f"{method} {ms:g}", method=method, ms=ms, error=error, **(known | further))


SIMULATED = [point("simulator", 100, 0.4), point("simulator", 10, 1.5), point("simulator", 50, 2.0)]
METHODS = [point("fast", 2, 1.0), point("poor", 20, 3.0), point("best", 5, 0.45), point("bad", 1, 0.1, ending="broken")]


def test_the_front_leaves_out_what_is_dominated_and_what_broke():
    points = SIMULATED + METHODS
    assert [p.label for p in front(points)] == ["fast 2", "best 5"]
    assert [p.label for p in front(SIMULATED)] == ["simulator 10", "simulator 100"]
    # Below the spread (0.5 cm) 0.4 and 0.45 are the same, and 5 ms are less than 100.
    assert dominated_by(SIMULATED[0], points) is METHODS[2]
    assert dominated_by(METHODS[2], points) is None and dominated_by(METHODS[3], points) is None


def test_the_simulators_time_for_an_error():
    """Half way from 1.5 to 0.5 cm (the spread) the logarithm is half way from that of 10 to that of 100 ms."""
    simulated = front(SIMULATED)
    half = needed(1.0, simulated)
    assert half.how == "between" and half.ms == pytest.approx(math.sqrt(1000))
    assert needed(3.0, simulated).how == "cheapest" and needed(3.0, simulated).ms == 10
    assert needed(0.49, simulated).how == "never"


def test_the_table_says_each_case_in_words():
    points = [*SIMULATED, *METHODS, point("great", 7, 0.2, spread=0.1)]
    rows = {row[0].text: [cell.text for cell in row[3:]] for row in headline_table("t", "T", "s", points).rows}
    assert rows["fast 2"] == ["31.6", "15.8"]
    assert rows["poor 20"] == ["at most 10.0: it is already better at its cheapest point", "at most 0.50"]
    assert rows["best 5"] == ["100", "20.0"]
    assert rows["great 7"][0] == "the simulator never gets there within the budget tried"
    assert "bad 1" not in rows
    whole = points_table("t", "T", "s", points, 150, 1)
    assert len(whole.rows) == len(points) and {len(row) for row in whole.rows} == {len(whole.header)}


def test_the_verdict():
    said = verdict(SIMULATED + METHODS)
    assert "2 of 3 method points are faster" in said and "best 5 (20.0 times: 5.00 against 100 ms" in said
    assert "1 are slower" in said and "err less" not in said
    assert "none of 1" in verdict([*SIMULATED, METHODS[1]])
    assert verdict(METHODS).startswith("Too little")


def test_under_load_the_processor_s_clock_counts():
    quiet, loaded = point("fast", 2, 1.0, processor_ms=1.9), point("slow", 90, 0.8, processor_ms=9.0, loaded=True)
    assert [p.ms for p in comparable([quiet])] == [2]
    assert [(p.ms, p.wall_ms) for p in comparable([quiet, loaded])] == [(1.9, 2), (9.0, 90)]
    assert "compared by the processor's time" in points_table("t", "T", "s", comparable([quiet, loaded]), 9, 1).caption


def test_the_exponent_of_a_power():
    assert exponent([400, 1500, 5000], [0.1 * v**1.5 for v in (400, 1500, 5000)]) == pytest.approx(1.5)
    assert math.isnan(exponent([400], [3.0])) and exponent([1, 10], [2, 200]) == pytest.approx(2)


def test_the_plot_is_the_same_every_time():
    points = SIMULATED + METHODS
    assert pareto_plot(points) == pareto_plot(points) and b"<svg" in pareto_plot(points)
