"""The ASF/AMC reader against forward kinematics done by hand, and against files that are broken."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from garmentbench.cli import main
from garmentbench.errors import UserError
from garmentbench.importing.motions.acclaim import read_amc
from garmentbench.importing.motions.recording import world

ASF = """# made by hand
:version 1.10
:units
  mass 1.0
  length 0.45
  angle deg
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name thigh
     direction 0 -2 0
     length 3
     axis 0 0 90 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-60.0 70.0)
  end
  begin
     id 2
     name shin
     direction 0 -1 0
     length 2
     axis 0 0 0 XYZ
    dof rx
  end
:hierarchy
  begin
    root thigh
    thigh shin
  end
"""
AMC = """#!OML:ASF
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 0 0 0
thigh 0 0 0
shin 0
2
root 1 2 3 0 90 0
thigh 90 0 0
shin 90
"""


def written(folder: Path, amc: str = AMC, asf: str = ASF, skeleton: str = "07.asf") -> Path:
    (folder / skeleton).write_text(asf)
    (folder / "07_01.amc").write_text(amc)
    return folder / "07_01.amc"


def test_joints_and_frames_as_worked_out_by_hand(tmp_path):
    recording = read_amc(written(tmp_path), 120.0)
    assert recording.names == ("root", "thigh", "shin", "shin end") and list(recording.parents) == [-1, 0, 1, 2]
    assert recording.fps == 120 and len(recording) == 2 and recording.notes[0].startswith("skeleton: 07.asf; 120")
    _, positions = world(recording)
    np.testing.assert_allclose(positions[0], [[1, 2, 3], [1, 2, 3], [1, -1, 3], [1, -3, 3]], atol=1e-12)
    # The thigh's own x is the world's y at rest: turning about it leaves the thigh where it hangs, and turns the shin's
    # plane with it, from its swing towards -z (90 degrees about x of a bone along -y) to -x; the root's 90 degrees
    # about y take -x to z.
    np.testing.assert_allclose(positions[1], [[1, 2, 3], [1, 2, 3], [1, -1, 3], [1, -1, 5]], atol=1e-12)


def test_angles_are_about_fixed_axes_and_may_be_radians(tmp_path):
    amc = AMC.replace("thigh 90 0 0", "thigh 20 30 40").replace("root 1 2 3 0 90 0", "root 1 2 3 10 0 -50")
    recording = read_amc(written(tmp_path, amc), 60.0)
    axes = Rotation.from_euler("z", 90, degrees=True).as_matrix()

    def turned(x: float, y: float, z: float) -> np.ndarray:
        each = [
            Rotation.from_euler(axis, angle, degrees=True).as_matrix()
            for axis, angle in zip("xyz", (x, y, z), strict=True)
        ]
        return each[2] @ each[1] @ each[0]

    np.testing.assert_allclose(recording.rotations[1, 0], turned(10, 0, -50), atol=1e-12)
    np.testing.assert_allclose(recording.rotations[1, 1], axes @ turned(20, 30, 40) @ axes.T, atol=1e-12)
    lines = []
    for name, *numbers in (line.split() for line in amc.splitlines()):
        moves = numbers[:3] if name == "root" else []
        angles = [f"{np.radians(float(x)):.15g}" for x in numbers[len(moves) :]]
        lines.append(" ".join([name, *moves, *angles]))
    radians = "\n".join(lines).replace(":DEGREES", ":RADIANS")
    np.testing.assert_allclose(read_amc(written(tmp_path, radians), 60.0).rotations, recording.rotations, atol=1e-9)


@pytest.mark.parametrize("change", [
    lambda t: t.replace("\n", "\r\n"), lambda t: "\ufeff" + t, lambda t: t.replace("\nshin", "  # a note\nshin"),
])  # fmt: skip
def test_what_others_read_is_read(tmp_path, change):
    plain = read_amc(written(tmp_path), 120.0)
    other = read_amc(written(tmp_path, change(AMC), change(ASF)), 120.0)
    np.testing.assert_array_equal(other.rotations, plain.rotations)


@pytest.mark.parametrize("skeleton", ["07.asf", "07_01.asf", "07.ASF", "somebody.asf"])
def test_the_skeleton_is_found_beside_it(tmp_path, skeleton):
    assert len(read_amc(written(tmp_path, skeleton=skeleton), 120.0)) == 2


@pytest.mark.parametrize(
    ("amc", "asf", "complaint"),
    [
        (("shin 90\n", ""), None, "07_01.amc: frame 2 has nothing of 'shin': cut off, or of another skeleton"),
        (("shin 90", "shin x"), None, "'x' where 1 numbers of 'shin' in frame 2 should be"),
        (("shin 90", "shin"), None, "'' where 1 numbers of 'shin' in frame 2"),
        (("thigh 90 0 0", "thigh 90 nan 0"), None, "'90 nan 0' where 3 numbers of 'thigh'"),
        (("shin 90", "arm 90"), None, "'arm 90' in frame 2, of no bone of the skeleton"),
        (("\n1\n", "\n"), None, "'root 1 2 3 0 0 0' before the first frame"),
        ((AMC, ":DEGREES\n"), None, "has no frames"),
        (None, (":bonedata", ":bones"), "07.asf: no ASF skeleton, or cut off: :bonedata is missing"),
        (None, ("    thigh shin\n", ""), "bone 'shin' doesn't hang from the root"),
        (None, ("dof rx\n", "dof rx tx\n"), "degrees of freedom 'rx tx', wanted rx, ry, rz"),
        (None, ("order TX TY TZ RX RY RZ", "order TX TY TZ"), "the root's order is 'tx ty tz'"),
        (None, ("name shin", "name thigh"), "two bones are called 'thigh'"),
        (None, ("length 2\n", "length two\n"), "'two' where the length of bone 'shin'"),
        (None, ("     length 2\n", ""), "bone 'shin' has no name, direction or length"),
        (None, ("axis 0 0 90 XYZ", "axis 0 0 90 XXZ"), "the axis of bone 'thigh' is of order 'xxz'"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(tmp_path, amc, asf, complaint):
    texts = [text if pair is None else text.replace(*pair) for text, pair in ((AMC, amc), (ASF, asf))]
    assert texts != [AMC, ASF]
    with pytest.raises(UserError) as error:
        read_amc(written(tmp_path, *texts), 120.0)
    assert complaint in str(error.value) and "\n" not in str(error.value) and str(tmp_path) in str(error.value)


def test_what_is_missing_is_named(tmp_path, capsys):
    path = written(tmp_path)
    with pytest.raises(UserError, match=r"07_01.amc: says no frame rate; give --recording-fps"):
        read_amc(path)
    with pytest.raises(UserError, match=r"07.asf: a skeleton without motion; name the motion beside it"):
        read_amc(tmp_path / "07.asf")
    (tmp_path / "07.asf").unlink()
    assert main(["import-motion", str(path), "--recording-fps", "120"]) == 1
    assert "its skeleton is not beside it; put 07_01.asf or 07.asf there" in capsys.readouterr().err


def test_noise_ends_in_a_line_or_a_recording(tmp_path):
    """Bytes changed at random, and files cut off anywhere, in either file."""
    rng, refused = np.random.default_rng(0), 0
    for k in range(600):
        data = [np.frombuffer(text.encode(), np.uint8).copy() for text in (AMC, ASF)]
        which = data[k % 2]
        if k % 3:
            which[rng.integers(0, len(which), 3)] = rng.integers(0, 256, 3)
        else:
            data[k % 2] = which[: rng.integers(0, len(which))]
        path = written(tmp_path)
        path.write_bytes(data[0].tobytes())
        (tmp_path / "07.asf").write_bytes(data[1].tobytes())
        try:
            assert np.isfinite(world(read_amc(path, 120.0))[1]).all()
        except UserError as e:
            refused += 1
            assert "\n" not in str(e)
    assert refused > 200
