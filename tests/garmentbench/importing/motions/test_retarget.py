"""Retargeting: our own walk through a BVH file and back, whatever its unit, axes and bone frames; known poses.

Names.
"""

from pathlib import Path

import bvh_example
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from garmentbench.errors import UsageError, UserError
from garmentbench.importing.motions.load import Choices, ImportedClip, import_clip
from garmentbench.importing.motions.names import map_names
from garmentbench.motion.legs import unit
from garmentbench.scenes.bodies import joint_positions, load_body

BASE = load_body("base", "small")


def loaded(
    folder: Path, moving: bvh_example.Moving, prefix: str = "", fps: float = 30.0, body=BASE, **choices
) -> ImportedClip:
    path = folder / "clip.bvh"
    path.write_text(moving.text(prefix=prefix))
    return import_clip(path, body, fps, Choices(**choices))


def bone(clip, start: str, end: str) -> np.ndarray:
    """Directions of one of our bones, shape (T, 3)."""
    places = joint_positions(BASE, clip.rotations, clip.root)
    return unit(places[:, BASE.joint_names.index(end)] - places[:, BASE.joint_names.index(start)])


def same_walk(walk: bvh_example.Moving, clip, names: list[str], degrees: float) -> None:
    indices = [BASE.joint_names.index(n) for n in names]
    turned = Rotation.from_matrix(
        (clip.rotations[:, indices].swapaxes(2, 3) @ walk.rotations[:, indices]).reshape(-1, 3, 3)
    )
    worst = np.degrees(turned.magnitude()).reshape(-1, len(names)).max(axis=0)
    assert worst.max() < degrees, dict(zip(names, worst.round(1), strict=True))


@pytest.mark.parametrize("way", ["z up, metres", "y up, centimetres", "inches, prefix", "y up, other bone frames"])
def test_our_walk_comes_back(tmp_path, way):
    """Arms, trunk and feet to a tenth of a degree, legs but for the twist about their own length; planting, which this
    walk needs least of all, moves the ankles by less than 2.5 cm."""
    walk = bvh_example.own_walk(BASE, 60)
    file = {
        "z up, metres": walk,
        "y up, centimetres": bvh_example.y_up(walk),
        "inches, prefix": bvh_example.y_up(walk, 1 / 0.0254),
        "y up, other bone frames": bvh_example.other_bone_frames(bvh_example.y_up(walk)),
    }[way]
    found = loaded(tmp_path, file, "mixamorig:" if "prefix" in way else "")
    assert len(found.clip) == 60 and found.names.convention == "Mixamo"
    unit_name = (
        "metres" if way[-6:] == "metres" and "centi" not in way else "inches" if "inches" in way else "centimetres"
    )
    assert (found.upright.unit, found.upright.up) == (unit_name, "z" if way.startswith("z") else "y")
    assert found.upright.height == pytest.approx(np.ptp(BASE.body.rest[:, 2]), rel=0.01)
    arms = [f"{n}.{s}" for n in ("upper_arm", "fore_arm", "foot") for s in "LR"]
    same_walk(walk, found.unplanted, arms, 0.2)
    same_walk(
        walk, found.unplanted, ["pelvis", "chest"], 2.0 if "bone frames" in way else 0.1
    )  # how they hang is a mean then
    same_walk(walk, found.unplanted, [f"{n}.{s}" for n in ("thigh", "calf") for s in "LR"], 2.0)
    moved = found.clip.root - found.clip.root[0] - (walk.root - walk.root[0])
    assert np.abs(moved).max() < 3e-3  # planting keeps a bend of 7 degrees in the knees, for which the hips come down
    ankles = [BASE.joint_names.index(f"foot.{side}") for side in "LR"]
    moved = [joint_positions(BASE, c.rotations, c.root)[:, ankles] - c.root[:1, None] for c in (found.clip, walk)]
    assert np.linalg.norm(moved[0] - moved[1], axis=-1).max() < 0.03
    np.testing.assert_array_less(found.clip.standing.mean(axis=0), 0.8)
    np.testing.assert_array_less(0.4, found.clip.standing.mean(axis=0))


def test_a_t_pose_holds_our_arms_out_and_stands(tmp_path):
    clip = loaded(tmp_path, bvh_example.t_pose()).clip
    for side, out in (("L", 1.0), ("R", -1.0)):
        np.testing.assert_allclose(bone(clip, f"upper_arm.{side}", f"fore_arm.{side}"), [[out, 0, 0]] * 4, atol=1e-6)
        np.testing.assert_allclose(bone(clip, f"fore_arm.{side}", f"hand.{side}"), [[out, 0, 0]] * 4, atol=1e-6)
        assert bone(clip, f"foot.{side}", f"toes.{side}")[0, 1] < -0.9  # toes ahead, towards -y
    for name in ("pelvis", "spine", "waist", "chest", "neck", "head", "clavicle.L", "foot.L", "foot.R"):
        rotation = Rotation.from_matrix(clip.rotations[0, BASE.joint_names.index(name)])
        assert np.degrees(rotation.magnitude()) < 6, (
            name
        )  # our feet point 6 degrees outward at rest, these straight ahead


@pytest.mark.parametrize(
    ("joint", "axis", "degrees", "start", "end", "direction"),
    [
        ("LeftArm", "z", -90, "upper_arm.L", "hand.L", (0, 0, -1)),  # in the file z is ahead: the arm comes down
        ("LeftArm", "y", -90, "upper_arm.L", "hand.L", (0, -1, 0)),  # about the file's up: ahead
        ("LeftForeArm", "y", -90, "fore_arm.L", "hand.L", (0, -1, 0)),
        ("RightLeg", "x", 60, "calf.R", "foot.R", (0, 0.866025404, -0.5)),  # the calf goes back
        ("Spine2", "x", 60, "chest", "neck", (0, -0.866, 0.5)),  # bent ahead
    ],
)
def test_a_known_rotation_gives_a_known_direction(tmp_path, joint, axis, degrees, start, end, direction):
    moving = bvh_example.t_pose()
    below = [moving.names.index(joint)]
    for i, parent in enumerate(moving.parents):
        below += [i] if parent in below else []
    moving.rotations[:, below] = Rotation.from_euler(axis, degrees, degrees=True).as_matrix()
    found = loaded(tmp_path, moving).unplanted
    at_rest = loaded(tmp_path, bvh_example.t_pose()).unplanted
    tolerance = 0.15 if joint == "Spine2" else 1e-6  # our neck is 6 degrees off the vertical at rest
    np.testing.assert_allclose(bone(found, start, end)[0], direction, atol=tolerance)
    if joint == "LeftForeArm":  # the elbow's hinge goes along: no twist from bending
        turned = (
            found.rotations[0, BASE.joint_names.index("upper_arm.L")].T
            @ at_rest.rotations[0, BASE.joint_names.index("upper_arm.L")]
        )
        assert np.degrees(Rotation.from_matrix(turned).magnitude()) < 1


def test_the_path_is_scaled_by_the_legs_and_starts_anywhere(tmp_path):
    walk = bvh_example.y_up(bvh_example.own_walk(BASE, 40))
    small = bvh_example.y_up(bvh_example.own_walk(BASE, 40), 60.0)  # a child of 1.1 m, if it is centimetres
    far = bvh_example.y_up(bvh_example.own_walk(BASE, 40))
    far.root = far.root + [1000.0, 0.0, -300.0]
    clips = [loaded(tmp_path, m).clip.from_origin(0) for m in (walk, small, far)]
    for clip in clips[1:]:
        np.testing.assert_allclose(clip.root, clips[0].root, atol=1e-5)


def test_frame_rates(tmp_path):
    fast = bvh_example.own_walk(BASE, 237, speed=0.25)  # at 120 a second
    fast.fps = 120.0
    clip = loaded(tmp_path, fast).clip
    slow = loaded(tmp_path, bvh_example.own_walk(BASE, 60)).clip
    assert len(clip) == 60 and clip.fps == 30
    same_walk(bvh_example.own_walk(BASE, 60), clip, ["upper_arm.L", "fore_arm.R", "chest"], 1.0)
    assert np.abs(clip.root - slow.root).max() < 0.01


def test_turned_clip_faces_ahead_over_the_origin(tmp_path):
    walk = bvh_example.own_walk(BASE, 30)
    turn = Rotation.from_euler("z", 130, degrees=True).as_matrix()
    walk.rotations, walk.root = turn @ walk.rotations, walk.root @ turn.T + [3.0, 2.0, 0.0]
    clip = loaded(tmp_path, walk).clip.from_origin(0)
    assert np.abs(clip.root[0, :2]).max() < 1e-9 and clip.rotations[0, 0, 1, 0] == pytest.approx(0, abs=1e-9)
    assert clip.root[-1, 1] < -0.8 and clip.rotations[0, 0, 0, 0] > 0.9


def test_a_rest_pose_before_the_motion_is_left_out(tmp_path):
    walk = bvh_example.y_up(bvh_example.own_walk(BASE, 100, speed=0.25))
    walk.fps = 120.0
    walk.rotations[0, :] = Rotation.from_euler("y", 100, degrees=True).as_matrix()
    assert loaded(tmp_path, walk).upright.dropped == 1
    assert loaded(tmp_path, bvh_example.y_up(bvh_example.own_walk(BASE, 40))).upright.dropped == 0


def test_arm_space_turns_hanging_arms_out_and_leaves_raised_ones(tmp_path):
    walk = bvh_example.own_walk(BASE, 30)
    plain, wide = (loaded(tmp_path, walk, arm_space=a).clip for a in (0.0, 10.0))
    for side, out in (("L", 1.0), ("R", -1.0)):
        angles = [
            np.degrees(np.arctan2(out * d[:, 0], -d[:, 2]))
            for d in (bone(c, f"upper_arm.{side}", f"fore_arm.{side}") for c in (plain, wide))
        ]
        np.testing.assert_allclose(angles[1] - angles[0], 10, atol=1.5)
    raised = bvh_example.t_pose()
    np.testing.assert_allclose(
        loaded(tmp_path, raised, arm_space=10.0).clip.rotations, loaded(tmp_path, raised).clip.rotations, atol=1e-9
    )


def test_part_of_a_recording(tmp_path):
    walk = bvh_example.own_walk(BASE, 61)
    part = loaded(tmp_path, walk, start=0.5, stop=1.0).unplanted
    np.testing.assert_allclose(part.rotations, loaded(tmp_path, walk).unplanted.rotations[15:31], atol=0.02)
    for start, stop in ((2.5, 3.0), (1.0, 1.0), (-1.0, 1.0)):
        with pytest.raises(UserError, match="it has 0 to 2.00 s"):
            loaded(tmp_path, walk, start=start, stop=stop)


def test_names_are_guessed_or_given(tmp_path):
    for prefix in ("mixamorig:", "mixamorig1:", "mixamorig_", "Armature|mixamorig:", ""):
        names = tuple(prefix + n for n in bvh_example.t_pose().names)
        found = map_names(names, {}, "x.bvh")
        assert found.convention == "Mixamo" and found.joints["chest"] == f"{prefix}Spine2"
    strange = bvh_example.t_pose()
    strange.names[strange.names.index("LeftArm")] = "Brachium"
    with pytest.raises(
        UserError, match="no joint found for upper_arm.L .* --map 'NAME=upper_arm.L'. Not yet used: .*Brachium"
    ):
        loaded(tmp_path, strange)
    found = loaded(tmp_path, strange, names={"Brachium": "upper_arm.L"})
    assert found.names.joints["upper_arm.L"] == "Brachium" and "upper_arm  Brachium | RightArm" in found.names.lines()
    with pytest.raises(UsageError, match="unknown joint of .*'Brachim': did you mean 'Brachium'"):
        loaded(tmp_path, strange, names={"Brachim": "upper_arm.L"})
    with pytest.raises(UsageError, match="unknown joint of the body 'upper_arm'"):
        loaded(tmp_path, strange, names={"Brachium": "upper_arm"})


@pytest.mark.parametrize("frames", [1, 2, 3])
def test_very_short_recordings(tmp_path, frames):
    if frames > 1:
        assert len(loaded(tmp_path, bvh_example.t_pose(frames)).clip) == frames
    for fps in (30.0, 9.0):
        if (frames - 1) * fps < 30:
            with pytest.raises(
                UserError, match=f"{frames} frames at 30 a second; wanted two or more at {fps:g} a second"
            ):
                loaded(tmp_path, bvh_example.t_pose(frames), fps=fps)


def test_skeletons_that_are_none(tmp_path):
    lying = bvh_example.t_pose()
    lying.rotations[:] = Rotation.from_euler("x", 45, degrees=True).as_matrix()
    with pytest.raises(UserError, match="no axis is up"):
        loaded(tmp_path, lying)
    point = bvh_example.t_pose()
    point.joints[:, 0] = point.joints[:, 2] = 0
    point.joints[:, 1] = [100 + 40 * n.startswith(("Spine", "Neck", "Head")) for n in point.names]
    with pytest.raises(UserError, match="thigh.L and calf.L are at one place"):
        loaded(tmp_path, point)
