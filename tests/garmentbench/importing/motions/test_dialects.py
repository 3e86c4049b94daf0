"""BVH and AMASS as other programs write them.

Roots below roots, left hands, more rows, rounded times, names, faults cut off.
"""

from dataclasses import replace
from pathlib import Path

import bvh_example
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from garmentbench.cli import main
from garmentbench.errors import UserError
from garmentbench.importing.motions.bvh import read_bvh
from garmentbench.importing.motions.findings import findings
from garmentbench.importing.motions.load import Choices, ImportedClip, import_clip
from garmentbench.importing.motions.names import ROLES, map_names
from garmentbench.importing.motions.recording import world
from garmentbench.scenes.bodies import load_body

BASE = load_body("base", "small")


def written(folder: Path, text: str | bytes, name: str = "walk.bvh") -> Path:
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def imported(path: Path, **choices) -> ImportedClip:
    return import_clip(path, BASE, 30.0, Choices(**choices))


def walk(frames: int = 40) -> bvh_example.Moving:
    return bvh_example.y_up(bvh_example.own_walk(BASE, frames))


def jump(frames: int = 60) -> bvh_example.Moving:
    """Up by 40 cm and down again, in T-pose."""
    moving = bvh_example.t_pose(frames)
    moving.root[:, 1] += 40 * np.sin(np.pi * np.clip(np.arange(frames) - 20, 0, 20) / 20)
    return moving


def below_an_armature(text: str, armature: str = "0 0 0  0 0 0", above: str = "") -> str:
    """The same with its root hung below a still one."""
    head, motion = text.split("MOTION\n")
    head = head.replace("HIERARCHY\nROOT ", "JOINT ")
    root = "ROOT Armature\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
    frames, time, *rows = motion.splitlines()
    rows = [f"{armature} {row}" for row in rows]
    return "HIERARCHY\n" + root + above + head + "}\nMOTION\n" + "\n".join([frames, time, *rows]) + "\n"


@pytest.mark.parametrize("armature", ["0 0 0  0 0 0", "50 10 -20  0 0 0", "0 0 0  0 -90 0"])
def test_hips_below_a_still_root_keep_their_path(tmp_path, armature):
    plain = imported(written(tmp_path, jump().text()))
    below = imported(written(tmp_path, below_an_armature(jump().text(), armature)))
    np.testing.assert_allclose(below.clip.from_origin(0).root, plain.clip.from_origin(0).root, atol=1e-6)
    np.testing.assert_allclose(below.clip.rotations, plain.clip.rotations, atol=1e-6)
    assert np.ptp(below.clip.root[:, 2]) > 0.38
    assert "root: 'Hips', whose path is its own, below 'Armature'" in list(findings(below, BASE))


def test_hips_below_a_root_that_moves_are_where_bvhio_has_them(tmp_path):
    """Both move and turn; a prop beside the hips is left out by name."""
    bvhio = pytest.importorskip("bvhio")
    rows, prop = walk(30).text(), "JOINT Prop\n{\nOFFSET 5 0 0\nCHANNELS 0\nEnd Site\n{\nOFFSET 1 0 0\n}\n}\n"
    text = below_an_armature(rows, above=prop)
    head, motion = text.split("MOTION\n")
    frames, time, *lines = motion.splitlines()
    moved = [f"{k} 0 {2 * k} 0 0 {3 * k}" + row.removeprefix("0 0 0  0 0 0") for k, row in enumerate(lines)]
    path = written(tmp_path, head + "MOTION\n" + "\n".join([frames, time, *moved]) + "\n")
    recording = read_bvh(path)
    assert recording.names[0] == "Hips" and "left out beside it: Prop" in recording.notes[0]
    _, positions = world(recording)
    hierarchy = bvhio.readAsHierarchy(str(path))
    for frame in (0, 17, 29):
        hierarchy.loadPose(frame)
        theirs = {joint.Name: np.array(joint.PositionWorld) for joint, _, _ in hierarchy.layout()}
        for name in ("Hips", "LeftFoot", "RightHand"):
            np.testing.assert_allclose(
                positions[frame, recording.names.index(name)], theirs[name], atol=1e-3
            )  # of some 400, in single precision


def test_bones_that_stretch_are_named(tmp_path):
    moving = walk(20)
    text = moving.text().replace(
        "CHANNELS 3", "CHANNELS 6 Xposition Yposition Zposition", 1
    )  # of the first joint below
    head, motion = text.split("MOTION\n")
    rows = [line.split() for line in motion.splitlines()[2:]]
    rows = [row[:6] + ["0", f"{10 + k % 5}", "0"] + row[6:] for k, row in enumerate(rows)]
    body = "\n".join(motion.splitlines()[:2] + [" ".join(row) for row in rows])
    assert "change a bone's length" in read_bvh(written(tmp_path, f"{head}MOTION\n{body}\n")).notes[0]


def test_a_left_handed_recording_is_mirrored_with_a_word(tmp_path):
    moving, flip = walk(), np.diag([-1.0, 1.0, 1.0])
    left = replace(
        moving, joints=moving.joints @ flip, rotations=flip @ moving.rotations @ flip, root=moving.root @ flip
    )
    plain = imported(written(tmp_path, moving.text()))
    mirrored = imported(written(tmp_path, left.text()))
    assert mirrored.upright.mirrored is True and plain.upright.mirrored is False
    np.testing.assert_allclose(mirrored.clip.rotations, plain.clip.rotations, atol=1e-6)
    assert any("mirrored" in line for line in findings(mirrored, BASE))
    assert not any("handedness" in line for line in findings(plain, BASE))


def test_where_nothing_tells_the_hand_is_said_to_be_assumed(tmp_path):
    stiff = bvh_example.t_pose(10)
    keep = [i for i, name in enumerate(stiff.names) if not name.endswith("ToeBase")]
    number = {old: new for new, old in enumerate(keep)}
    stiff = bvh_example.Moving(
        [stiff.names[i] for i in keep],
        np.array([number.get(int(stiff.parents[i]), -1) for i in keep]),
        stiff.joints[keep],
        stiff.rotations[:, keep],
        stiff.root,
    )
    found = imported(written(tmp_path, stiff.text()))
    assert found.upright.mirrored is None
    assert any("right-handed axes assumed" in line for line in findings(found, BASE))


@pytest.mark.parametrize(
    "change",
    [
        lambda t: "\ufeff" + t,
        lambda t: t.replace("End Site", "END SITE"),
        lambda t: t.replace("End Site", "end site").replace("JOINT", "Joint").replace("OFFSET", "Offset"),
        lambda t: t.replace("Xrotation", "XROTATION").replace("Frames:", "FRAMES:"),
        lambda t: t.replace("MOTION", "MOTION  # of our own walk").replace("Frame Time:", "Frame time:"),
        lambda t: t.replace("\n", "\r\n"),
        lambda t: t.replace("\n}", "  // here\n}"),
        lambda t: t.encode("utf-16-le"),
    ],
)
def test_what_others_read_is_read(tmp_path, change):
    text = walk(12).text()
    plain, other = read_bvh(written(tmp_path, text)), read_bvh(written(tmp_path, change(text), "other.bvh"))
    assert change(text) != text and other.names == plain.names and other.notes == ()
    np.testing.assert_array_equal(other.rotations, plain.rotations)
    assert len(read_bvh(written(tmp_path, text.encode("utf-16"), "utf16.bvh"))) == 12


def test_more_rows_than_frames_are_read_and_said(tmp_path):
    text = walk(12).text()
    more = read_bvh(written(tmp_path, text.replace("Frames: 12", "Frames: 11")))
    assert len(more) == 12 and more.notes == ("12 rows where 'Frames:' says 11: all of them read",)
    with pytest.raises(UserError, match="cut off, or the hierarchy is another's"):  # half rows are no rows
        read_bvh(written(tmp_path, text.replace("Frames: 12", "Frames: 11").rstrip().rsplit(" ", 1)[0]))


def test_fewer_rows_are_read_with_a_warning_if_they_are_whole(tmp_path):
    text = walk(12).text().replace("Frames: 12", "Frames: 13").rstrip("\n") + "\n"
    fewer = read_bvh(written(tmp_path, text))
    assert len(fewer) == 12 and fewer.notes[0].startswith("warning: 12 rows where 'Frames:' says 13: cut off behind")
    np.testing.assert_array_equal(fewer.root, read_bvh(written(tmp_path, walk(12).text(), "all.bvh")).root)
    for cut in (
        text.rstrip(),
        text.rstrip()[:-1],
        text.rstrip().rsplit(" ", 1)[0] + "\n",
    ):  # its last number may be cut
        with pytest.raises(UserError, match="cut off, or the hierarchy is another's"):
            read_bvh(written(tmp_path, cut))


@pytest.mark.parametrize(("rate", "odd"), [(1, True), (5, True), (15, False), (480, False), (1000, True)])
def test_a_rate_of_no_motion_capture_is_warned_of(tmp_path, rate, odd):
    text = walk(90).text().replace("Frame Time: 0.0333333333", f"Frame Time: {1 / rate:.9f}")
    lines = list(findings(import_clip(written(tmp_path, text), BASE, min(rate, 30), Choices()), BASE))
    warned = [line for line in lines if line.startswith("warning:") and "--recording-fps" in line and "no rate" in line]
    assert bool(warned) == odd


def test_amass_and_amc_at_an_odd_rate_too(tmp_path):
    turned, path = poses(40)
    np.savez(tmp_path / "slow.npz", poses=turned, trans=path, mocap_framerate=1.0)
    lines = list(findings(imported(tmp_path / "slow.npz"), BASE))
    assert any("1 frames a second is no rate of motion capture" in line for line in lines)


def test_a_held_pose_and_radians_are_told(tmp_path):
    text = walk(40).text()
    head, rows = text.split("Frame Time: 0.0333333333\n")
    held = head + "Frame Time: 0.0333333333\n" + (rows.splitlines()[0] + "\n") * 40
    assert "warning: nothing moves in it: one pose" in " ".join(findings(imported(written(tmp_path, held)), BASE))
    numbers = np.array([[float(word) for word in row.split()] for row in rows.splitlines()])
    numbers[:, 3:] = np.radians(numbers[:, 3:])
    small = "\n".join(" ".join(f"{x:.6f}" for x in row) for row in numbers)
    (note,) = read_bvh(written(tmp_path, f"{head}Frame Time: 0.0333333333\n{small}\n")).notes
    assert note.startswith("warning: no angle is above") and "are they radians?" in note
    assert read_bvh(written(tmp_path, text)).notes == ()
    with pytest.raises(UserError, match=r"frame time is 30 s; .* \(is it a rate, or milliseconds\?\); say"):
        read_bvh(written(tmp_path, text.replace("Frame Time: 0.0333333333", "Frame Time: 30")))


@pytest.mark.parametrize(("axis", "up"), [("z", "-x"), ("x", "z")])
def test_somebody_who_lies_is_not_stood_up_in_silence(tmp_path, axis, up):
    """The root rolled by 90 degrees: other axes, or somebody who lies; the file can't tell."""
    moving = walk(40)
    assert not any("stands along" in line for line in findings(imported(written(tmp_path, moving.text())), BASE))
    quarter = Rotation.from_euler(axis, 90, degrees=True).as_matrix()
    lying = replace(moving, rotations=quarter @ moving.rotations, root=moving.root @ quarter.T)
    lines = list(findings(imported(written(tmp_path, lying.text())), BASE))
    assert any(
        line.startswith(f"warning: the person stands along {up}, not y, as its rest pose does") for line in lines
    )


def test_parts_that_are_none_and_a_stop_beyond_the_end(tmp_path, capsys):
    path = written(tmp_path, walk(61).text())
    for start, stop, wanted in ((1.0, 1.01, "is less than one of 30 frames"), (1.0, 0.5, "from 1 to 0.5 s asked for")):
        with pytest.raises(UserError, match=wanted):
            imported(path, start=start, stop=stop)
    with pytest.raises(UserError, match="it has 0 to 2.00 s"):
        imported(path, start=9.0)
    assert main(["import-motion", str(path), "--stop", "99", "--out", str(tmp_path / "all.npz")]) == 0
    assert "stop: 99 s is beyond the recording's end: taken to its end, 2.00 s" in capsys.readouterr().out
    assert main(["import-motion", str(tmp_path / "all.npz"), "--start", "1", "--stop", "3"]) == 0
    out = capsys.readouterr().out
    assert "stop: 3 s is beyond" in out and "result: 31 frames" in out
    assert main(["import-motion", str(path), "--stop", "2"]) == 0 and "stop:" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("time", "rate"),
    [(".0333332", 30), (".0333333", 30), ("0.0333", 30), ("0.033", 30), ("0.04", 25), ("0.0417", 24), ("0.008333", 120),
     ("0.0083333", 120), ("0.008", 125), ("0.033367", 1 / 0.033367), ("0.016667", 60), ("3.3333e-2", 30)],
)  # fmt: skip
def test_rounded_frame_times_lose_no_frame(tmp_path, time, rate):
    text = bvh_example.t_pose(125).text()
    recording = read_bvh(written(tmp_path, text.replace("Frame Time: 0.0333333333", f"Frame Time: {time}")))
    assert recording.fps == pytest.approx(rate, rel=1e-9)
    if rate == 30:
        assert len(imported(tmp_path / "walk.bvh").clip) == 125


def test_a_wrong_rate_is_replaced(tmp_path):
    text = walk(40).text()
    path = written(tmp_path, text.replace("Frame Time: 0.0333333333", "Frame Time: 1"))
    found = imported(path, recording_fps=30.0)
    assert len(found.clip) == 40 and found.recording.fps == 30
    assert "30 frames a second, as --recording-fps says; the file says 1" in list(findings(found, BASE))
    with pytest.raises(UserError, match="--recording-fps"):
        imported(written(tmp_path, text.replace("Frame Time: 0.0333333333", "Frame Time: 0")))
    assert main(["import-motion", str(path), "--recording-fps", "0"]) == 2


def test_what_is_cut_off_decides_nothing(tmp_path):
    """A fall of 30 cm through the floor after two seconds."""
    moving = walk(90)
    broken = replace(moving, root=moving.root - 30 * (np.arange(90) >= 62)[:, None] * [0.0, 1.0, 0.0])
    cut = replace(moving, rotations=moving.rotations[:61], root=moving.root[:61])
    one = imported(written(tmp_path, broken.text()), stop=2.0)
    other = imported(written(tmp_path, cut.text()))
    np.testing.assert_allclose(one.clip.root, other.clip.root, atol=1e-6)
    np.testing.assert_array_equal(one.clip.standing, other.clip.standing)


def test_feet_that_never_stand_get_no_reassuring_number(tmp_path):
    flying = walk(40)
    flying.root = flying.root + np.arange(40)[:, None] * [0.0, 20.0, 0.0]  # up by 6 m/s
    lines = list(findings(imported(written(tmp_path, flying.text())), BASE))
    assert sum(line.startswith("warning: the") and "foot never stands" in line for line in lines) == 2
    assert not any(line.startswith("feet: slide") for line in lines)


BIPED = {
    "pelvis": "Pelvis", "chest": "Spine2", "waist": "Spine1", "spine": "Spine", "neck": "Neck", "head": "Head",
    "clavicle": "Clavicle", "upper_arm": "UpperArm", "fore_arm": "Forearm", "hand": "Hand", "thigh": "Thigh",
    "calf": "Calf", "foot": "Foot", "toes": "Toe0",
}  # fmt: skip
UNITY = BIPED | {
    "pelvis": "Hips", "chest": "Chest", "clavicle": "Shoulder", "fore_arm": "LowerArm", "thigh": "UpperLeg",
    "calf": "LowerLeg", "toes": "Toes",
}  # fmt: skip
BLENDER = {
    "pelvis": "hips", "chest": "chest", "clavicle": "shoulder", "upper_arm": "upper_arm", "fore_arm": "forearm",
    "hand": "hand", "thigh": "thigh", "calf": "shin", "foot": "foot", "toes": "toe", "neck": "neck", "head": "head",
    "waist": "spine1", "spine": "spine0",
}  # fmt: skip
MIXAMO = {key: name.replace("*", "") for key, name in bvh_example.MIXAMO.items()}
CHARACTER = BIPED | {
    "pelvis": "Hip",
    "chest": "Spine02",
    "upper_arm": "Upperarm",
    "neck": "NeckTwist01",
    "toes": "ToeBase",
}


@pytest.mark.parametrize(
    ("table", "sided", "start"),
    [
        (BIPED, "{side} {bone}", "Bip01 "), (BIPED, "{side}_{bone}", "Bip001_"), (BIPED, "{side}-{bone}", "Biped-"),
        (CHARACTER, "{side}_{bone}", "CC_Base_"), (MIXAMO, "{word}{bone}", "Character1_"),
        (MIXAMO, "{bone}_{side}", "mixamorig:"), (MIXAMO, "{side}_{bone}", ""), (MIXAMO, "{bone}.{side}", ""),
        (MIXAMO, "{bone}{word}", "Someone:"), (UNITY, "{bone}_{side}", ""), (UNITY, "{side}_{bone}", "J_Bip_"),
        (BLENDER, "{bone}.{side}", ""), (BLENDER, "{bone} {side}", ""), (BLENDER, "{bone}_{side}", "rig|"),
        (UNITY, "{low}_{bone}", ""),
    ],
)  # fmt: skip
def test_names_with_prefixes_and_sides_of_any_kind(table, sided, start):
    words = {"L": "Left", "R": "Right"}
    expected = {}
    for role in (*ROLES, "waist", "spine"):
        bone, _, side = role.partition(".")
        name = sided.format(side=side, low=side.lower(), word=words[side], bone=table[bone]) if side else table[bone]
        expected[role] = start + name
    found = map_names(tuple(expected.values()), {}, "x.bvh")
    assert found.joints == {role: name for role, name in expected.items() if role in ROLES}


@pytest.mark.parametrize(
    ("table", "sided", "start"),
    [(CHARACTER, "{side}_{bone}", "CC_Base_"), (BIPED, "{side} {bone}", "Bip01 "),
     (MIXAMO, "{word}{bone}", "Character1_"), (MIXAMO, "{word}{bone}", "mixamorig:"),
     (UNITY, "{side}_{bone}", ""), (UNITY, "{bone}_{side}", ""),
     (BLENDER, "{bone}.{side}", ""), (BLENDER, "{bone} {side}", "")],
)  # fmt: skip
def test_a_clip_of_other_names_is_the_same_clip(tmp_path, table, sided, start):
    """With end sites in capitals and a byte order mark, too."""
    plain, other = walk(), walk()
    words = {"L": "Left", "R": "Right"}
    for j, name in enumerate(BASE.joint_names):
        bone, _, side = name.partition(".")
        named = table.get(bone, bone)
        other.names[j] = start + (sided.format(side=side, word=words[side], bone=named) if side else named)
    one = imported(written(tmp_path, plain.text())).clip
    two = imported(written(tmp_path, "\ufeff" + other.text().replace("End Site", "END SITE"), "other.bvh")).clip
    for a, b in ((one.rotations, two.rotations), (one.root, two.root)):
        np.testing.assert_allclose(a, b, atol=1e-6)
    np.testing.assert_array_equal(one.standing, two.standing)


def test_a_hint_is_a_name_that_may_be_meant():
    names = (
        [n for n in bvh_example.t_pose().names if n != "LeftArm"]
        + ["LeftUpperArmTwist"]
        + [f"Finger{k}" for k in range(99)]
    )
    with pytest.raises(UserError) as error:
        map_names(tuple(names), {}, "x.bvh")
    assert "--map 'LeftUpperArmTwist=upper_arm.L'" in str(error.value)
    assert str(error.value).count("Finger") <= 10 and len(str(error.value)) < 600 and "\n" not in str(error.value)


def poses(frames: int = 12) -> tuple[np.ndarray, np.ndarray]:
    """SMPL's 24 joints in T-pose, stood up, the left shoulder lifting; and a path."""
    turned = np.zeros((frames, 24, 3))
    turned[:, 0] = Rotation.from_euler("x", 90, degrees=True).as_rotvec()
    turned[:, 16, 2] = np.linspace(0, 0.5, frames)
    return turned.reshape(frames, 72), np.tile([0.0, 0.0, 1.1], (frames, 1))


def test_amass_by_other_names_is_the_same(tmp_path):
    turned, path = poses()
    files = {
        "amass": {"poses": turned, "trans": path, "mocap_framerate": 30.0},
        "object": {"poses": turned, "trans": path, "mocap_framerate": 30.0, "labels": np.array([{"a": 1}], object),
                   "gender": np.array("female", object)},
        "split": {"root_orient": turned[:, :3], "pose_body": turned[:, 3:66], "trans": path, "mocap_frame_rate": 30.0},
        "aist": {"smpl_poses": turned.reshape(-1, 24, 3), "smpl_trans": 93.0 * path, "smpl_scaling": np.array([93.0])},
        "smplx": {"global_orient": turned[:, :3], "body_pose": turned[:, 3:66].reshape(-1, 21, 3), "transl": path},
    }  # fmt: skip
    clips = {}
    for name, arrays in files.items():
        np.savez(tmp_path / f"{name}.npz", **arrays)
        clips[name] = imported(
            tmp_path / f"{name}.npz", recording_fps=None if "mocap" in str(arrays.keys()) else 30.0
        ).clip
    for clip in clips.values():
        np.testing.assert_allclose(clip.rotations, clips["amass"].rotations, atol=1e-9)
    with pytest.raises(UserError, match="frame rate is missing.*--recording-fps"):
        imported(tmp_path / "aist.npz")
    np.savez(tmp_path / "matrices.npz", poses=np.tile(np.eye(3), (12, 24, 1, 1)), trans=path, mocap_framerate=30.0)
    np.savez(tmp_path / "quaternions.npz", poses=np.tile([1.0, 0, 0, 0], (12, 24, 1)), trans=path, mocap_framerate=30.0)
    for name in ("matrices", "quaternions"):
        with pytest.raises(UserError, match="its array 'poses' is missing or wrong; wanted poses .T, 66 or more."):
            imported(tmp_path / f"{name}.npz")
    np.savez(tmp_path / "none.npz", labels=np.zeros(3))
    with pytest.raises(UserError, match="'poses' is missing .*wanted poses"):
        imported(tmp_path / "none.npz")
