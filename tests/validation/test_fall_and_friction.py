"""Free fall, drag and Coulomb friction against their formulas."""

from dataclasses import replace

import numpy as np
import pytest
from sheets import FPS, HARD, floor, grid, run, tilt

GRAVITY = 9.81
THICKNESS = HARD.thickness


def lying() -> np.ndarray:
    """Where a small sheet lies on the floor, at the contact distance, as if it had come to rest there."""
    sheet = grid(8, 8, 0.2, 0.2)
    return sheet.rest.astype(np.float64) + [0, 0, THICKNESS]


def test_free_fall():
    out = run(grid(6, 6, 0.3, 0.3), 31)
    fallen = out.positions[0, :, 2] - out.positions[30, :, 2]
    dt = 1 / FPS / out.substeps
    assert fallen == pytest.approx(GRAVITY * (1 + dt) / 2, rel=2e-5)  # symplectic Euler: g t (t + dt) / 2
    assert np.abs(out.positions[30, :, :2] - out.positions[0, :, :2]).max() < 1e-6


def test_terminal_velocity():
    out = run(grid(4, 4, 0.2, 0.2), 61, material=replace(HARD, air=5.0))
    speed = FPS * (out.positions[-2, :, 2] - out.positions[-1, :, 2])
    assert speed == pytest.approx(GRAVITY / 5.0, rel=1e-2)


@pytest.mark.parametrize("degrees", [10.0, 20.0])
def test_sheet_sticks_below_the_friction_angle(degrees):
    body = floor()
    slope, start = tilt(body.rest, degrees), tilt(lying(), degrees)
    assert np.tan(np.radians(degrees)) < HARD.friction
    out = run(grid(8, 8, 0.2, 0.2), np.tile(slope, (31, 1, 1)), body=body, start=start)
    assert np.linalg.norm(out.positions[-1] - start, axis=1).max() < 2e-4


@pytest.mark.parametrize("degrees", [25.0, 40.0])
def test_sheet_slides_above_the_friction_angle(degrees):
    body = floor()
    slope, start = tilt(body.rest, degrees), tilt(lying(), degrees)
    angle = np.radians(degrees)
    out = run(grid(8, 8, 0.2, 0.2), np.tile(slope, (31, 1, 1)), body=body, start=start)
    down = np.array([np.cos(angle), 0, -np.sin(angle)])
    expected = 0.5 * GRAVITY * (np.sin(angle) - HARD.friction * np.cos(angle))
    assert (out.positions[-1] - start).mean(axis=0) @ down == pytest.approx(expected, rel=0.02)


def test_floor_that_slides_away_and_stops():
    """Coulomb: cloth at rest on a floor that leaves at speed V ends V^2 / (2 mu g) behind it, if it brakes gently."""
    body, speed, constant, braking = floor(), 1.2, 15, 15
    t = np.arange(constant + braking + 6) / FPS
    brake = speed / (braking / FPS)
    assert brake < HARD.friction * GRAVITY
    late = np.clip(t - constant / FPS, 0, braking / FPS)
    moved = speed * np.minimum(t, constant / FPS) + speed * late - 0.5 * brake * late**2
    frames = body.rest.astype(np.float64) + moved[:, None, None] * np.array([1.0, 0, 0])
    start = lying()
    out = run(grid(8, 8, 0.2, 0.2), frames, body=body, start=start)
    x = (out.positions - start).mean(axis=1)[:, 0]
    assert x[5] == pytest.approx(0.5 * HARD.friction * GRAVITY * (5 / FPS) ** 2, rel=0.02)
    assert x[-1] == pytest.approx(moved[-1] - speed**2 / (2 * HARD.friction * GRAVITY), abs=3e-3)
