"""The BVH reader against forward kinematics done by hand, and against files that are broken in every way."""

from pathlib import Path

import bvh_example
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from garmentbench.errors import UserError
from garmentbench.importing.motions.bvh import read_bvh
from garmentbench.importing.motions.recording import world
from garmentbench.scenes.bodies import joint_positions, load_body

ARM = """HIERARCHY
ROOT base
{
  OFFSET 7 7 7
  CHANNELS 6 Zposition Xposition Yposition Yrotation Zrotation Xrotation
  JOINT upper arm {
    OFFSET 0 2 0
    CHANNELS 2 Zrotation Xrotation
    JOINT hand
    {
      OFFSET 0 1 0
      CHANNELS 6 Xposition Yposition Zposition Xrotation Yrotation Zrotation
      End Site
      {
        OFFSET 1 0 0
      }
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.04
3 1 2   0 0 0    0 0   0 5 0  0 0 0
3 1 2   90 0 0   90 0  0 5 0  0 0 90
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "arm.bvh"
    path.write_text(text)
    return path


def test_joints_channels_and_frames_as_worked_out_by_hand(tmp_path):
    recording = read_bvh(written(tmp_path, ARM))
    assert recording.names == ("base", "upper arm", "hand", "hand end")
    assert list(recording.parents) == [-1, 0, 1, 2] and recording.fps == pytest.approx(25) and len(recording) == 2
    _, positions = world(recording)
    # The channels stand Z, X, Y, and take the place of the offsets, at the hand too (its 1 becomes 5).
    np.testing.assert_allclose(positions[0], [[1, 2, 3], [1, 4, 3], [1, 9, 3], [2, 9, 3]], atol=1e-12)
    # 90 degrees about z takes the upper arm's y to -x, which the base's 90 about y takes to z; the hand's own x
    # likewise, after its own 90 about z.
    np.testing.assert_allclose(positions[1], [[1, 2, 3], [1, 4, 3], [1, 4, 8], [1, 4, 9]], atol=1e-12)


@pytest.mark.parametrize("order", ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"])
def test_any_order_of_rotations(tmp_path, order):
    moving = bvh_example.t_pose(3)
    moving.rotations = Rotation.random(3 * len(moving.names), rng=1).as_matrix().reshape(moving.rotations.shape)
    rotations, _ = world(read_bvh(written(tmp_path, moving.text(order))))
    joints = [
        i for i, name in enumerate(read_bvh(written(tmp_path, moving.text(order))).names) if not name.endswith(" end")
    ]
    names = [read_bvh(tmp_path / "arm.bvh").names[i] for i in joints]
    np.testing.assert_allclose(
        rotations[:, joints], moving.rotations[:, [moving.names.index(n) for n in names]], atol=1e-7
    )


def test_what_is_written_of_our_walk_is_read(tmp_path):
    baked = load_body("base", "small")
    moving = bvh_example.own_walk(baked, 10)
    recording = read_bvh(written(tmp_path, moving.text()))
    _, positions = world(recording)
    ours = joint_positions(baked, moving.rotations, moving.root)
    np.testing.assert_allclose(positions[:, [recording.names.index(n) for n in moving.names]], ours, atol=1e-7)


def test_reads_as_bvhio_does(tmp_path):
    """Another library; it adds a root's offset, ours is 0."""
    bvhio = pytest.importorskip("bvhio", reason="pip install bvhio to compare with it")
    moving = bvh_example.own_walk(load_body("base", "small"), 5)
    path = written(tmp_path, moving.text("YXZ"))
    recording = read_bvh(path)
    _, positions = world(recording)
    root = bvhio.readAsHierarchy(str(path))
    for frame in range(5):
        root.loadPose(frame)
        theirs = {joint.Name: np.array(joint.PositionWorld) for joint, _, _ in root.layout()}
        for name, place in theirs.items():
            np.testing.assert_allclose(positions[frame, recording.names.index(name)], place, atol=2e-6)


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("HIERARCHY", "HIERARCHE", "HIERARCHY is missing"),
        ("MOTION", "MOTIO", "MOTION is missing"),
        ("ROOT", "JOINT", "'JOINT' where ROOT should be"),
        ("OFFSET 0 2 0", "OFFSET 0 two 0", "'two' where an offset of joint 'upper arm' should be"),
        ("OFFSET 0 2 0", "OFFSET 0 nan 0", "'nan' where an offset"),
        ("    OFFSET 0 2 0\n", "", "joint 'upper arm' has no OFFSET"),
        ("CHANNELS 2", "CHANNELS 3", "channel 'JOINT' of joint 'upper arm'"),
        ("CHANNELS 2 Zrotation", "CHANNELS 1 Zrotation", "'Xrotation' in joint 'upper arm'"),
        ("CHANNELS 2", "CHANNELS 9999999999", "has 1e+10 channels"),
        ("CHANNELS 2", "CHANNELS -1", "has -1 channels"),
        ("CHANNELS 2", "CHANNELS 1.5", "has 1.5 channels"),
        ("Zrotation Xrotation\n    JOINT", "Zrotation Zrotation\n    JOINT", "2 different ones"),
        ("Zrotation Xrotation\n    JOINT", "Zrotation Wrotation\n    JOINT", "'Wrotation'"),
        ("JOINT hand", "JOINT base", "two joints are called 'base'"),
        ("}\nMOTION", "}\n}\nMOTION", "after the root's last }"),
        ("Frames: 2", "Frames: 0", "0 frames; wanted at least one"),
        ("Frames: 2", "Frames: -2", "-2 frames"),
        ("Frames: 2", "Frames: two", "'two' where the number of frames should be"),
        ("Frames: 2", "Frames: 1000000", "28 numbers where 1000000 frames of 14 channels want 14000000: cut off"),
        ("Frames: 2", "Frames: 1e300", "28 numbers where"),
        ("Frame Time: 0.04", "Frame Time: -0.04", "frame time is -0.04 s"),
        ("Frame Time: 0.04", "Frame Time: 0", "frame time is 0 s"),
        ("Frame Time: 0.04", "Frame Time: 1e9", "frame time is 1e+09 s"),
        ("Frame Time: 0.04", "", "does not begin with 'Frames:' and 'Frame Time:'"),
        ("0 0 90\n", "0 0 x\n", "'x' in frame 1, where a number should be"),
        ("0 0 90\n", "0 0 inf\n", "'inf' in frame 1, where a number should be"),
        ("0 0 90\n", "0 0 90 1\n", "29 numbers where 2 frames of 14 channels want 28"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(tmp_path, old, new, complaint):
    assert ARM.count(old) >= 1
    with pytest.raises(UserError) as error:
        read_bvh(written(tmp_path, new.join(ARM.rsplit(old, 1))))
    assert complaint in str(error.value) and "\n" not in str(error.value) and "arm.bvh" in str(error.value)


def test_a_file_cut_off_anywhere_is_refused(tmp_path):
    complete = len(ARM.rstrip())
    for length in range(complete - 1):  # the last number itself may be cut from 90 to 9
        with pytest.raises(UserError):
            read_bvh(written(tmp_path, ARM[:length]))


def test_noise_ends_in_a_line_or_a_recording(tmp_path):
    """Bytes changed at random: nothing but a `UserError` or finite numbers comes out."""
    rng, path = np.random.default_rng(0), tmp_path / "noise.bvh"
    refused = 0
    for _ in range(400):
        data = np.frombuffer(ARM.encode(), np.uint8).copy()
        data[rng.integers(0, len(data), 3)] = rng.integers(0, 256, 3)
        path.write_bytes(data.tobytes())
        try:
            assert np.isfinite(world(read_bvh(path))[1]).all()
        except UserError as e:
            refused += 1
            assert "\n" not in str(e)
    assert refused > 100


def test_a_missing_file_is_told(tmp_path):
    with pytest.raises(UserError, match="can't be read"):
        read_bvh(tmp_path / "none.bvh")
