"""The walk: feet that stay where they stand, joints that never jump, strides, knees and head as people's."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from garmentbench.motion.easing import cyclic_steps, rolling_start, smoothstep
from garmentbench.motion.gait import GAITS
from garmentbench.motion.legs import rest_leg
from garmentbench.motion.variation import vary
from garmentbench.motion.walk import swing_path, walk
from garmentbench.scenes.bodies import joint_positions, load_body, pose_exact

FPS = 30


def one_cycle(name: str, body: str = "base", fps: float = FPS):
    """Two steps and a frame of the settled walk: the body, its gait, phases, walk, joints and vertices."""
    baked, gait = load_body(body, "small"), GAITS[name]
    phase = 3 + np.arange(round(gait.period * fps) + 3) / (gait.period * fps)
    moves = walk(baked, gait, phase, np.ones_like(phase))
    joints = joint_positions(baked, moves.rotations, moves.root)
    return baked, gait, phase, moves, joints, pose_exact(baked, moves.rotations, moves.root)


@pytest.mark.parametrize("name", GAITS)
def test_a_foot_on_the_ground_does_not_slide(name):
    baked, gait, phase, _, _, vertices = one_cycle(name)
    for side, offset in (("L", 0.0), ("R", 0.5)):
        foot = baked.weights[:, [baked.joint_names.index(f"{n}.{side}") for n in ("foot", "toes")]].sum(axis=1) > 0.5
        own = (phase + offset) % 1
        slides = []
        for frame in range(len(phase) - 1):
            if own[frame] > gait.stance or own[frame + 1] > gait.stance or own[frame + 1] < own[frame]:
                continue
            now, then = vertices[frame][foot], vertices[frame + 1][foot]
            grounded = (now[:, 2] < 0.004) & (then[:, 2] < 0.004)
            assert grounded.any()
            slides.append(np.linalg.norm(then - now, axis=1)[grounded])
        assert len(slides) > 0.5 * len(phase)
        assert np.concatenate(slides).max() < 0.01 and np.quantile(np.concatenate(slides), 0.99) < 0.003


@pytest.mark.parametrize("name", GAITS)
def test_a_foot_is_on_the_ground_at_any_time_and_nothing_below(name):
    lowest = one_cycle(name)[-1][:, :, 2].min(axis=1)
    assert lowest.min() > -5e-6 and lowest.max() < 0.004  # the roll is a spline: micrometres low between its knots


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
        difference = np.abs(later - then - [0.0, -gait.of_legs(rest_leg(baked, "L").reach).stride, 0.0]).max()
        assert low <= difference <= high


def test_no_two_cycles_of_a_long_walk_are_alike():
    """30 s of walking hold 27 different strides (arm space within 5 degrees of its mean), not one 27 times."""
    spaces = vary(GAITS["armspace-75"], np.arange(27.0)).arm_space
    assert np.abs(spaces - GAITS["armspace-75"].arm_space).max() < 5
    assert np.diff(np.sort(spaces)).min() > 1e-4 and spaces.std() > 0.5


def joint(baked, joints: np.ndarray, name: str) -> np.ndarray:
    return joints[:, baked.joint_names.index(name)]


@pytest.mark.parametrize("body", ["base", "slim", "heavy", "tall", "short"])
@pytest.mark.parametrize("name", GAITS)
def test_knees_bend_as_people_do(name, body):
    """Never backwards; straight within 5 degrees at heel strike, 10 to 20 as the weight comes on, straight again under
    the body, 55 to 75 in swing (Winter 1991; Perry and Burnfield 2010: 5, 15 to 20, 5 and 60)."""
    baked, _, phase, _, joints, _ = one_cycle(name, body, fps=200)
    for side, offset in (("L", 0.0), ("R", 0.5)):
        hip, knee, ankle = (joint(baked, joints, f"{n}.{side}") for n in ("thigh", "calf", "foot"))
        thigh, calf = knee - hip, ankle - knee
        bend = np.degrees(np.arctan2(np.cross(thigh, calf)[:, 0], np.einsum("ti,ti->t", thigh, calf)))
        own = (phase + offset) % 1
        assert bend.min() > 2
        assert bend[np.minimum(own, 1 - own) < 0.004].max() < 5
        assert 10 < bend[own < 0.2].max() < 20
        assert bend[(own > 0.3) & (own < 0.42)].min() < 8
        assert 55 < bend[own > 0.6].max() < 75


@pytest.mark.parametrize("name", ["armspace-60", "armspace-75", "armspace-90", "strut", "fast"])
def test_the_ankles_walk_on_lines_8_to_10_cm_apart(name):
    """Step width of healthy adults: 8 to 10 cm on average. The catwalk is narrower by design."""
    baked, _, phase, _, joints, _ = one_cycle(name)
    left, right = (
        joint(baked, joints, f"foot.{side}")[np.abs((phase + offset) % 1 - 0.25) < 0.05, 0].mean()
        for side, offset in (("L", 0.0), ("R", 0.5))
    )
    assert 0.08 < left - right < 0.10


def test_a_foot_stands_for_less_of_the_cycle_the_faster_the_walk():
    """0.62 at 1.2 m/s (Perry), less by 0.035 a metre a second (Kirtley 1985): in the gait, and on the floor."""
    shares, speeds = {}, {}
    for name, gait in GAITS.items():
        baked, _, phase, _, _, vertices = one_cycle(name, fps=200)
        foot = baked.weights[:, [baked.joint_names.index(f"{n}.L") for n in ("foot", "toes")]].sum(axis=1) > 0.5
        down = vertices[:, foot, 2].min(axis=1) < 0.0011  # it rolls on a smoothed path, up to 1 mm above the floor
        shares[name], speeds[name] = down[phase < 4].mean(), gait.stride / gait.period
        assert shares[name] == pytest.approx(gait.stance, abs=0.03)
    assert shares["armspace-75"] == pytest.approx(0.62, abs=0.03)
    assert speeds["fast"] > speeds["strut"] > speeds["armspace-75"] and shares["fast"] < shares["strut"] < 0.625


def test_the_pelvis_rises_and_falls_by_3_to_4_cm():
    """At 1.24 m/s; people's centre of mass by about 3.5 cm (Orendurff et al. 2004)."""
    _, _, _, moves, _, _ = one_cycle("armspace-75", fps=200)
    assert 0.03 < np.ptp(moves.root[:, 2]) < 0.04


@pytest.mark.parametrize("name", GAITS)
def test_the_head_turns_a_little_with_the_chest_and_looks_ahead(name):
    baked, _, _, moves, _, _ = one_cycle(name)
    turns = {}
    for bone in ("head", "neck", "chest", "pelvis"):
        x, y = moves.rotations[:, baked.joint_names.index(bone), :2, 0].T
        turns[bone] = np.degrees(np.arctan2(y, x))
    assert 1.5 < np.ptp(turns["head"]) / 2 < 5
    assert np.ptp(turns["head"]) < np.ptp(turns["neck"]) < np.ptp(turns["chest"])
    assert abs(turns["head"].mean()) < 3
    assert np.corrcoef(turns["head"], turns["chest"])[0, 1] > 0.7
    assert np.corrcoef(turns["head"], turns["pelvis"])[0, 1] < -0.7
    ahead = -moves.rotations[:, baked.joint_names.index("head"), 2, 1]  # how far up it looks
    assert np.degrees(np.arcsin(np.abs(ahead))).max() < 6


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
