"""The headline rule, by hand."""

import math
from dataclasses import replace

import pytest

from garmentbench.evals.difficulty.headline import Demand, headline, verdict

# The skirt of a trial: 1.33 / 1.03 = 1.29 (1.15 is asked), 1.03 / 0.40 = 2.6 (2 is asked), 0.5 * 1.03 = 0.515 >= 0.47.
SKIRT = Demand("skirt-late", "new phrase", 400, static=1.33, dynamic=1.03, floor=0.40, spread=0.47)
WALK = replace(SKIRT, scene="walk", static=1.03)  # the pose alone does it: 1.00
CODES = replace(SKIRT, scene="codes", floor=0.60)  # at the floor: 1.72
CHAOS = replace(SKIRT, scene="chaos", spread=0.60)  # 0.515 < 0.60
SHORT = replace(SKIRT, scene="short", frames=399)
SPIN = replace(SKIRT, scene="spin", what_is_new="new kind")


def test_the_margins_are_the_three_ratios():
    values = list(SKIRT.margins.values())
    assert values == pytest.approx([1.33 / (1.15 * 1.03), 1.03 / 0.80, 0.515 / 0.47])
    assert SKIRT.nearness == pytest.approx(0.515 / 0.47)


def test_bounds_are_met_where_they_are_equal():
    exact = Demand("exact", "new phrase", 400, static=2.3, dynamic=2.0, floor=1.0, spread=1.0)
    assert exact.nearness >= 1 and headline([exact]) == (["exact"], 1)


def test_three_that_qualify_are_the_headline_and_no_other():
    three = [replace(SKIRT, scene=name) for name in "abc"]
    assert headline([WALK, *three, CHAOS, SPIN, SHORT]) == (["a", "b", "c"], 3)
    assert headline([*three, replace(SKIRT, scene="d")]) == (["a", "b", "c", "d"], 4)


def test_of_fewer_the_three_that_come_nearest_are():
    """walk: 1.03 / (1.15 x 1.03) = 0.870; codes: 1.03 / 1.2 = 0.858; chaos: 0.515 / 0.60 = 0.858, a little more."""
    assert WALK.nearness == pytest.approx(0.870, abs=1e-3)
    assert CODES.nearness == pytest.approx(0.8583, abs=1e-3) and CHAOS.nearness == pytest.approx(0.8583, abs=1e-3)
    far = replace(SKIRT, scene="far", spread=5.0)
    found, qualify = headline([far, CODES, WALK, SKIRT, SPIN])
    assert (found, qualify) == (["skirt-late", "walk", "codes"], 1)


def test_what_is_too_short_or_of_a_new_kind_is_never_a_headline():
    assert headline([SHORT, SPIN]) == ([], 0)


def test_verdicts_say_why():
    assert verdict(SKIRT, ["skirt-late"]) == "headline"
    assert verdict(WALK, ["walk"]) == "headline, for want of a better one: the pose alone does it"
    assert verdict(CODES, []) == "at the floor"
    assert verdict(replace(CHAOS, static=1.0), []) == "the pose alone does it, the spread is too large"
    assert verdict(SHORT, []) == "shorter than 400 frames"
    assert verdict(SPIN, []) == "generalisation"


def test_what_is_not_known_does_not_qualify():
    unknown = replace(SKIRT, spread=math.nan)
    assert unknown.nearness == 0 and verdict(unknown, []) == "not known whether the spread is too large"
    assert replace(SKIRT, spread=0.0).nearness >= 1  # a scene that repeats exactly
