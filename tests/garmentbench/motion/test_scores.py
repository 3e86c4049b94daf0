"""Dances, run, jump, stand-still, frame by frame: planted feet, no jumps, free flight, knees and arms as people's."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial import cKDTree

from garmentbench.geometry.crossing import crossing_faces
from garmentbench.motion import animate
from garmentbench.motion.notation import Score
from garmentbench.motion.performing import perform
from garmentbench.motion.scores import SCORES
from garmentbench.motion.timing import WARM_UP, score_timing
from garmentbench.scenes.bodies import BakedBody, joint_positions, load_body, pose_exact
from garmentbench.scenes.presets import PRESETS
from garmentbench.scenes.scene import Motion, Scene

FPS = 30
FRAMES = 495
LAPTOP = PRESETS["laptop"]
DANCES = [name for name in SCORES if name.startswith("dance")]
GRAVITY = 9.81


def scene(name: str, body: str = "base", frames: int = 60, **motion) -> Scene:
    return Scene("a-scene", "tshirt", body, Motion(name, **motion), "train", frames)


@cache
def performed(
    name: str, body: str = "base", frames: int = FRAMES
) -> tuple[BakedBody, np.ndarray, np.ndarray, np.ndarray]:
    """The body, its bones' rotations, its joints and its vertices in a scene's frames, from frame 0 on."""
    baked = load_body(body, "small")
    when = score_timing(Motion(name), frames, FPS)
    seconds = when.phase[WARM_UP:]
    moves = perform(baked, SCORES[name](baked, float(seconds[-1])), seconds, np.ones(frames))
    joints = joint_positions(baked, moves.rotations, moves.root)
    return baked, moves.rotations, joints, pose_exact(baked, moves.rotations, moves.root)


def joint(baked: BakedBody, joints: np.ndarray, name: str) -> np.ndarray:
    return joints[:, baked.joint_names.index(name)]


def feet(baked: BakedBody, side: str) -> np.ndarray:
    """Which vertices are a foot's."""
    return baked.weights[:, [baked.joint_names.index(f"{n}.{side}") for n in ("foot", "toes")]].sum(axis=1) > 0.5


@pytest.mark.parametrize("name", SCORES)
def test_what_touches_the_floor_does_not_slide_and_nothing_is_below(name):
    baked, _, _, vertices = performed(name)
    assert vertices[..., 2].min() > -1e-5
    stood = 0
    for side in "LR":
        foot = vertices[:, feet(baked, side)]
        down = foot[..., 2] < 0.004
        still = down[1:-1] & down[:-2] & down[2:]  # on the floor before and after, too: not in the middle of a landing
        slide = np.linalg.norm(foot[2:, :, :2] - foot[1:-1, :, :2], axis=-1)
        assert slide[still].max() < 0.01
        stood += still.any(axis=1).sum()
    assert stood > 0.45 * FRAMES


@pytest.mark.parametrize("name", SCORES)
def test_joints_and_bones_move_smoothly(name):
    """The swiftest are a runner's foot, about three times as fast as he is, and the hands of one who jumps."""
    _, rotations, joints, _ = performed(name)
    velocity = np.diff(joints, axis=0) * FPS
    acceleration = np.diff(velocity, axis=0) * FPS
    assert np.linalg.norm(velocity, axis=-1).max() < 8.5
    assert np.linalg.norm(acceleration, axis=-1).max() < 140
    turned = np.einsum("tjab,tjab->tj", rotations[1:], rotations[:-1])  # 1 + 2 cos of the angle
    assert np.degrees(np.arccos(np.clip((turned - 1) / 2, -1, 1))).max() < 36


@pytest.mark.parametrize("body", ["base", "heavy", "tall", "short"])
@pytest.mark.parametrize("name", SCORES)
def test_knees_bend_one_way(name, body):
    baked, rotations, joints, _ = performed(name, body, 150)
    for side in "LR":
        hip, knee, ankle = (joint(baked, joints, f"{n}.{side}") for n in ("thigh", "calf", "foot"))
        thigh, calf = knee - hip, ankle - knee
        hinge = rotations[:, baked.joint_names.index(f"thigh.{side}")] @ np.array([1.0, 0.0, 0.0])
        bend = np.degrees(np.arctan2(np.sum(np.cross(thigh, calf) * hinge, axis=1), np.sum(thigh * calf, axis=1)))
        assert bend.min() > 4 and bend.max() < 130


@pytest.mark.parametrize("name", ["run", "jump", "dance-bounce"])
def test_folded_limbs_keep_out_of_each_other(name):
    """Calf and thigh, thigh and trunk, fore-arm and upper arm: between skins that cross there is no place for cloth."""
    baked, _, _, vertices = performed(name, frames=180)
    bare = [joint.split(".")[0] in ("head", "hand", "foot", "toes") for joint in baked.joint_names]
    clothed = baked.body.faces[(baked.weights[:, bare].sum(axis=1) < 0.5)[baked.body.faces].all(axis=1)]
    crossing = crossing_faces(vertices[::2].astype(np.float32), clothed, np.zeros((0, 2), int))
    assert not crossing.any()


@pytest.mark.parametrize("name", SCORES)
def test_arms_keep_out_of_the_trunk(name):
    """Wrist and elbow are outside the trunk's own skin, by an arm's half width."""
    baked, _, joints, vertices = performed(name)
    trunk = (
        baked.weights[:, [baked.joint_names.index(n) for n in ("pelvis", "spine", "waist", "chest")]].sum(axis=1) > 0.7
    )
    for frame in range(0, FRAMES, 6):
        skin = vertices[frame, trunk]
        for end in ("fore_arm.L", "fore_arm.R", "hand.L", "hand.R"):
            assert np.linalg.norm(skin - joint(baked, joints, end)[frame], axis=1).min() > 0.035


@pytest.mark.parametrize("name", SCORES)
def test_hands_leave_room_for_a_garment(name):
    """Fingers keep 4 cm off trunk and thighs: a hand that grazes a shirt tears through it."""
    baked, _, _, vertices = performed(name)
    hands, skin = (
        baked.weights[:, [baked.joint_names.index(n) for n in names]].sum(axis=1) > 0.6
        for names in (("hand.L", "hand.R"), ("pelvis", "spine", "waist", "chest", "thigh.L", "thigh.R"))
    )
    for frame in range(0, FRAMES, 4):
        assert cKDTree(vertices[frame, skin]).query(vertices[frame, hands])[0].min() > 0.04


def flights(score: Score, end: float) -> list[tuple[float, float]]:
    """From when to when neither foot stands [s]."""
    edges = sorted([(p.land, 1) for foot in (score.left, score.right) for p in foot]
                   + [(p.leave, -1) for foot in (score.left, score.right) for p in foot])  # fmt: skip
    standing = np.cumsum([change for _, change in edges])
    return [
        (edges[k][0], edges[k + 1][0])
        for k in np.flatnonzero(standing == 0)[:-1]
        if edges[k + 1][0] < min(end, edges[k][0] + 1.0) and edges[k + 1][0] > edges[k][0] + 0.08
    ]


@pytest.mark.parametrize("body", ["base", "tall", "short"])
@pytest.mark.parametrize(("name", "at_least"), [("run", 20), ("jump", 3)])
def test_the_body_flies_freely(name, at_least, body):
    """From when the last foot leaves the floor to when the first lands, the pelvis falls by g, all skin in the air."""
    baked, end, dt = load_body(body, "small"), 10.0, 0.01
    score = SCORES[name](baked, end)
    seconds = np.arange(0.0, end, dt)
    moves = perform(baked, score, seconds, np.ones(len(seconds)))
    found = flights(score, end)
    assert len(found) >= at_least
    for off, on in found:
        inside = (seconds > off + 0.03) & (seconds < on - 0.03)
        np.testing.assert_allclose(np.diff(moves.root[inside, 2], 2) / dt**2, -GRAVITY, atol=0.02)
        middle = np.abs(seconds - (off + on) / 2).argmin()
        assert pose_exact(baked, moves.rotations[[middle]], moves.root[[middle]])[..., 2].min() > 0.01


@pytest.mark.parametrize("name", SCORES)
def test_the_legs_do_not_run_into_each_other(name):
    baked, _, _, vertices = performed(name)
    left, right = (
        vertices[
            :,
            baked.weights[:, [baked.joint_names.index(f"{n}.{side}") for n in ("calf", "foot", "toes")]].sum(axis=1)
            > 0.9,
        ]
        for side in "LR"
    )
    assert min(cKDTree(left[k]).query(right[k])[0].min() for k in range(0, FRAMES, 4)) > 0.008


@pytest.mark.parametrize("name", [*DANCES, "still"])
def test_one_foot_at_least_is_on_the_floor(name):
    _, _, _, vertices = performed(name)
    assert vertices[..., 2].min(axis=1).max() < 0.004


def test_a_run_goes_forward_at_its_speed_and_the_others_stay_about_where_they_are():
    _, _, joints, _ = performed("run")
    assert -np.diff(joints[60:, 0, 1]).mean() * FPS == pytest.approx(1.8 / 0.72, rel=0.05)
    for name in (*DANCES, "jump", "still"):
        _, _, joints, _ = performed(name)
        assert np.ptp(joints[:, 0, :2], axis=0).max() < 1.5


@pytest.mark.parametrize("name", DANCES)
def test_a_dance_does_not_loop(name):
    """No second of it comes again: seen from the pelvis, the pose a second later and ever after is another one."""
    baked, rotations, joints, _ = performed(name)
    seen = np.einsum("tba,tjb->tja", rotations[:, baked.joint_names.index("head")], joints - joints[:, :1])
    windows = np.stack([seen[k : FRAMES - 30 + k] for k in range(0, 30, 5)], axis=1)
    for frame in range(0, FRAMES - 60, 15):
        apart = np.linalg.norm(windows[frame + 30 :] - windows[frame], axis=-1).mean(axis=(1, 2))
        assert apart.min() > 0.004


def test_the_dances_differ_in_kind():
    """Hips lead the Latin step, the spin turns the body round, the hands are highest in the bouncing one."""
    turned, hips, hands = {}, {}, {}
    for name in DANCES:
        baked, rotations, joints, _ = performed(name)
        facing = rotations[:, baked.joint_names.index("head"), :2, 1]
        turned[name] = np.abs(np.unwrap(np.arctan2(facing[:, 0], facing[:, 1]))).max()
        hips[name] = np.degrees(np.abs(rotations[:, 0, 2, 0])).mean()  # the pelvis' list
        hands[name] = np.quantile(joint(baked, joints, "hand.L")[:, 2], 0.75)
    assert turned["dance-spin"] > 2 * np.pi - 0.3 > max(turned["dance-latin"], turned["dance-bounce"])
    assert hips["dance-latin"] > 2 * max(hips["dance-spin"], hips["dance-bounce"])
    assert hands["dance-bounce"] > 0.1 + max(hands["dance-latin"], hands["dance-spin"])


def test_standing_still_is_nearly_still():
    _, _, joints, _ = performed("still")
    assert 0.002 < np.ptp(joints[:, 0, 0]) < 0.06
    assert np.linalg.norm(np.diff(joints, axis=0), axis=-1).max() * FPS < 0.1


@pytest.mark.parametrize("name", SCORES)
def test_the_warm_up_starts_at_rest_in_the_base_shape_and_is_smooth(name):
    animation = animate(scene(name, "slim", 12), LAPTOP)
    positions = animation.positions
    np.testing.assert_allclose(positions[0], load_body("base", "small").body.rest, atol=1e-6)
    assert np.abs(positions[1] - positions[0]).max() < 1e-3
    assert np.linalg.norm(np.diff(positions, 2, axis=0), axis=-1).max() * FPS**2 < 130
    assert positions[..., 2].min() > -1e-3


@pytest.mark.parametrize("name", SCORES)
def test_speed_freeze_and_length(name):
    """Twice the speed is every other frame, a freeze is a standstill, and a longer scene begins like a shorter one."""
    plain = animate(scene(name), LAPTOP).positions[WARM_UP:]
    longer = animate(scene(name, frames=90), LAPTOP).positions[WARM_UP:]
    np.testing.assert_allclose(longer[:60], plain, atol=1e-6)
    frozen = animate(scene(name, freeze_after=20), LAPTOP).positions[WARM_UP:]
    np.testing.assert_allclose(frozen[:21], plain[:21], atol=1e-6)
    assert (frozen[30:] == frozen[30]).all()
    fast = score_timing(Motion(name, speed=2.0), 20, FPS).phase[WARM_UP:]
    np.testing.assert_allclose(np.diff(fast), 2.0 / FPS, atol=1e-12)
    baked = load_body("base", "small")
    score = SCORES[name](baked, 10.0)
    every, other = (
        perform(baked, score, np.arange(2.0, 4.0, dt), np.ones(n)) for dt, n in ((1 / FPS, 60), (2 / FPS, 30))
    )
    np.testing.assert_allclose(every.rotations[::2], other.rotations, atol=1e-5)


def test_it_may_start_anywhere():
    plain = animate(scene("dance-spin", frames=5), LAPTOP).positions
    placed = animate(scene("dance-spin", frames=5, turn=90.0, translate=(10.0, 0.0, 0.0)), LAPTOP).positions
    np.testing.assert_allclose(placed, np.stack([10 - plain[..., 1], plain[..., 0], plain[..., 2]], axis=-1), atol=1e-9)


def test_both_sizes_move_alike():
    small, full = (
        animate(scene("jump", frames=4), replace(LAPTOP, mesh=replace(LAPTOP.mesh, body_size=s))).positions[-1]
        for s in ("small", "full")
    )
    np.testing.assert_allclose(small.max(axis=0), full.max(axis=0), atol=0.008)
