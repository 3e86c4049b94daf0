"""Free fall, drag along the cloth and friction that changes. More of the kind is in `evals/validation`."""

from dataclasses import replace

import numpy as np
import pytest
from sheets import FPS, HARD, floor, grid, run

from garmentbench.scenes.material import Settings

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


def test_a_sheet_that_falls_edge_on_is_hardly_held():
    upright = grid(4, 4, 0.2, 0.2).rest[:, [0, 2, 1]].astype(np.float64)
    fallen = [
        (out := run(grid(4, 4, 0.2, 0.2), 31, replace(HARD, drag=1.2, drag_along=a), start=upright)).positions[0, 0, 2]
        - out.positions[-1, 0, 2]
        for a in (0.0, 0.02)
    ]
    assert fallen[0] == pytest.approx(GRAVITY / 2, rel=3e-3)
    # dv/dt = g - k v^2, k = drag_along x density of air / (2 density): x = ln(cosh(t sqrt(g k))) / k
    k = 0.02 * Settings().air_density / (2 * HARD.density)
    assert fallen[1] == pytest.approx(np.log(np.cosh(np.sqrt(GRAVITY * k))) / k, rel=3e-3)


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
