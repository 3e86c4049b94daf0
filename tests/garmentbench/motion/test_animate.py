"""A scene's motion: where it starts, how speed, freeze, place and frame limits change it."""

from dataclasses import replace

import numpy as np
import pytest

from garmentbench.errors import UsageError
from garmentbench.geometry.crossing import crossing_faces
from garmentbench.motion import animate, motion_names
from garmentbench.motion.gait import GAITS
from garmentbench.motion.timing import WARM_UP, timing
from garmentbench.scenes.bodies import load_body
from garmentbench.scenes.presets import PRESETS
from garmentbench.scenes.scene import Motion, Scene

LAPTOP = PRESETS["laptop"]


def scene(name: str = "armspace-75", body: str = "base", frames: int = 12, **motion) -> Scene:
    return Scene("a-scene", "tshirt", body, Motion(name, **motion), "train", frames)


@pytest.mark.parametrize("body", ["base", "heavy"])
def test_warm_up_starts_at_rest_in_the_base_shape_and_ends_in_its_own(body):
    animation = animate(scene(body=body), LAPTOP)
    assert animation.positions.dtype == np.float64
    assert len(animation.positions) == animation.warm_up + 12 and animation.body.name == body
    base = load_body("base", "small").body.rest
    np.testing.assert_allclose(animation.positions[0], base, atol=1e-9)
    assert np.abs(animation.positions[1] - animation.positions[0]).max() < 1e-3  # at rest, too
    feet = animation.positions[animation.warm_up :, :, 2].min(axis=1)
    assert (feet > -1e-5).all() and (
        feet < 0.004
    ).all()  # the roll is a spline: up to 2 micrometres low between its knots


@pytest.mark.parametrize("name", GAITS)
def test_warm_up_is_smooth(name):
    positions = animate(scene(name, body="slim"), LAPTOP).positions
    acceleration = np.diff(positions, n=2, axis=0) * 30**2
    assert np.linalg.norm(acceleration, axis=-1).max() < 130  # a fast walk's toes have 95
    assert positions[:, :, 2].min() > -1e-3  # morphing feet may touch the ground


@pytest.mark.parametrize(
    ("name", "body", "frames"), [("armspace-60", "base", 66), ("jump", "base", 180), ("fast", "heavy", 48)]
)
def test_skin_does_not_fold_through_itself_in_armpits_and_elbows(name, body, frames):
    animation = animate(scene(name, body, frames), LAPTOP)
    moving, template = animation.positions[animation.warm_up :: 3].astype(np.float32), animation.body
    at_rest = crossing_faces(template.rest[None], template.faces, np.zeros((0, 2), int))[0]  # between toes, in an ear
    through = crossing_faces(moving, template.faces, np.zeros((0, 2), int)) & ~at_rest
    arms = [template.part_names.index(part) for part in ("rear_arm", "fore_arm")]
    assert not through[:, np.isin(template.labels[template.faces], arms).any(axis=1)].any()


@pytest.mark.parametrize(("name", "body"), [("dance-latin", "slim"), ("strut", "base"), ("jump", "tall")])
def test_a_scene_may_begin_in_the_middle_of_a_motion(name, body):
    """Its frames are those of the whole one, over the origin and facing -y; its warm-up is as calm as any."""
    whole = animate(scene(name, body, 312), LAPTOP).positions[WARM_UP + 300 :]
    animation = animate(scene(name, body, 12, start=10.0), LAPTOP)
    late = animation.positions[WARM_UP:]
    middles = whole[0].mean(axis=0), late[0].mean(axis=0)
    u, _, vt = np.linalg.svd((whole[0] - middles[0]).T @ (late[0] - middles[1]))
    np.testing.assert_allclose((whole - middles[0]) @ (u @ vt) + middles[1], late, atol=1e-9)
    assert abs((u @ vt)[2, 2] - 1) < 1e-9  # turned about the vertical alone
    np.testing.assert_allclose(animation.positions[0], load_body("base", "small").body.rest, atol=1e-9)
    acceleration = np.diff(animation.positions, n=2, axis=0) * 30**2
    assert np.linalg.norm(acceleration, axis=-1).max() < 130


def test_a_start_within_the_first_half_second_is_told():
    with pytest.raises(UsageError, match="motion.start is 0.2 s; wanted 0, or 0.5 s at least"):
        animate(scene(start=0.2), LAPTOP)


def test_a_stick_may_begin_in_the_middle_too():
    whole, late = (animate(scene("stick-a", "stick", n, start=s), LAPTOP) for n, s in ((40, 0.0), (10, 1.0)))
    np.testing.assert_allclose(late.positions[late.warm_up :], whole.positions[whole.warm_up + 30 :], atol=1e-12)


def test_double_speed_is_double_phase():
    once = timing(GAITS["armspace-75"], Motion("armspace-75"), 20, 30.0).phase[WARM_UP:]
    twice = timing(GAITS["armspace-75"], Motion("armspace-75", speed=2.0), 10, 30.0).phase[WARM_UP:]
    np.testing.assert_allclose(twice - twice[0], once[::2] - once[0], atol=1e-12)
    slow, fast = (animate(scene(frames=n, speed=v), LAPTOP).positions[WARM_UP:] for n, v in ((20, 1.0), (10, 2.0)))
    np.testing.assert_allclose(fast - fast[0], slow[::2] - slow[0], atol=1e-9)


@pytest.mark.parametrize("speed", [0.5, 1.0, 2.0, 4.0, 8.0])
@pytest.mark.parametrize("name", GAITS)
def test_phase_never_runs_back_and_joins_frame_0_smoothly(name, speed):
    phase = timing(GAITS[name], Motion(name, speed=speed), 10, 30.0).phase
    rate = speed / (GAITS[name].period * 30)
    assert (np.diff(phase) >= -1e-12).all()
    assert phase[WARM_UP] % 1 == 0
    assert phase[WARM_UP] - phase[WARM_UP - 1] == pytest.approx(rate, rel=0.03)


@pytest.mark.parametrize("speed", [1.0, 4.0])
def test_freeze_eases_to_an_exact_standstill(speed):
    positions = animate(scene(frames=40, freeze_after=10, speed=speed), LAPTOP).positions[WARM_UP:]
    free = animate(scene(frames=40, speed=speed), LAPTOP).positions[WARM_UP:]
    np.testing.assert_array_equal(positions[:11], free[:11])
    assert (positions[19:] == positions[19]).all()
    pelvis = positions.mean(axis=1)[:, 1]
    pace = -np.diff(pelvis)
    assert (pace[9:20] >= -1e-9).all() and np.abs(np.diff(pace)).max() < 0.25 * pace[:9].max()


def test_translate_and_turn_move_all_of_it_rigidly():
    plain = animate(scene(), LAPTOP).positions
    placed = animate(scene(translate=(1000.0, -20.0, 0.0), turn=90.0), LAPTOP).positions
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(placed, plain @ quarter.T + [1000.0, -20.0, 0.0], rtol=0, atol=1e-9)


def test_no_drift_over_a_long_walk():
    """After 1,150 frames a walk that is an exact loop is where it should be, to rounding."""
    gait = replace(GAITS["armspace-75"], variation=0.0)
    when = timing(gait, Motion("armspace-75"), 1151, 30.0)
    assert when.phase[WARM_UP + 1150] - when.phase[WARM_UP] == pytest.approx(1150 / (30 * gait.period), abs=1e-10)


def test_preset_limits_frames_and_chooses_the_mesh():
    assert len(animate(scene(frames=300), PRESETS["smoke"]).positions) == WARM_UP + 40
    full = replace(LAPTOP, mesh=replace(LAPTOP.mesh, body_size="full"))
    assert animate(scene(frames=4), full).positions.shape == (WARM_UP + 4, 13348, 3)


def test_both_sizes_walk_alike():
    small = animate(scene(frames=4), LAPTOP).positions[WARM_UP]
    full = animate(scene(frames=4), replace(LAPTOP, mesh=replace(LAPTOP.mesh, body_size="full"))).positions[WARM_UP]
    np.testing.assert_allclose(small.min(axis=0), full.min(axis=0), atol=0.006)
    np.testing.assert_allclose(small.max(axis=0), full.max(axis=0), atol=0.006)


def test_unknown_motion_is_told():
    assert {"armspace-75", "catwalk", "stick-a"} <= set(motion_names())
    with pytest.raises(UsageError, match="did you mean 'catwalk'"):
        animate(scene("catwlk"), LAPTOP)
