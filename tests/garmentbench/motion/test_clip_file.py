"""The clip's file: a round trip, and files that are damaged or another's."""

import io
import zipfile
from dataclasses import replace

import bvh_example
import numpy as np
import pytest

from garmentbench.errors import UserError
from garmentbench.motion.clip import Clip, save_clip
from garmentbench.motion.clip_animation import load_clip
from garmentbench.motion.legs import rest_leg
from garmentbench.motion.planting import plant
from garmentbench.scenes.bodies import load_body

BASE = load_body("base", "small")


@pytest.fixture(scope="module")
def clip() -> Clip:
    walk = bvh_example.own_walk(BASE, 12)
    return Clip(walk.rotations, walk.root, np.ones((12, 2), bool), 30.0, rest_leg(BASE, "L").reach)


def load(path, fps: float = 30.0, **part) -> Clip:
    return load_clip(path, BASE, fps, **part)


def test_round_trip(tmp_path, clip):
    flying = plant(replace(clip, standing=np.zeros((12, 2), bool), root=clip.root + [0, 0, 0.3]), BASE)
    save_clip(flying, BASE.joint_names, "a walk", tmp_path / "clip.npz")
    again = load(tmp_path / "clip.npz")
    np.testing.assert_allclose(again.rotations, flying.rotations, atol=1e-5)
    np.testing.assert_allclose(again.root, flying.root, atol=1e-6)
    assert len(load(tmp_path / "clip.npz", fps=60.0)) == 23
    assert len(load(tmp_path / "clip.npz", start=0.1, stop=0.2)) == 4
    with np.load(tmp_path / "clip.npz") as arrays:
        assert str(arrays["notes"]) == "a walk" and tuple(arrays["joint_names"]) == BASE.joint_names


def test_frame_between_frames(clip):
    half = clip.at(np.array([0.5, 3.0]), 30.0)
    np.testing.assert_allclose(half.root[0], (clip.root[0] + clip.root[1]) / 2)
    np.testing.assert_allclose(half.rotations[1], clip.rotations[3], atol=1e-12)
    there = clip.rotations[0].swapaxes(1, 2) @ half.rotations[0]
    np.testing.assert_allclose(clip.rotations[0] @ there @ there, clip.rotations[1], atol=1e-9)


def test_cut_off_anywhere_is_one_line(tmp_path, clip):
    save_clip(clip, BASE.joint_names, "", tmp_path / "clip.npz")
    data = (tmp_path / "clip.npz").read_bytes()
    for length in [*range(0, 200, 7), *range(200, len(data), 397), len(data) - 1]:
        (tmp_path / "cut.npz").write_bytes(data[:length])
        with pytest.raises(UserError) as error:
            load(tmp_path / "cut.npz")
        assert "\n" not in str(error.value) and "cut.npz" in str(error.value)


def test_noise_is_one_line_or_a_clip(tmp_path, clip):
    save_clip(clip, BASE.joint_names, "", tmp_path / "clip.npz")
    data = np.frombuffer((tmp_path / "clip.npz").read_bytes(), np.uint8)
    rng = np.random.default_rng(0)
    for _ in range(60):
        noisy = data.copy()
        noisy[rng.integers(0, len(data), 4)] ^= rng.integers(1, 256, 4, dtype=np.uint8)
        (tmp_path / "noisy.npz").write_bytes(noisy.tobytes())
        try:
            assert np.isfinite(load(tmp_path / "noisy.npz").root).all()
        except UserError as e:
            assert "\n" not in str(e)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"rotations": None}, "its array 'rotations' is missing"),
        ({"root": np.zeros((3, 3))}, "'rotations' has shape"),
        ({"root": np.full((12, 3), np.nan)}, "'root' is not finite"),
        ({"root": np.array(["text"] * 12)}, "'root' is missing or wrong"),
        ({"joint_names": np.array(["pelvis"])}, "joints are not the body's"),
        ({"fps": np.array(0.0)}, "0 frames a second"),
        ({"leg": np.array(-1.0)}, "legs of -1 m"),
    ],
)
def test_what_is_wrong_in_it(tmp_path, clip, change, complaint):
    save_clip(clip, BASE.joint_names, "", tmp_path / "clip.npz")
    with np.load(tmp_path / "clip.npz") as arrays:
        changed = {k: v for k, v in ({**arrays} | change).items() if v is not None}
    np.savez(tmp_path / "changed.npz", **changed)
    with pytest.raises(UserError, match=complaint):
        load(tmp_path / "changed.npz")


def test_pickles_and_huge_claims_are_refused(tmp_path):
    np.savez(tmp_path / "pickled.npz", poses=np.array([{}], dtype=object))
    with pytest.raises(UserError, match="damaged, or no .npz file"):
        load(tmp_path / "pickled.npz")
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": (10**10, 3)})
    with zipfile.ZipFile(tmp_path / "huge.npz", "w") as archive:
        archive.writestr("poses.npy", header.getvalue())
    with pytest.raises(UserError, match="claims 240000000000 bytes in a file of"):
        load(tmp_path / "huge.npz")


def test_other_files(tmp_path):
    (tmp_path / "walk.bvh").write_text("x")
    np.savez(tmp_path / "amass.npz", poses=np.zeros((4, 72)), trans=np.zeros((4, 3)))
    for name, complaint in (
        ("walk.bvh", "not a clip .*garmentbench import-motion .*walk.bvh --out .*walk.npz"),
        ("amass.npz", "not a clip; make one of the recording"),
        ("none.npz", "no such file"),
    ):
        with pytest.raises(UserError, match=complaint):
            load(tmp_path / name)
