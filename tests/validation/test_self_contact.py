"""Cloth against itself: it does not pass through, is not pushed apart by its own shape, and falls as it should."""

from dataclasses import replace

import numpy as np
import pytest
from sheets import FPS, HARD, floor, grid, run

from garmentbench.geometry.crossing import crossing_faces
from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import Garment
from garmentbench.simulation.recording import Recorded

CLOTH, THICKNESS = Material(), Material().thickness
TOUCHING = Settings()
COLUMNS, ROWS, EDGE = 20, 6, 0.02
UPPER, LOWER = slice(13, None), slice(0, 8)  # columns of the two leaves, away from the fold


def folded(radius: float) -> tuple[Garment, np.ndarray]:
    """A strip and where it is when folded back on itself, half a cylinder between the leaves; the lower at z = 0."""
    strip = grid(COLUMNS, ROWS, COLUMNS * EDGE, ROWS * EDGE)
    x, half, arc = strip.rest[:, 0].astype(np.float64), COLUMNS * EDGE / 2, np.pi * radius / 2
    angle = np.clip((x - half + arc) / radius, 0, np.pi)
    along = np.minimum(x, half - arc) - np.maximum(x - half - arc, 0) + radius * np.sin(angle)
    return strip, np.stack([along, strip.rest[:, 1], radius * (1 - np.cos(angle))], axis=1)


def two_sheets(gap: float) -> Garment:
    """Two level sheets of one garment, the second `gap` above the first."""
    lower = grid(8, 8, 0.16, 0.16)
    count = len(lower.rest)
    upper = lower.rest + np.float32([0, 0, gap])
    faces = np.concatenate([lower.faces, lower.faces + count])
    return replace(lower, rest=np.concatenate([lower.rest, upper]), faces=faces, uv=np.tile(lower.uv, (2, 1)))


def dropped(settings: Settings, **options: object):
    strip, start = folded(radius=0.015)
    body = floor()
    ground = np.tile(body.rest.astype(np.float64), (20, 1, 1))
    return strip, run(strip, ground, CLOTH, body, start + [0, 0, 0.01], settings, **options)


@pytest.mark.parametrize(("self_contact", "apart"), [(True, THICKNESS), (False, 0.0)])
def test_a_folded_sheet_comes_to_lie_on_itself(self_contact, apart):
    strip, out = dropped(Settings(self_contact=self_contact))
    crossing = crossing_faces(out.positions, strip.faces, strip.seams).sum(axis=1)
    z = out.positions[-1, :, 2].reshape(ROWS + 1, COLUMNS + 1)
    assert z[:, LOWER] == pytest.approx(THICKNESS, abs=2e-4)
    assert z[:, UPPER] == pytest.approx(THICKNESS + apart, abs=4e-4)
    assert crossing.any() != self_contact
    assert out.kinetic[-1] < 1e-5 * out.kinetic.max()


def test_serial_path_is_the_two_pass_path():
    one, other = dropped(TOUCHING)[1], dropped(TOUCHING, serial=False)[1]
    np.testing.assert_allclose(one.positions[10], other.positions[10], atol=2e-6)


def test_replayed_launches_give_the_same_bytes(monkeypatch):
    replayed = dropped(TOUCHING)[1].positions
    monkeypatch.setattr(Recorded, "run", lambda recorded, launches, *arguments: launches(*arguments))
    assert replayed.tobytes() == dropped(TOUCHING)[1].positions.tobytes()


def test_a_fast_sheet_does_not_go_through_another():
    """It falls from 0.35 m, at 2.6 m/s: 11 mm between two queries."""
    both, body = two_sheets(0.35), floor()
    ground = np.tile(body.rest.astype(np.float64), (16, 1, 1))
    end = run(both, ground, HARD, body, both.rest + np.array([0, 0, THICKNESS]), TOUCHING).positions
    upper, lower = end[:, 81:, 2], end[:, :81, 2]
    assert upper[7].min() > 0.08 and upper[-1].max() < 0.03  # it has arrived
    assert (upper > lower + 0.4 * THICKNESS).all()


def test_a_shape_that_lies_close_at_rest_is_not_pushed_apart():
    """Leaves 2 mm apart by their cut, nearer than the thickness, that bending opens."""
    strip, shape = folded(radius=0.001)
    cut = replace(strip, rest=shape.astype(np.float32))
    alone, own = (run(cut, 4, CLOTH, settings=Settings(gravity=0.0, self_contact=s)).positions for s in (False, True))
    np.testing.assert_allclose(own, alone, atol=1e-6)


def test_a_flat_sheet_does_not_feel_itself():
    sheet = grid(8, 8, 0.16, 0.16)
    alone, own = (run(sheet, 5, CLOTH, settings=Settings(start_noise=1e-4, self_contact=s)) for s in (False, True))
    np.testing.assert_allclose(own.positions, alone.positions, atol=1e-6)


def test_sheets_that_touch_fall_freely():
    """Planes move evenly between two queries while the cloth speeds up: what that holds back stays under 1 %."""
    both = two_sheets(2 * THICKNESS)
    start = both.rest.astype(np.float64)
    start[81:, 2] = THICKNESS  # in touch, and farther apart by their cut
    out = run(both, 16, HARD, start=start, settings=TOUCHING)
    fallen = (out.positions[0] - out.positions[-1])[:, 2].mean()
    assert fallen == pytest.approx(9.81 / 2 * (15 / FPS) ** 2, rel=1e-2)


def test_what_has_gone_through_is_brought_back():
    """The side is kept while a particle stays near the same face: one query too few does not turn cloth inside out."""
    both, body = two_sheets(0.35), floor()
    ground = np.tile(body.rest.astype(np.float64), (20, 1, 1))
    rare = replace(TOUCHING, queries=2)  # 44 mm between two queries
    end = run(both, ground, HARD, body, both.rest + np.array([0, 0, THICKNESS]), rare).positions[-1]
    assert (end[81:, 2] > end[:81, 2]).mean() > 0.5
