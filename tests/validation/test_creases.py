"""Creases keep their angle, and damping of bending takes what it should."""

from dataclasses import replace

import numpy as np
import pytest
import warp as wp
from sheets import HARD, grid, run

from garmentbench.scenes.material import Settings
from garmentbench.sequence import Garment
from garmentbench.simulation.assembly import assemble
from garmentbench.simulation.cloth import Solver
from garmentbench.simulation.hinge import hinge_angle, hinge_gradient
from garmentbench.simulation.time_step import damping_stages

FREE = Settings(gravity=0.0, self_contact=False)


def zigzag(folds: int, edge: float, angle: float, rows: int = 4) -> Garment:
    """A strip along x, folded to and fro by `angle` [degrees] out of the plane at every column."""
    flat, half = grid(folds, rows, folds * edge, rows * edge), np.radians(angle / 2)
    rest = flat.rest.copy()
    column = np.rint(rest[:, 0] / edge).astype(int)
    rest[:, 0], rest[:, 2] = column * edge * np.cos(half), (column % 2) * edge * np.sin(half)
    return replace(flat, rest=rest)


@wp.kernel
def _angle(x: wp.array[wp.vec3], angle: wp.array[float], gradient: wp.array[wp.vec3]):
    angle[0] = hinge_angle(x[0], x[1], x[2], x[3])
    g = hinge_gradient(x[0], x[1], x[2], x[3])
    gradient[0] = g.a
    gradient[1] = g.b
    gradient[2] = g.c
    gradient[3] = g.d


def angle_and_gradient(x: np.ndarray) -> tuple[float, np.ndarray]:
    angle, gradient = wp.zeros(1, dtype=float, device="cpu"), wp.zeros(4, dtype=wp.vec3, device="cpu")
    points = wp.array(x.astype(np.float32), dtype=wp.vec3, device="cpu")
    wp.launch(_angle, 1, [points, angle, gradient], device="cpu")
    return float(angle.numpy()[0]), gradient.numpy().astype(np.float64)


@pytest.mark.parametrize("degrees", [-120.0, -30.0, 0.0, 45.0, 150.0])
def test_the_angle_of_a_hinge_and_its_gradient(degrees):
    """Against the angle that it was made with, and central differences; no force and no moment on the whole."""
    t = np.radians(degrees)
    x = np.array([[0, 0, 0], [1, 0, 0], [0.3, 0.8, 0], [0.6, -0.7 * np.cos(t), -0.7 * np.sin(t)]])
    angle, gradient = angle_and_gradient(x)
    assert angle == pytest.approx(t, abs=1e-5)
    step = 1e-2
    for i in range(4):
        for k in range(3):
            move = np.zeros((4, 3))
            move[i, k] = step
            there, back = angle_and_gradient(x + move)[0], angle_and_gradient(x - move)[0]
            assert gradient[i, k] == pytest.approx((there - back) / (2 * step), abs=2e-3)
    assert gradient.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-5)
    assert np.cross(x, gradient).sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-5)


def test_a_flattened_zigzag_returns_to_its_folds():
    strip = zigzag(8, 0.02, 60.0)
    flat = grid(8, 4, 0.16, 0.08).rest.astype(np.float64)
    out = run(strip, 60, replace(HARD, bending=1e-3), start=flat, settings=replace(FREE, settling=2.0))
    span = np.ptp(out.positions[-1] - out.positions[-1].mean(axis=0), axis=0).max()
    assert np.ptp(flat[:, 0]) == pytest.approx(0.16)
    edges = out.fabric.edges
    size = np.linalg.norm(out.positions[-1][edges[:, 0]] - out.positions[-1][edges[:, 1]], axis=1)
    assert size == pytest.approx(out.fabric.length, rel=1e-3)
    assert span == pytest.approx(np.ptp(strip.rest[:, 0]), rel=2e-3)


def test_what_is_bent_a_little_is_no_crease():
    assert not assemble(zigzag(8, 0.02, 10.0), HARD, FREE).creased.any()
    fabric = assemble(zigzag(8, 0.02, 60.0), HARD, FREE)
    assert fabric.creased.sum() == 7 * 4  # the diagonals of the quadrilaterals are flat
    assert np.abs(fabric.rest_angle[fabric.creased]) == pytest.approx(np.full(28, np.radians(60.0)), rel=1e-5)


def solver_of(garment: Garment, settings: Settings = FREE, **options: object) -> Solver:
    fabric = assemble(garment, HARD, settings)
    return Solver(fabric, fabric.rest, None, HARD, settings, 8 * 40, 1 / 30, **options)


def damped(solver: Solver, v: np.ndarray) -> np.ndarray:
    """Velocities after the damping between two queries."""
    solver.cloth.v.assign(v.astype(np.float32))
    assert solver.damping is not None
    solver.damping.apply()
    return solver.velocities.astype(np.float64)


@pytest.mark.parametrize("degrees", [0.0, 60.0])
def test_damping_leaves_momentum_alone_and_takes_energy(degrees):
    solver = solver_of(zigzag(8, 0.02, degrees))
    mass = 1 / solver.cloth.inverse_mass.numpy().astype(np.float64)
    v = np.random.default_rng(0).standard_normal((len(mass), 3))
    after = damped(solver, v)
    assert mass @ after == pytest.approx(mass @ v, abs=1e-6 * mass.sum())
    assert mass @ (after**2).sum(axis=1) < 0.9 * mass @ (v**2).sum(axis=1)


def test_damping_lets_a_creased_strip_turn_as_a_whole():
    solver = solver_of(zigzag(8, 0.02, 60.0))
    turn = np.cross([1.0, 2.0, 3.0], solver.positions.astype(np.float64))
    # The flat stencils of a folded strip see no bend within a panel, the hinges none at all.
    assert damped(solver, turn) == pytest.approx(turn, abs=2e-4)


def test_damping_by_stages_is_the_exponential_of_its_rate():
    """Mode by mode: exp(-rate x interval) where that is slow; the fastest ones lose at least a third."""
    sheet = grid(24, 4, 0.24, 0.04)
    solver, fabric = solver_of(sheet), assemble(sheet, HARD, FREE)
    root = fabric.mass**-0.5
    square, modes = np.linalg.eigh(root[:, None] * fabric.bending.toarray() * root)
    left = np.exp(-HARD.bend_damping / 30 / 8 * square)
    for wanted in (0.9, 0.7, 0.5):
        k = np.argmin(np.abs(left - wanted))
        mode = root[:, None] * modes[:, k : k + 1] * [0, 0, 1]
        assert damped(solver, mode) == pytest.approx(left[k] * mode, abs=0.05 * np.abs(mode).max())
    fast = root[:, None] * modes[:, -1:] * [0, 0, 1]
    assert np.linalg.norm(damped(solver, fast)) < 0.7 * np.linalg.norm(fast)


def test_stages_grow_with_the_square_root_of_the_rate():
    assert damping_stages(0.0, 1e6, 0.004) == 0
    assert damping_stages(5e-3, 1e2, 0.004) == 3
    few, many = damping_stages(5e-3, 1e6, 0.004), damping_stages(5e-3, 1e8, 0.004)
    assert few % 2 == many % 2 == 1
    assert many / few == pytest.approx(10, rel=0.2)


def test_creases_and_damping_are_the_same_in_passes():
    strip = zigzag(8, 0.02, 60.0)
    start = grid(8, 4, 0.16, 0.08).rest.astype(np.float64)
    one, two = (run(strip, 12, start=start, settings=FREE, serial=serial).positions for serial in (True, False))
    np.testing.assert_allclose(two, one, atol=1e-5)
