"""The stick: a closed capsule, rigid in every frame, smooth from rest on, winding up and unwinding."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
import trimesh

from garmentbench.errors import UsageError
from garmentbench.motion.stick import LENGTH, RADIUS, WARM_UP, animate_stick, stick, stick_motions
from garmentbench.scenes.garments import load_garment
from garmentbench.scenes.scene import Motion, Scene

FPS = 30.0
ROLLING = ("stick-a", "stick-b", "stick-c")
SWINGING = ("stick-swing-a", "stick-swing-b")


def scene(motion: Motion) -> Scene:
    return Scene("test", "sheet", "stick", motion, "train", 300, FPS)


def frames_of_stick(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotation, shape (T, 3, 3), and middle, shape (T, 3), that carry the stick at rest to each frame's points."""
    rest = stick().rest.astype(np.float64)
    middle = points.mean(axis=1)
    u, _, vt = np.linalg.svd(np.einsum("tvi,vj->tij", points - middle[:, None], rest - rest.mean(axis=0)))
    return u @ vt, middle


def test_stick_is_a_closed_even_capsule_without_parts():
    body = stick()
    mesh = trimesh.Trimesh(body.rest, body.faces, process=False)
    assert mesh.is_watertight and mesh.is_winding_consistent and mesh.euler_number == 2
    exact = np.pi * RADIUS**2 * (LENGTH + 4 / 3 * RADIUS)
    assert 0.93 * exact < mesh.volume < exact
    assert 300 <= len(body.rest) <= 600 and body.kind == "object" and body.labels is None
    assert mesh.edges_unique_length.min() > 0.4 * np.median(mesh.edges_unique_length)


@pytest.mark.parametrize("name", stick_motions())
def test_motion_is_rigid_and_starts_at_rest(name):
    animation = animate_stick(scene(Motion(name)), 300)
    positions, rest = animation.positions, animation.body.rest.astype(np.float64)
    assert positions.shape == (animation.warm_up + 300, len(rest), 3) and positions.dtype == np.float64
    np.testing.assert_allclose(positions[0], rest, atol=1e-12)
    rotation, middle = frames_of_stick(positions)
    moved = np.einsum("tij,vj->tvi", rotation, rest - rest.mean(axis=0)) + middle[:, None]
    np.testing.assert_allclose(positions, moved, atol=1e-9)
    assert np.linalg.det(rotation) == pytest.approx(np.ones(len(rotation)))


@pytest.mark.parametrize("name", stick_motions())
def test_motion_is_smooth_and_lively(name):
    positions = animate_stick(scene(Motion(name)), 300).positions
    speed = np.linalg.norm(np.diff(positions, axis=0), axis=-1) * FPS
    acceleration = np.linalg.norm(np.diff(positions, 2, axis=0), axis=-1) * FPS**2
    assert speed[0].max() < 0.01 and speed[WARM_UP:].mean() > 0.2 and speed.max() < 1.5
    assert acceleration.max() < 5
    assert positions[..., 2].min() > 0.9  # the sheet, 0.6 m long, stays off the ground


def test_motions_have_the_names_that_scenes_use():
    assert stick_motions() == [*ROLLING, *SWINGING]


@pytest.mark.parametrize("name", SWINGING)
def test_a_swinging_stick_stays_level_and_never_rolls(name):
    positions = animate_stick(scene(Motion(name)), 300).positions
    rotation, middle = frames_of_stick(positions)
    np.testing.assert_allclose(rotation[:, 2, :2], 0, atol=1e-9)  # about the vertical only
    np.testing.assert_allclose(rotation[:, :2, 2], 0, atol=1e-9)
    yaw = np.degrees(np.arctan2(rotation[WARM_UP:, 1, 0], rotation[WARM_UP:, 0, 0]))
    assert np.ptp(yaw) > 60 and (np.ptp(middle[WARM_UP:, :2], axis=0) > 0.2).all()


@pytest.mark.parametrize("name", ROLLING)
def test_stick_winds_the_sheet_up_and_lets_it_down(name):
    positions = animate_stick(scene(Motion(name)), 300).positions
    rotation, _ = frames_of_stick(positions)
    # A point on the surface, turned back into the frame of the stick's axis and the vertical.
    axis, spoke = rotation[:, :, 0], rotation[:, :, 1]
    level = np.cross([0, 0, 1.0], axis)
    level /= np.linalg.norm(level, axis=1, keepdims=True)
    up = np.cross(axis, level)
    turns = np.unwrap(np.arctan2((spoke * up).sum(1), (spoke * level).sum(1)))[WARM_UP:] / (2 * np.pi)
    assert turns.min() < -1 and turns.max() > -0.3 and turns.max() < 0.25


@pytest.mark.parametrize("names", [*combinations(ROLLING, 2), SWINGING])
def test_motions_differ(names):
    a, b = (animate_stick(scene(Motion(name)), 300).positions[WARM_UP:].mean(axis=1) for name in names)
    assert np.linalg.norm(a - b, axis=1).mean() > 0.05


def test_pins_move_with_the_stick():
    pins = load_garment("sheet", "laptop")
    points = pins.rest[pins.pins].astype(np.float64)
    rest = stick().rest.astype(np.float64)
    rotation, middle = frames_of_stick(animate_stick(scene(Motion("stick-a")), 60).positions)
    carried = np.einsum("tij,vj->tvi", rotation, points - rest.mean(axis=0)) + middle[:, None]
    off_axis = np.linalg.norm(np.cross(carried - middle[:, None], rotation[:, None, :, 0]), axis=-1)
    assert np.abs(off_axis - RADIUS).max() < 0.01


def test_speed_freeze_and_place():
    plain = animate_stick(scene(Motion("stick-a")), 41).positions[WARM_UP:]
    fast = animate_stick(scene(Motion("stick-a", speed=2.0)), 21).positions[WARM_UP:]
    np.testing.assert_allclose(fast, plain[::2], atol=1e-12)
    frozen = animate_stick(scene(Motion("stick-a", freeze_after=10)), 41).positions[WARM_UP:]
    np.testing.assert_allclose(frozen[:11], plain[:11], atol=1e-12)
    assert np.ptp(frozen[20:], axis=0).max() < 1e-12 < np.ptp(frozen[10:20], axis=0).max()
    placed = animate_stick(scene(Motion("stick-a", translate=(5.0, 0.0, 1.0), turn=90.0)), 41).positions[WARM_UP:]
    np.testing.assert_allclose(
        placed, np.stack([5 - plain[..., 1], plain[..., 0], 1 + plain[..., 2]], axis=-1), atol=1e-9
    )


def test_unknown_motion_tells_the_nearest():
    with pytest.raises(UsageError, match="did you mean 'stick-a'"):
        animate_stick(replace(scene(Motion("stick-aa")), name="x"), 10)
