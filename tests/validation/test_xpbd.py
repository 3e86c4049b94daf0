"""XPBD, the budgeted simulator: the same physics where it converges, and whole at any budget."""

from dataclasses import replace

import numpy as np
import pytest
from sheets import HARD, TO_REST, equilateral, floor, grid, run, tilt

GRAVITY = 9.81


def test_free_fall():
    out = run(grid(6, 6, 0.3, 0.3), 31, budget=40)
    fallen = out.positions[0, :, 2] - out.positions[30, :, 2]
    assert fallen == pytest.approx(GRAVITY / 2, rel=3e-3)  # velocities are differences of float32 positions


@pytest.mark.parametrize("degrees, slides", [(15.0, False), (35.0, True)])
def test_coulomb_on_a_slope(degrees, slides):
    body, sheet, angle = floor(), grid(8, 8, 0.2, 0.2), np.radians(degrees)
    start = tilt(sheet.rest + np.float32([0, 0, HARD.thickness]), degrees)
    out = run(sheet, np.tile(tilt(body.rest, degrees), (31, 1, 1)), body=body, start=start, budget=40)
    way = (out.positions[-1] - start).mean(axis=0) @ [np.cos(angle), 0, -np.sin(angle)]
    expected = 0.5 * GRAVITY * (np.sin(angle) - HARD.friction * np.cos(angle)) if slides else 0.0
    assert way == pytest.approx(expected, rel=0.03, abs=1e-3)


def test_strip_sags_more_the_smaller_the_budget_and_right_with_a_large_one():
    columns, rows, edge = 20, 2, 0.02
    strip = equilateral(columns, rows, edge, [j * (columns + 1) for j in range(rows + 1)])
    start = np.stack([0 * strip.rest[:, 0], strip.rest[:, 1], -strip.rest[:, 0]], axis=1)
    end = [j * (columns + 1) + columns for j in range(rows + 1)]

    def sag(budget: int) -> float:
        out = run(strip, 46, start=start, settings=TO_REST, budget=budget)
        return (out.positions[0, end, 2] - out.positions[-1, end, 2]).mean()

    expected = HARD.density * GRAVITY * (columns * edge) ** 2 / (2 * HARD.stretch / 3)
    assert sag(10) > 2 * expected
    assert sag(400) == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("budget", [1, 5, 20])
def test_stays_whole_at_any_budget(budget):
    body = floor()
    out = run(
        grid(8, 8, 0.2, 0.2),
        np.tile(body.rest, (40, 1, 1)),
        body=body,
        start=grid(8, 8, 0.2, 0.2).rest + np.float32([0, 0, 0.1]),
        budget=budget,
    )
    assert np.isfinite(out.positions).all()
    assert out.positions[-1, :, 2] == pytest.approx(HARD.thickness, abs=2e-3)


def test_cloth_that_is_crossed_is_led_out_and_not_shot_away():
    """The gap of a contact that leads out is a speed; taken for a distance it threw the cloth half a metre a step."""
    below = grid(8, 8, 0.2, 0.2)
    standing = np.stack([below.rest[:, 0], below.rest[:, 2], below.rest[:, 1] - 0.103], axis=1) + np.float32(
        [0, 0.11, 0]
    )
    rest = np.concatenate([below.rest, standing + np.float32([0, 0, 1])])  # far apart at rest, crossed where it starts
    both = replace(
        below,
        rest=rest,
        faces=np.concatenate([below.faces, below.faces + len(below.rest)]),
        uv=np.concatenate([below.uv, below.uv]),
        pins=np.arange(len(below.rest), dtype=np.int32),
    )
    start = np.concatenate([below.rest, standing])
    out = run(both, 31, start=start, budget=10)
    assert out.strain[:, 1].max() < 2  # 36 otherwise
