"""Contacts that several particles share: momentum, friction, edges, the middles of faces, and what is held fast."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from sheets import FPS, HARD, grid, run, tilt

from garmentbench.geometry.crossing import crossing_faces
from garmentbench.scenes.material import Settings
from garmentbench.sequence import OBJECT, Body, Garment
from garmentbench.simulation.assembly import assemble
from garmentbench.simulation.cloth import Solver
from garmentbench.simulation.time_step import substeps

WEIGHTLESS = Settings(gravity=0.0)
G = 9.81
SIDE = 0.16  # of a sheet [m]


def two(lower: Garment, upper: Garment, gap: float, turn: float = 0.0, shift: float = 0.0) -> Garment:
    """Two sheets as one garment, the second turned about its middle [rad], pushed aside and `gap` above [m]."""
    middle = upper.rest.mean(axis=0)
    c, s = np.cos(turn), np.sin(turn)
    above = (upper.rest - middle) @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + lower.rest.mean(axis=0)
    above += [shift, shift, gap]
    count = len(lower.rest)
    return replace(
        lower,
        rest=np.concatenate([lower.rest, above]).astype(np.float32),
        faces=np.concatenate([lower.faces, upper.faces + count]),
        uv=np.concatenate([lower.uv, upper.uv]),
    )


def meeting(garment: Garment, lower: int, frames: int) -> tuple[np.ndarray, np.ndarray, bool]:
    """Sheets that meet at 1 m/s, the `lower` particles going up. Momentum before and after over one sheet's own
    [1], shape (3,) each, and whether faces ever cross."""
    fabric = assemble(garment, HARD, WEIGHTLESS)
    count = substeps(fabric, HARD, WEIGHTLESS, 1 / FPS)
    solver = Solver(fabric, garment.rest.astype(float), None, HARD, WEIGHTLESS, count, 1 / FPS)
    v = np.zeros((len(fabric.mass), 3), np.float32)
    v[:lower, 2], v[lower:, 2] = 0.5, -0.5
    solver.cloth.v.assign(v)
    own = 0.5 * fabric.mass[:lower].sum()
    before, crossed = fabric.mass @ solver.velocities / own, False
    for _ in range(frames):
        solver.advance()
        crossed |= bool(crossing_faces(solver.positions[None], garment.faces, garment.seams).any())
    after = fabric.mass @ solver.velocities / own
    assert np.abs(solver.velocities[:, 2]).max() < 0.45  # they have met
    return before, after, crossed


@pytest.mark.parametrize("cells", [(8, 8), (2, 12), (12, 2), (1, 8)], ids=str)
@pytest.mark.parametrize("turn, shift", [(0.0, 0.0), (0.3, 0.003)])
def test_sheets_that_meet_keep_their_momentum(cells, turn, shift):
    below, above = (grid(n, n, SIDE, SIDE) for n in cells)
    before, after, crossed = meeting(two(below, above, 0.02, turn, shift), len(below.rest), frames=3)
    assert after == pytest.approx(before, abs=1e-5)
    assert not crossed


def test_strips_that_cross_meet_with_their_edges_alone():
    """No corner of the one comes near a face of the other."""
    below, above = grid(1, 1, 0.02, SIDE), grid(1, 1, SIDE, 0.02)
    before, after, crossed = meeting(two(below, above, 0.02), 4, frames=3)
    assert after == pytest.approx(before, abs=1e-5)
    assert not crossed


@pytest.mark.parametrize("degrees, slides", [(15.0, False), (35.0, True)])
def test_cloth_slides_on_cloth_as_coulomb_says(degrees, slides):
    """The lower sheet is held fast: it is infinitely heavy."""
    size = 12
    held = grid(size, size, 0.3, 0.3, pins=range((size + 1) ** 2))
    both = two(held, grid(4, 4, 0.08, 0.08), 0.1)
    level = both.rest.astype(float)
    level[len(held.rest) :, 2] = HARD.thickness - G / Settings().contact_frequency ** 2  # where its weight is carried
    start = tilt(level, degrees)
    out = run(both, 10, start=start)
    moved = (out.positions[-1] - start)[len(held.rest) :].mean(axis=0)
    angle = np.radians(degrees)
    way, off = moved @ [np.cos(angle), 0, -np.sin(angle)], moved @ [np.sin(angle), 0, np.cos(angle)]
    expected = 0.5 * G * (np.sin(angle) - HARD.friction * np.cos(angle)) * (9 / FPS) ** 2 if slides else 0.0
    assert way == pytest.approx(expected, rel=0.03, abs=1e-3)
    assert off == pytest.approx(0.0, abs=1e-3)
    np.testing.assert_allclose(out.positions[-1, : len(held.rest)], start[: len(held.rest)], atol=1e-6)


def ball(radius: float, middle: tuple[float, float, float]) -> Body:
    mesh = trimesh.creation.icosphere(subdivisions=3, radius=radius)
    return Body("ball", (mesh.vertices + middle).astype(np.float32), mesh.faces.astype(np.int32), kind=OBJECT)


@pytest.mark.parametrize("at", [(1 / 3, 1 / 3), (0.5, 0.5)], ids=["face", "edge"])
def test_the_middle_of_a_face_is_held_off_what_is_smaller_than_the_face(at):
    """A sheet with edges of 16 cm falls on a ball of 4 cm, of which its particles never come near."""
    sheet, radius = grid(1, 1, SIDE, SIDE), 0.02
    middle = np.array([SIDE * at[0], SIDE * at[1], -radius - 0.02])
    body = ball(radius, tuple(middle))
    out = run(sheet, np.tile(body.rest.astype(float), (6, 1, 1)), HARD, body)
    samples = [out.positions[:, ends].mean(axis=2) for ends in (sheet.faces, out.fabric.edges)]
    distance = np.linalg.norm(np.concatenate(samples, axis=1) - middle, axis=-1)
    assert distance.min() > radius
    assert distance.min() < radius + HARD.thickness  # it has arrived


def test_a_strip_dropped_on_end_folds_and_does_not_cross_itself():
    strip = grid(3, 24, 0.06, 0.48)
    start = np.stack([strip.rest[:, 0], 0.004 * np.sin(20 * strip.rest[:, 1]), strip.rest[:, 1] + 0.02], axis=1)
    points = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
    floor = Body("floor", points, np.array([[0, 1, 2], [0, 2, 3]], np.int32), kind=OBJECT)
    out = run(strip, np.tile(points.astype(float), (25, 1, 1)), HARD, floor, start)
    assert np.ptp(out.positions[-1, :, 2]) < 0.2  # it has folded
    assert not crossing_faces(out.positions, strip.faces, strip.seams).any()


def test_a_corner_that_has_little_part_in_a_contact_is_not_shot_away():
    """A pinned corner has been carried against a face, next to its edge that is pinned, too: the third one is free."""
    lower = np.float32([[0, 0, 0], [0.04, 0, 0], [0.02, 0.04, 0]])
    upper = np.float32([[0.02, 0, 0], [0, 0, 0.03], [0.04, 0, 0.03]]) + np.float32([0, 4e-5, 0.02])
    faces, pins = np.int32([[0, 1, 2], [3, 5, 4]]), np.int32([0, 1, 3, 4, 5])
    rest = np.concatenate([lower, upper])
    cloth = replace(grid(1, 1, SIDE, SIDE), rest=rest, faces=faces, uv=rest[:, :2], pins=pins)
    fabric = assemble(cloth, HARD, WEIGHTLESS)
    start = cloth.rest.astype(float)
    start[3:, 2] -= 0.019
    solver = Solver(fabric, start, None, HARD, WEIGHTLESS, substeps(fabric, HARD, WEIGHTLESS, 1 / FPS), 1 / FPS)
    solver.advance()
    assert np.abs(solver.velocities).max() < 5.0


def test_many_contacts_are_the_same_in_parallel_and_each_time():
    below, above = grid(6, 6, SIDE, SIDE), grid(8, 8, SIDE, SIDE)
    both = two(below, above, 0.008, 0.3)
    body = ball(0.05, (0.08, 0.08, -0.06))
    ground = np.tile(body.rest.astype(float), (8, 1, 1))
    one, again = (run(both, ground, HARD, body).positions for _ in range(2))
    other = run(both, ground, HARD, body, serial=False).positions
    assert one.tobytes() == again.tobytes()
    np.testing.assert_allclose(other, one, atol=2e-6)
