"""Clips of CMU's database and a Rokoko capture.

What is guessed of them, planted feet, and two conversions of one take.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from garmentbench.errors import UserError
from garmentbench.importing.motions.bvh import read_bvh
from garmentbench.importing.motions.findings import arms_inside, arms_line, findings, foot_heights_cm, foot_slide_cm
from garmentbench.importing.motions.load import Choices, ImportedClip, import_clip
from garmentbench.motion.clip import Clip
from garmentbench.motion.legs import unit
from garmentbench.paths import PACKAGE
from garmentbench.scenes.bodies import joint_positions, load_body

MOCAP = PACKAGE.parents[1] / "shared" / "data" / "mocap"
BASE = load_body("base", "small")
CLIPS = {  # what they are known to be: convention, unit, frames at 30 a second, person's height [m]
    "05_20-mb": ("CMU for MotionBuilder", "CMU's 5.64 cm", 274, 1.67),
    "05_20-daz": ("CMU for Daz", "centimetres", 273, 1.68),
    "131_01": ("CMU for 3ds Max", "CMU's 5.64 cm", 249, 1.63),
    "jesse_dance": ("Mixamo", "centimetres", 302, 1.76),
    "salsa_10": ("CMU for Daz", "centimetres", 299, 1.68),
    "35_01": ("CMU as captured", "CMU's 5.64 cm", 90, 1.78),  # ASF and AMC
}
pytestmark = pytest.mark.skipif(
    not (MOCAP / "131_01.bvh").is_file(), reason="the recordings in ../shared/data/mocap are not there"
)


@cache
def loaded(name: str, arm_space: float = 0.0) -> ImportedClip:
    amc = MOCAP / f"{name}.amc"
    rate = 120.0 if amc.is_file() else None
    file = amc if rate else MOCAP / f"{name}.bvh"
    return import_clip(file, BASE, 30.0, Choices(arm_space=arm_space, recording_fps=rate))


@pytest.mark.parametrize("name", CLIPS)
def test_what_is_found_and_made_of_it(name):
    found = loaded(name)
    convention, unit_name, frames, height = CLIPS[name]
    assert (found.names.convention, found.upright.unit, found.upright.up, len(found.clip)) == (
        convention,
        unit_name,
        "y",
        frames,
    )
    assert found.upright.height == pytest.approx(height, abs=0.02)
    assert foot_slide_cm(found.clip, BASE) < 0.05 < 0.5 < foot_slide_cm(found.unplanted, BASE)
    assert found.upright.mirrored is False
    low, high = foot_heights_cm(found.clip, BASE)
    assert low > -0.05 and high < 0.05
    assert all("\n" not in line for line in findings(found, BASE))


def test_every_clip_of_the_folder_is_read():
    """Of an AMC the ASF beside it is a part."""
    there = {p.stem for p in MOCAP.iterdir() if p.suffix in (".bvh", ".amc")}
    assert there == set(CLIPS) and {p.suffix for p in MOCAP.iterdir()} == {".bvh", ".amc", ".asf", ".md"}


def test_a_rest_pose_of_no_person_says_nothing_of_up_and_feet_that_hardly_stand_are_told():
    """Rokoko's bones all lie along x at rest; this clip, from video, floats."""
    lines = list(findings(loaded("jesse_dance"), BASE))
    assert not any("stands along" in line for line in lines)
    assert sum("foot hardly stands (in" in line for line in lines) == 2
    assert any(line.startswith("warning: uneven: the left foot stands 14 cm below") for line in lines)


def test_a_walk_of_cmu_s_is_a_walk():
    """35_01, "walk": 3 s at a walking pace, on one foot or both, arms down, looking ahead."""
    clip = loaded("35_01").clip.from_origin(0)
    speed = np.linalg.norm(clip.root[-1, :2] - clip.root[0, :2]) / (len(clip) / clip.fps)
    assert (
        0.9 < speed < 1.7 and clip.root[-1, 1] < -2.5 and abs(clip.root[-1, 0]) < 0.8
    )  # pelvis turned by 8 degrees in frame 0
    assert clip.standing.any(axis=1).mean() > 0.75 and clip.standing.all(axis=1).mean() < 0.4
    for side in "LR":
        assert bones(clip)[f"upper_arm.{side}"][:, 2].max() < -0.8


def bones(clip: Clip) -> dict[str, np.ndarray]:
    """Directions of limbs and trunk, shape (T, 3)."""
    place = joint_positions(BASE, clip.rotations, clip.root)
    ends = {
        j: [k for k, p in enumerate(BASE.parents) if p == j][-1]
        for j in range(1, len(BASE.parents))
        if j in BASE.parents
    }
    return {BASE.joint_names[j]: unit(place[:, k] - place[:, j]) for j, k in ends.items()}


def test_two_conversions_of_one_take_agree():
    """Other skeletons, units, rest poses, channel orders; the arms' T-poses differ by 4 degrees, the feet's by 6."""
    mb, daz = (loaded(f"05_20-{kind}").clip for kind in ("mb", "daz"))
    mb, daz = mb.from_origin(1).frames(1, 274), daz.from_origin(0)  # one left out 1 row of 120 a second, the other 5
    theirs = bones(daz)
    for name, ours in bones(mb).items():
        angle = np.degrees(np.arccos(np.clip(np.sum(ours * theirs[name], axis=1), -1, 1)))
        assert np.median(angle) < 8, name
    places = [joint_positions(BASE, c.rotations, c.root) for c in (mb, daz)]
    assert np.linalg.norm(places[0] - places[1], axis=-1).mean() < 0.05


def test_arm_space_takes_arms_out_of_the_torso():
    assert arms_inside(loaded("salsa_10").clip, BASE) > 0.5 > 0.1 > arms_inside(loaded("salsa_10", 20.0).clip, BASE)


def test_advice_that_was_followed_is_not_repeated():
    """N10: arms still inside after --arm-space are not answered with --arm-space."""
    assert "--arm-space 10 turns hanging arms outward" in arms_line(12.0, 0.0)
    assert "--arm-space 10 turns" not in arms_line(12.0, 5.0) and "more than that" in arms_line(12.0, 5.0)
    assert "turns" not in arms_line(12.0, 30.0)


def test_real_files_cut_off_are_refused(tmp_path: Path):
    data = (MOCAP / "131_01.bvh").read_bytes()
    rng = np.random.default_rng(0)
    for length in rng.integers(0, len(data) - 10, 15):
        (tmp_path / "cut.bvh").write_bytes(data[:length])
        with pytest.raises(UserError):
            read_bvh(tmp_path / "cut.bvh")
