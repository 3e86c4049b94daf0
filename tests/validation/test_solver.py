"""The solver as a whole: seams, determinism, both ways of running it, its step bound, and far from the origin."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from sheets import FPS, grid, run

from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import OBJECT, Body
from garmentbench.simulation.assembly import assemble
from garmentbench.simulation.time_step import stretch_damping, substeps

CLOTH = Material()


def ball(frames: int) -> tuple[Body, np.ndarray]:
    """A ball under a sheet that begins at the origin; it moves off to the side and turns. Positions (T, B, 3)."""
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=0.12)
    body = Body("ball", mesh.vertices.astype(np.float32), mesh.faces.astype(np.int32), kind=OBJECT)
    t = np.arange(frames) / FPS
    c, s, zero, one = np.cos(2 * t), np.sin(2 * t), 0 * t, 1 + 0 * t
    turns = np.stack([c, -s, zero, s, c, zero, zero, zero, one], axis=-1).reshape(-1, 3, 3)
    centre = np.stack([0.2 + 0.3 * t**2, 0.2 + zero, -0.13 + zero], axis=-1)
    return body, mesh.vertices @ turns.transpose(0, 2, 1) + centre[:, None]


def on_ball(frames: int = 20, **options: object):
    body, positions = ball(frames)
    return run(grid(16, 16, 0.4, 0.4), positions, CLOTH, body, **options)


def test_same_input_gives_the_same_bytes():
    assert on_ball().positions.tobytes() == on_ball().positions.tobytes()


def test_serial_path_is_the_two_pass_path():
    np.testing.assert_allclose(on_ball(serial=False).positions, on_ball().positions, atol=1e-6)


def test_nothing_changes_a_kilometre_away():
    body, positions = ball(12)  # later, what rounds off far away has grown in the folds
    sheet, offset = grid(16, 16, 0.4, 0.4), np.array([1000.0, -300.0, 20.0])
    far = run(sheet, positions + offset, CLOTH, body, start=sheet.rest + offset)
    np.testing.assert_allclose(far.positions - offset, on_ball(12).positions, atol=1e-4)


def test_no_vertex_in_the_ball():
    out = on_ball(30)
    _, positions = ball(30)
    distance = np.linalg.norm(out.positions - positions.mean(axis=1)[:, None], axis=-1)
    assert distance.min() > 0.117  # the icosphere's faces lie below its vertices' sphere by 1.7 mm


def test_sheet_follows_a_ball_that_carries_it():
    out = on_ball(30)
    moved = (out.positions[-1] - out.positions[0]).mean(axis=0)
    assert moved[0] > 0.15


def test_seams_are_held_exactly():
    left, columns = grid(8, 8, 0.2, 0.2), 9
    right = left.rest + np.float32([0.2, 0, 0])
    a = np.arange(columns) * columns + 8
    b = np.arange(columns) * columns + len(right)
    both = replace(
        left,
        rest=np.concatenate([left.rest, right]),
        faces=np.concatenate([left.faces, left.faces + len(right)]),
        uv=np.concatenate([left.uv, left.uv]),
        seams=np.column_stack([a, b]).astype(np.int32),
        pins=np.array([72], np.int32),
    )
    out = run(both, 20, CLOTH, settings=Settings(mass_floor=0.0))
    assert np.array_equal(out.positions[:, a], out.positions[:, b])
    assert out.strain[:, 1].max() < 0.1
    assert out.fabric.mass.sum() == pytest.approx(0.4 * 0.2 * CLOTH.density, rel=1e-5)


def test_pins_follow_the_collider():
    body, positions = ball(20)
    sheet = grid(16, 16, 0.4, 0.4, pins=[8 * 17 + 8])
    pinned = run(sheet, positions, CLOTH, body).positions[:, sheet.pins[0]]
    near = np.argmin(np.linalg.norm(positions[0] - pinned[0], axis=1))
    distance = np.linalg.norm(pinned - positions[:, near], axis=1)
    assert np.ptp(distance) < 1e-4
    assert pinned[-1, 0] - pinned[0, 0] > 0.1


def test_a_push_at_the_start_moves_all_but_the_pins():
    sheet = grid(4, 4, 0.2, 0.2, pins=[0, 4])
    pushed = run(sheet, 2, settings=Settings(start_noise=0.01)).positions[0] - sheet.rest
    length = np.linalg.norm(pushed, axis=1)
    assert np.flatnonzero(length < 1e-9).tolist() == [0, 4]
    assert np.delete(length, [0, 4]) == pytest.approx(np.full(23, 0.01), rel=1e-4)


@pytest.mark.parametrize("stretch, bending", [(300.0, 1.5e-4), (300.0, 3e-2), (30000.0, 1.5e-2)])
def test_stable_at_the_bound_and_not_far_beyond(stretch, bending):
    """The bound holds in every shape, so a flat sheet still stands a little more; not three times the step."""
    sheet, material = grid(10, 10, 0.2, 0.2), replace(CLOTH, stretch=stretch, bending=bending)
    good = run(sheet, 8, material, settings=Settings(step_margin=0.99, start_noise=1e-3, queries=1))
    assert good.status == "ok"
    assert good.strain[-1, 0] < 2e-3
    bad = run(sheet, 8, material, settings=Settings(step_margin=3.0, start_noise=1e-3, queries=1))
    assert bad.status == "unstable"
    assert bad.first_bad_frame is not None


def test_stiffer_cloth_takes_more_substeps_and_is_as_stiff_as_it_says():
    sheet, settings = grid(10, 10, 0.2, 0.2), Settings()
    stiff = replace(CLOTH, stretch=100 * CLOTH.stretch, bending=100 * CLOTH.bending)
    soft, hard = assemble(sheet, CLOTH, settings), assemble(sheet, stiff, settings)
    np.testing.assert_allclose(hard.stiffness, 100 * soft.stiffness)
    assert hard.squared_frequencies == pytest.approx([100 * f for f in soft.squared_frequencies], rel=1e-2)
    assert substeps(hard, stiff, settings, 1 / FPS) > 8 * substeps(soft, CLOTH, settings, 1 / FPS)


def test_substeps_of_one_spring_from_its_formula():
    """Two particles of mass m, one spring k: w^2 = 2 k / m."""
    sheet, settings = grid(1, 1, 0.1, 0.1), Settings(queries=1, step_margin=1.0)
    material = replace(CLOTH, bending=0.0)
    fabric = assemble(sheet, material, settings)
    pair = replace(
        fabric,
        rest=fabric.rest[:2],
        mass=np.full(2, 1e-4),
        pinned=fabric.pinned[:2],
        edges=np.array([[0, 1]]),
        length=fabric.length[:1],
        stiffness=np.array([50.0]),
        stencils=fabric.stencils[:0],
        curvature=fabric.curvature[:0],
        bend_stiffness=fabric.bend_stiffness[:0],
        rest_angle=fabric.rest_angle[:0],
    )
    w = np.sqrt(2 * 50.0 / 1e-4)
    z = stretch_damping(material, w**2) * w / 2
    assert substeps(pair, material, settings, 1 / FPS) == np.ceil(w / (2 * (np.sqrt(1 + z**2) - z)) / FPS)


def test_kinetic_energy_dies_out_on_a_body_that_stands_still():
    body, positions = ball(1)
    out = run(grid(16, 16, 0.4, 0.4), np.tile(positions, (150, 1, 1)), CLOTH, body)
    assert out.kinetic[-1] < 1e-5 * out.kinetic.max()
