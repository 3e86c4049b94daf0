"""Planted feet: neither sliding nor sinking, however wrong the path was, and nothing else changed."""

from dataclasses import replace

import bvh_example
import numpy as np
import pytest

from garmentbench.importing.motions.findings import arms_inside, foot_heights_cm, foot_slide_cm
from garmentbench.importing.motions.retarget import flat_feet, standing_feet
from garmentbench.motion.clip import Clip
from garmentbench.motion.legs import rest_leg
from garmentbench.motion.planting import plant
from garmentbench.scenes.bodies import joint_positions, load_body, pose_exact

BASE = load_body("base", "small")
LEG = rest_leg(BASE, "L").reach


def standing_walk(frames: int = 60) -> Clip:
    """Our own walk with the contacts that are seen in it."""
    walk = bvh_example.own_walk(BASE, frames)
    ankles, toes = (
        joint_positions(BASE, walk.rotations, walk.root)[:, [BASE.joint_names.index(f"{n}.{s}") for s in "LR"]]
        for n in ("foot", "toes")
    )
    return Clip(walk.rotations, walk.root, standing_feet(ankles, toes, 30.0), 30.0, LEG)


@pytest.mark.parametrize("fault", ["skates", "sinks", "floats", "too far apart", "none"])
def test_standing_feet_stand_still_on_the_floor(fault):
    clip, drift = standing_walk(), np.arange(60)[:, None]
    clip = {
        "skates": replace(clip, root=clip.root + drift * [0.004, 0.003, 0.0]),
        "sinks": replace(clip, root=clip.root - [0.0, 0.0, 0.06]),
        "floats": replace(clip, root=clip.root + [0.0, 0.0, 0.05]),
        "too far apart": replace(clip, root=clip.root * [1.0, 1.15, 1.0]),
        "none": clip,
    }[fault]
    planted = plant(clip, BASE)
    assert foot_slide_cm(planted, BASE) < 0.05  # 1 cm is allowed
    low, high = foot_heights_cm(planted, BASE)
    assert low > -0.05 and high < 0.05
    assert pose_exact(BASE, planted.rotations, planted.root)[..., 2].min() > -1e-3
    legs = [BASE.joint_names.index(f"{n}.{s}") for n in ("thigh", "calf", "toes") for s in "LR"]
    others = [j for j in range(len(BASE.joint_names)) if j not in legs]
    np.testing.assert_array_equal(planted.rotations[:, others], clip.rotations[:, others])
    np.testing.assert_array_equal(planted.root[:, :2], clip.root[:, :2])
    np.testing.assert_allclose(
        planted.rotations @ planted.rotations.swapaxes(2, 3), np.eye(3) + 0 * planted.rotations, atol=1e-9
    )


def test_planting_is_smooth():
    clip = standing_walk()
    skating = replace(clip, root=clip.root + np.arange(60)[:, None] * [0.004, 0.003, 0.0])
    for c, allowed in ((clip, 1.3), (skating, 1.6)):
        before, after = (
            np.diff(pose_exact(BASE, x.rotations, x.root), n=2, axis=0) * 900 for x in (clip, plant(c, BASE))
        )
        assert np.linalg.norm(after, axis=-1).max() < allowed * np.linalg.norm(before, axis=-1).max()


def test_planting_again_changes_little():
    once = plant(standing_walk(), BASE)
    twice = plant(once, BASE)
    np.testing.assert_allclose(twice.root, once.root, atol=1e-3)
    assert (
        np.abs(pose_exact(BASE, twice.rotations, twice.root) - pose_exact(BASE, once.rotations, once.root)).max()
        < 0.006
    )


@pytest.mark.parametrize("body", ["heavy", "slim"])
def test_another_body_is_planted_by_its_own_legs(body):
    other = load_body(body, "small")
    planted = plant(standing_walk(), other)
    assert planted.leg == rest_leg(other, "L").reach
    assert foot_slide_cm(planted, other) < 0.05 and max(map(abs, foot_heights_cm(planted, other))) < 0.05


def test_a_clip_that_never_stands_only_stays_above_the_floor():
    clip = replace(standing_walk(20), standing=np.zeros((20, 2), bool))
    low = replace(clip, root=clip.root - [0, 0, 0.1])
    for c in (clip, low):
        assert pose_exact(BASE, plant(c, BASE).rotations, plant(c, BASE).root)[..., 2].min() > -1e-3


def test_contacts_of_a_foot_whose_path_is_known():
    """A foot that stands for a second, goes half a metre ahead in half a second, 10 cm high, and stands again."""
    u = np.clip((np.arange(75) - 30) / 15, 0, 1)
    ankle = np.stack([0 * u, -0.5 * u * u * (3 - 2 * u), 0.08 + 0.1 * np.sin(np.pi * u) ** 2], axis=1)
    standing = standing_feet(np.stack([ankle, ankle + [0.2, 0.0, 0.3]], axis=1), None, 30.0)
    assert standing[:30].all() and standing[47:].all() and not standing[33:43].any()
    held = np.tile([[0.0, 0.0, 0.08]], (75, 1))  # one rests, the other swings to and fro at 1 m/s
    swing = held + np.sin(2 * np.pi * np.arange(75) / 30)[:, None] * [0.0, 0.3, 0.0]
    flat = flat_feet(np.stack([held, swing], axis=1), None, 30.0)
    assert flat[:, 0].all() and flat[:, 1].mean() < 0.3


def test_arms_inside_the_body_are_counted():
    rest = Clip(
        np.tile(np.eye(3), (10, len(BASE.joint_names), 1, 1)),
        np.tile(BASE.joints[0], (10, 1)),
        np.ones((10, 2), bool),
        30.0,
        LEG,
    )
    assert arms_inside(rest, BASE) == 0
    inward = rest.rotations.copy()
    bend = np.array(
        [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    )  # from straight out to straight down and inward
    inward[:4, [BASE.joint_names.index(f"{n}.L") for n in ("upper_arm", "fore_arm", "hand")]] = bend
    assert arms_inside(replace(rest, rotations=inward), BASE) == pytest.approx(0.4)
