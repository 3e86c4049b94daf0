"""A roll-out that ran to its end and is cloth no more is called so, with the frame and the reason."""

import math
from dataclasses import replace

import numpy as np
import pytest

from garmentbench.evaluation.broken import judged
from garmentbench.evaluation.rollout import BROKEN, OK, RollOut
from garmentbench.evaluation.score import predicted, score
from garmentbench.evaluation.toy import tiny_sequence

SEQUENCE = tiny_sequence(20)
FROM = 9


def verdict(change, sequence=SEQUENCE, since=0) -> RollOut:
    """The judgement of the reference, changed from a frame on."""
    garment = sequence.garment.copy()
    garment[since:] = change(garment[since:])
    roll = RollOut("roll_out", 3, garment, None, np.ones((len(sequence), 3)))
    return judged(roll, predicted(roll, sequence))


def about(positions, factor):
    centre = positions.mean(axis=1, keepdims=True)
    return centre + np.float32(factor) * (positions - centre)


def test_the_reference_is_whole_and_so_is_what_is_only_wrong():
    assert verdict(lambda x: x).status == OK
    assert verdict(lambda x: x + np.float32(0.004)).status == OK
    assert verdict(lambda x: about(x, 1.8)).status == OK


def test_stretched_to_more_than_twice():
    found = verdict(lambda x: about(x, 2.4))
    assert (found.status, found.first_bad_frame) == (BROKEN, 3)
    assert "strain" in found.message


def test_inside_the_body():
    found = verdict(lambda x: about(x, 0.6))
    assert (found.status, found.first_bad_frame) == (BROKEN, 3)
    assert "inside the body" in found.message


def test_faster_than_anything_in_the_reference():
    shaken = np.float32(0.1) * (-1.0) ** np.arange(len(SEQUENCE) - FROM)[:, None, None]
    found = verdict(lambda x: x + shaken.astype(np.float32) * np.float32([0, 0, 1]), since=FROM)
    assert (found.status, found.first_bad_frame) == (BROKEN, FROM)
    assert "speed" in found.message


def test_a_reference_that_is_as_wild_excuses_it():
    wild = replace(SEQUENCE, garment=about(SEQUENCE.garment, 1.9))
    assert verdict(lambda x: x, wild).status == OK


def test_its_numbers_stay_and_are_marked():
    sequence = replace(SEQUENCE, runs=None)
    roll = verdict(lambda x: about(x, 2.4), since=FROM)
    rows = score(roll, None, sequence)
    assert {r.status for r in rows} == {BROKEN} and {r.first_bad_frame for r in rows} == {FROM}
    errors = [r.value for r in rows if r.metric in ("rollout_l2", "strain_p95")]
    assert len(errors) >= 2 and np.isfinite(errors).all()


@pytest.mark.parametrize("status", ["diverged", "failed"])
def test_what_ended_before_is_left_as_it_is(status):
    garment = SEQUENCE.garment.copy()
    garment[12:] = np.nan
    roll = RollOut("roll_out", 3, garment, None, np.ones((20, 3)), status, 12, "as it was")
    assert judged(roll, predicted(roll, SEQUENCE)) is roll


def test_what_is_shown_of_it_is_marked_beside_what_else_is_noted():
    from garmentbench.report.cells import value_cell
    from garmentbench.report.lines import Value

    value = Value(1.234, None, ("broken at frame 9",), 1, math.nan, math.nan, True, ("trained on this scene",))
    assert value_cell(value).text == "1.23 (broken; trained on this scene)" and value_cell(value).bad
    three = replace(value, seeds=3, interval=0.5, notes=())
    assert value_cell(three).text == "1.23 ± 0.50 (1 of 3 broken)"
