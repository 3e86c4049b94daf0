"""A garment over another one: what is touched, on which side, and where the one beneath ends."""

import numpy as np
import pytest
from sheets import FPS, HARD, floor, grid, run

from garmentbench.sequence import GARMENT, Body

THICKNESS = HARD.thickness
HEIGHT = 0.05  # of the garment beneath over the floor [m]
FRAMES = 30


def beneath(width: float = 0.2, frames: int = FRAMES, height: float = HEIGHT) -> tuple[Body, np.ndarray]:
    """A square of cloth that stands still over the middle of the floor, its upper side outwards."""
    sheet = grid(8, 8, width, width)
    rest = sheet.rest - np.float32([width / 2, width / 2, -height])
    return Body("beneath", rest, sheet.faces, kind=GARMENT), np.tile(rest.astype(np.float64), (frames, 1, 1))


def drop(width: float, start: float, inner, frames: int = FRAMES):
    """Let a sheet fall from the height `start` onto the garment beneath and the floor; its last positions."""
    sheet = grid(8, 8, width, width)
    body = floor()
    ground = np.tile(body.rest.astype(np.float64), (frames, 1, 1))
    first = sheet.rest - np.array([width / 2, width / 2, -start])
    return run(sheet, ground, body=body, start=first, inner=inner).positions[-1]


def test_a_sheet_comes_to_rest_on_the_garment_beneath():
    z = drop(0.15, HEIGHT + 0.02, beneath())[:, 2]
    assert z == pytest.approx(HEIGHT + THICKNESS, abs=1e-3)


@pytest.mark.parametrize("below", [0.002, 0.02, 0.04])  # at 4 cm the floor is nearer
def test_what_begins_beneath_it_is_brought_out(below):
    z = drop(0.15, HEIGHT - below, beneath())[:, 2]
    assert z == pytest.approx(HEIGHT + THICKNESS, abs=1.5e-3)


def test_beyond_its_border_there_is_no_inside():
    """The outer sheet is three times as wide: what is beside the edge hangs down, and is not drawn to it."""
    end = drop(0.6, HEIGHT + 0.01, beneath(frames=60), frames=60)
    from_middle = np.abs(end[:, :2]).max(axis=1)
    near, over = (from_middle > 0.14) & (from_middle < 0.2), from_middle < 0.09
    assert near.sum() > 4 and np.mean(end[near, 2] < HEIGHT) > 0.7  # folds may stand up at corners
    assert over.sum() > 4 and (end[over, 2] > HEIGHT).all()


def test_pins_are_held_by_the_nearer_of_the_two():
    t = np.arange(FRAMES) / FPS
    inner = beneath()
    moving = inner[1] + 0.3 * t[:, None, None] * np.array([1.0, 0, 0])
    sheet = grid(8, 8, 0.15, 0.15, pins=[40])
    first = sheet.rest - np.array([0.075, 0.075, -HEIGHT - 0.01])
    body = floor()
    ground = np.tile(body.rest.astype(np.float64), (FRAMES, 1, 1))
    pinned = run(sheet, ground, body=body, start=first, inner=(inner[0], moving)).positions[:, 40]
    np.testing.assert_allclose(pinned - first[40], moving[:, 0] - moving[0, 0], atol=1e-5)


def test_a_band_goes_over_a_fold_in_one_piece():
    """What is beneath folds up 1.8 cm in its middle, where its points come a third nearer to each other."""
    flat, folded = beneath(frames=4)
    column = np.arange(len(flat.rest)) % 9 - 4
    for t in range(4):
        up = 0.006 * t
        folded[t, :, 0] -= np.sign(column) * (0.025 - np.sqrt(0.025**2 - up**2))
        folded[t, column == 0, 2] += up
    band = grid(6, 1, 0.15, 0.025, pins=range(14))
    body = floor()
    ground = np.tile(body.rest.astype(np.float64), (4, 1, 1))
    held = run(band, ground, body=body, start=band.rest + [-0.075, 0.0, HEIGHT + 0.01], inner=(flat, folded))
    assert held.strain.max() < 0.15


def test_without_a_layer_beneath_nothing_changes():
    """A layer far away takes no part: the same bytes."""
    alone, far = drop(0.15, 0.05, None), drop(0.15, 0.05, beneath(height=3.0))
    assert alone.tobytes() == far.tobytes()
