"""The walk: feet that stay where they stand, joints that never jump, cycles that repeat, knees that bend one way."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from garmentbench.motion.easing import cyclic_steps, rolling_start, smoothstep
from garmentbench.motion.foot import STANCE
from garmentbench.motion.gait import GAITS
from garmentbench.motion.variation import vary
from garmentbench.motion.walk import swing_path, walk
from garmentbench.scenes.bodies import joint_positions, load_body, pose_exact

FPS = 30


def one_cycle(name: str, body: str = "base"):
    """Two steps and a frame of the settled walk: the body, its gait, phases, walk, joints and vertices."""
    baked, gait = load_body(body, "small"), GAITS[name]
    phase = 3 + np.arange(round(gait.period * FPS) + 3) / (gait.period * FPS)
    moves = walk(baked, gait, phase, np.ones_like(phase))
    joints = joint_positions(baked, moves.rotations, moves.root)
    return baked, gait, phase, moves, joints, pose_exact(baked, moves.rotations, moves.root)


@pytest.mark.parametrize("name", GAITS)
def test_a_foot_on_the_ground_does_not_slide(name):
    baked, _, phase, _, _, vertices = one_cycle(name)
    for side, offset in (("L", 0.0), ("R", 0.5)):
        foot = baked.weights[:, [baked.joint_names.index(f"{n}.{side}") for n in ("foot", "toes")]].sum(axis=1) > 0.5
        own = (phase + offset) % 1
        stood = 0
        for frame in range(len(phase) - 1):
            if own[frame] > STANCE or own[frame + 1] > STANCE or own[frame + 1] < own[frame]:
                continue
            now, then = vertices[frame][foot], vertices[frame + 1][foot]
            grounded = (now[:, 2] < 0.004) & (then[:, 2] < 0.004)
            assert grounded.any()
            assert np.linalg.norm(then - now, axis=1)[grounded].max() < 0.01
            stood += 1
        assert stood > 0.5 * len(phase)


@pytest.mark.parametrize("name", GAITS)
def test_a_foot_is_on_the_ground_at_any_time_and_nothing_below(name):
    lowest = one_cycle(name)[-1][:, :, 2].min(axis=1)
    assert lowest.min() > -1e-6 and lowest.max() < 0.004


@pytest.mark.parametrize("name", GAITS)
def test_joints_move_smoothly(name):
    _, gait, _, moves, joints, _ = one_cycle(name)
    velocity = np.diff(joints, axis=0) * FPS
    acceleration = np.diff(velocity, axis=0) * FPS
    assert np.linalg.norm(velocity, axis=-1).max() < 5 * gait.stride / gait.period  # a swinging foot
    assert np.linalg.norm(acceleration, axis=-1).max() < 100
    step = np.einsum("tjab,tjab->tj", moves.rotations[1:], moves.rotations[:-1])  # 1 + 2 cos of the angle
    assert np.degrees(np.arccos(np.clip((step - 1) / 2, -1, 1))).max() < 25


@pytest.mark.parametrize("name", GAITS)
def test_a_cycle_later_it_is_a_stride_further_and_the_same(name):
    """... where strides don't vary; where they do, they differ by centimetres and never by a jump."""
    baked, phase = load_body("base", "small"), np.array([3.2, 4.2])
    for variation, low, high in ((0.0, 0.0, 1e-9), (1.0, 1e-3, 0.15)):
        gait = replace(GAITS[name], variation=variation)
        moves = walk(baked, gait, phase, np.ones_like(phase))
        then, later = pose_exact(baked, moves.rotations, moves.root)
        difference = np.abs(later - then - [0.0, -gait.stride, 0.0]).max()
        assert low <= difference <= high


def test_no_two_cycles_of_a_long_walk_are_alike():
    """30 s of walking hold 27 different strides (arm space within 5 degrees of its mean), not one 27 times."""
    spaces = vary(GAITS["armspace-75"], np.arange(27.0)).arm_space
    assert np.abs(spaces - GAITS["armspace-75"].arm_space).max() < 5
    assert np.diff(np.sort(spaces)).min() > 1e-4 and spaces.std() > 0.5


@pytest.mark.parametrize("body", ["base", "slim", "heavy"])
@pytest.mark.parametrize("name", GAITS)
def test_knees_bend_as_people_do(name, body):
    """Never backwards, nearly stretched under the body, 55 to 75 degrees in swing (clinical gait: about 60)."""
    baked, _, _, _, joints, _ = one_cycle(name, body)
    hip, knee, ankle = (joints[:, baked.joint_names.index(f"{n}.L")] for n in ("thigh", "calf", "foot"))
    thigh, calf = knee - hip, ankle - knee
    bend = np.degrees(np.arctan2(np.cross(thigh, calf)[:, 0], np.einsum("ti,ti->t", thigh, calf)))
    assert 5 < bend.min() < 20 and 55 < bend.max() < 75


@pytest.mark.parametrize("name", GAITS)
def test_elbows_bend_forward(name):
    baked, _, _, _, joints, _ = one_cycle(name)
    shoulder, elbow, wrist = (joints[:, baked.joint_names.index(f"{n}.R")] for n in ("upper_arm", "fore_arm", "hand"))
    assert (np.cross(elbow - shoulder, wrist - elbow)[:, 0] < 0).all()


@pytest.mark.parametrize("name", GAITS)
def test_feet_pass_each_other(name):
    """A swinging foot goes round the standing one, in the catwalk's narrow track, too."""
    baked, _, _, _, _, vertices = one_cycle(name)
    left, right = (
        vertices[:, baked.weights[:, [baked.joint_names.index(f"{n}.{s}") for n in ("foot", "toes")]].sum(axis=1) > 0.9]
        for s in "LR"
    )
    apart = [cKDTree(a).query(b)[0].min() for a, b in zip(left, right, strict=True)]
    assert min(apart) > 0.01


def test_arms_swing_against_the_legs_of_their_side():
    baked, _, _, _, joints, _ = one_cycle("armspace-75")
    at = {name: joints[:, baked.joint_names.index(name), 1] - joints[:, 0, 1] for name in ("hand.L", "foot.L")}
    assert np.corrcoef(at["hand.L"], at["foot.L"])[0, 1] < -0.7


def test_arm_space_orders_the_walks():
    reach = {}
    for name in ("armspace-60", "armspace-75", "armspace-90"):
        baked, _, _, _, joints, _ = one_cycle(name)
        elbow, shoulder = (joints[:, baked.joint_names.index(f"{n}.L")] for n in ("fore_arm", "upper_arm"))
        reach[name] = (elbow - shoulder)[:, 0].mean()
    assert reach["armspace-60"] + 0.03 < reach["armspace-75"] < reach["armspace-90"] - 0.03


def test_easings():
    u = np.linspace(-1, 2, 3001)
    assert smoothstep(0.0) == 0 and smoothstep(0.5) == 0.5 and smoothstep(2.0) == 1
    assert rolling_start(-1.5) == 0 and rolling_start(1.5) == 1.5 and rolling_start(0.0) == pytest.approx(0.1875)
    assert (np.diff(swing_path(u)) > -1e-12).all()
    np.testing.assert_allclose(swing_path(np.array([0.0, 0.5, 1.0])), [0.0, 0.5, 1.0], atol=1e-12)
    steps = ((0.1, 0.3, 2.0), (0.8, 1.1, -2.0))  # the second runs past the end of the cycle
    np.testing.assert_allclose(cyclic_steps(u, steps), cyclic_steps(u + 5, steps), atol=1e-9)
