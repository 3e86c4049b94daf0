"""The other engine told the same things: fall, floor, what is held, hinges; and advice where it is not installed."""

from dataclasses import replace

import numpy as np
import pytest

from garmentbench.errors import UserError
from garmentbench.evals.crosscheck import vbd
from garmentbench.evals.crosscheck.match_material import equilateral
from garmentbench.evals.crosscheck.model import VbdSettings, hinge_stiffness
from garmentbench.evals.crosscheck.vbd import drive_vbd
from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import OBJECT, Body
from garmentbench.simulation.assembly import assemble
from garmentbench.simulation.obstacle import Obstacle

FPS, GRAVITY = 30.0, 9.81
QUICK = VbdSettings(substeps=10, iterations=2)
SHEET = equilateral(3, 2, 0.02, [])


def drop(
    garment=SHEET, start=None, obstacle=None, frames=8, material=Material(), settings=QUICK, alone=False
) -> np.ndarray:
    """Positions [m], shape (T, V, 3), of a sheet in Newton."""
    pytest.importorskip("newton", reason="the extra crosscheck is not installed")
    start = garment.rest.astype(np.float64) if start is None else start
    ours = Settings(self_contact=not alone)
    return drive_vbd(garment, start, obstacle, frames, FPS, material, ours, settings).positions


def floor(frames: int, speed: float = 0.0) -> Obstacle:
    """A floor at z = 0 that moves along x [m/s], seen as a thin box so that it has an inside."""
    low, high = [-1.0, -1.0, -0.1], [1.0, 1.0, 0.0]
    points = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = np.array([[q[0], q[k], q[k + 1]] for q in quads for k in (1, 2)], np.int32)
    moved = points + speed * np.arange(frames)[:, None, None] / FPS * np.array([1.0, 0, 0])
    return Obstacle.of(Body("floor", points.astype(np.float32), faces, kind=OBJECT), moved, None)


def test_without_newton_it_says_what_to_install(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(UserError, match=r"needs the package newton.*pip install.*crosscheck"):
        vbd.require_newton()


def test_a_hinge_is_as_stiff_as_the_reference_s():
    """Equilateral triangles of edge a: K = D / area of two = 2 D / (sqrt(3) a^2), k = K a. At the border nothing."""
    edge, material = 0.02, Material()
    fabric = assemble(equilateral(4, 3, edge, []), material, Settings())
    x0, x1, x2, x3 = fabric.stencils.T
    newton_s = np.stack([x2, x3, x0, x1], axis=1)
    border = np.array([[-1, x2[0], 0, 1]])
    found = hinge_stiffness(fabric, np.concatenate([newton_s[::-1], border]))
    assert found[:-1] == pytest.approx(np.full(len(newton_s), 2 * material.bending / (np.sqrt(3) * edge)), rel=1e-3)
    assert found[-1] == 0


def test_free_fall():
    """Implicit Euler: g t (t + dt) / 2."""
    fallen = drop(material=replace(Material(), drag=0.0, drag_along=0.0), alone=True)
    t, dt = 7 / FPS, 1 / FPS / QUICK.substeps
    assert (fallen[0] - fallen[7])[:, 2] == pytest.approx(
        np.full(len(SHEET.rest), GRAVITY * t * (t + dt) / 2), rel=1e-3
    )


def test_the_air_slows_it_to_its_terminal_velocity():
    """Level: weight an area = drag x density of air x speed^2 / 2."""
    material = replace(Material(), drag=8.0)
    fallen = drop(frames=16, material=material, settings=VbdSettings(10, 1))
    speed = np.sqrt(2 * material.density * GRAVITY / (8.0 * Settings().air_density))
    assert FPS * (fallen[-2] - fallen[-1])[:, 2] == pytest.approx(np.full(len(SHEET.rest), speed), rel=0.02)


def test_it_rests_on_a_floor_and_is_carried_along():
    thick = Material().thickness
    start = SHEET.rest + np.array([0, 0, thick])
    speed = 0.3
    moved = drop(start=start, obstacle=floor(10, speed), frames=10)
    assert moved[-1, :, 2] == pytest.approx(np.full(len(start), thick), abs=1e-3)
    carried = (moved[-1] - moved[-2]).mean(axis=0)[0] * FPS
    assert carried == pytest.approx(speed, rel=0.1)  # friction 0.4 takes it along within 0.08 s


def test_pins_go_with_what_holds_them():
    strip = equilateral(3, 2, 0.02, [0, 4, 8])
    moved = drop(strip, strip.rest + np.array([0, 0, 0.2]), floor(8, 0.6), frames=8)
    way = moved[:, [0, 4, 8]] - moved[0, [0, 4, 8]]
    np.testing.assert_allclose(way, np.arange(8)[:, None, None] / FPS * [[[0.6, 0, 0]]] * np.ones((1, 3, 1)), atol=1e-5)
