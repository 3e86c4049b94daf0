"""AMASS's npz: known rotations give known directions on our body; files that are wrong; the way to SMPL's own body."""

import pickle

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from garmentbench.errors import UserError
from garmentbench.importing.motions.load import Choices, import_clip
from garmentbench.importing.motions.smplx_body import _split, write_own_body
from garmentbench.motion.legs import unit
from garmentbench.scenes.bodies import joint_positions, load_body

BASE = load_body("base", "small")
STAND = Rotation.from_euler("x", 90, degrees=True).as_rotvec()  # SMPL's y-up T-pose stood up in AMASS's z-up world
LEFT_SHOULDER, LEFT_ELBOW, RIGHT_KNEE = 16, 18, 5


def amass(frames: int = 8, width: int = 156, **arrays) -> dict[str, np.ndarray]:
    poses = np.zeros((frames, width))
    poses[:, :3] = STAND
    trans = np.tile([0.3, 0.1, 1.1], (frames, 1))
    return {
        "poses": poses,
        "trans": trans,
        "betas": np.zeros(16),
        "gender": np.array("neutral"),
        "mocap_framerate": np.array(60.0),
    } | arrays


def clip_of(folder, arrays, **choices):
    np.savez(folder / "amass.npz", **arrays)
    return import_clip(folder / "amass.npz", BASE, 30.0, Choices(**choices))


def bone(clip, start: str, end: str) -> np.ndarray:
    places = joint_positions(BASE, clip.rotations, clip.root)
    return unit(places[0, BASE.joint_names.index(end)] - places[0, BASE.joint_names.index(start)])


def test_zero_rotations_are_a_t_pose_that_stands(tmp_path):
    found = clip_of(tmp_path, amass())
    assert found.names.convention == "SMPL" and found.upright.up == "z" and found.upright.unit == "metres"
    assert len(found.clip) == 4 and found.clip.standing.all()  # 8 frames at 60 a second
    np.testing.assert_allclose(bone(found.clip, "upper_arm.L", "hand.L"), [1, 0, 0], atol=0.1)
    np.testing.assert_allclose(bone(found.clip, "chest", "neck"), [0, 0, 1], atol=0.2)
    assert bone(found.clip, "foot.R", "toes.R")[1] < -0.9


@pytest.mark.parametrize(
    ("joint", "rotvec", "start", "end", "direction"),
    [
        (LEFT_SHOULDER, (0, 0, -np.pi / 2), "upper_arm.L", "fore_arm.L", (0, 0, -1)),
        (LEFT_ELBOW, (0, -np.pi / 2, 0), "fore_arm.L", "hand.L", (0, -1, 0)),
        (RIGHT_KNEE, (np.pi / 3, 0, 0), "calf.R", "foot.R", (0, np.sin(np.pi / 3), -0.5)),
        (0, (0, 0, np.pi / 2), "upper_arm.L", "fore_arm.L", (0, 1, 0)),
    ],
)
def test_known_rotations(tmp_path, joint, rotvec, start, end, direction):
    arrays = amass()
    if joint == 0:  # the whole body a quarter to its left, about the world's vertical
        arrays["poses"][:, :3] = (Rotation.from_rotvec(rotvec) * Rotation.from_rotvec(STAND)).as_rotvec()
    else:
        arrays["poses"][:, 3 * joint : 3 * joint + 3] = rotvec
    np.testing.assert_allclose(bone(clip_of(tmp_path, arrays).unplanted, start, end), direction, atol=0.12)


def test_a_bend_that_never_ends_is_kept(tmp_path):
    """The trunk is compared with the T-pose, not with its own mean."""
    arrays = amass()
    arrays["poses"][:, 27:30] = [0.6, 0.0, 0.0]  # spine3, ahead
    clip = clip_of(tmp_path, arrays).unplanted
    pelvis, chest = (clip.rotations[0, BASE.joint_names.index(n)] for n in ("pelvis", "chest"))
    np.testing.assert_allclose(Rotation.from_matrix(pelvis.T @ chest).as_rotvec(), [0.6, 0, 0], atol=1e-6)


@pytest.mark.parametrize("width", [165, 156, 72, 66])
def test_smpl_x_smpl_h_and_smpl_are_read_by_their_body_joints(tmp_path, width):
    """SMPL-X: jaw and eyes stand before the hands' joints, behind the body's; all of them are wild here."""
    arrays = amass(8, width, surface_model_type=np.array("smplx"))
    arrays["poses"][:, 66:] = np.random.default_rng(0).normal(size=(8, width - 66))
    arrays["poses"][:, 3 * LEFT_ELBOW : 3 * LEFT_ELBOW + 3] = [0, -np.pi / 2, 0]
    clip = clip_of(tmp_path, arrays).unplanted
    np.testing.assert_allclose(bone(clip, "fore_arm.L", "hand.L"), [0, -1, 0], atol=0.12)
    np.testing.assert_allclose(bone(clip, "upper_arm.R", "fore_arm.R"), [-1, 0, 0], atol=0.12)


def test_smpl_x_poses_are_split_as_its_model_takes_them():
    """AMASS-X: root, 21 joints, jaw, two eyes, 15 joints of each hand: 165 values (amass, README: SMPL-X)."""
    pose = np.arange(165.0)[None]
    parts = _split(pose, "smplx")
    bounds = {"global_orient": (0, 3), "body_pose": (3, 66), "jaw_pose": (66, 69), "leye_pose": (69, 72),
              "reye_pose": (72, 75), "left_hand_pose": (75, 120), "right_hand_pose": (120, 165)}  # fmt: skip
    assert {name: (x[0, 0], x[0, -1] + 1) for name, x in parts.items() if name != "expression"} == bounds


@pytest.mark.parametrize("scale", [180 / np.pi, 100.0])
def test_degrees_are_no_radians(tmp_path, scale):
    """A knee bent by 60 degrees; a root may turn often."""
    arrays = amass()
    arrays["poses"][:, :3] = [0, 0, 40.0]
    arrays["poses"][:, 3 * RIGHT_KNEE] = np.pi / 3
    with pytest.raises(UserError, match="no axis is up"):
        clip_of(tmp_path, arrays)
    arrays["poses"][:, 3:66] *= scale
    with pytest.raises(
        UserError, match=r"poses turns a joint by \d+, wanted axis-angle in radians .*degrees, or Euler"
    ):
        clip_of(tmp_path, arrays)


def test_path_is_scaled_by_the_legs(tmp_path):
    arrays = amass(61)
    arrays["trans"][:, 1] -= np.linspace(0, 1, 61)
    root = clip_of(tmp_path, arrays).unplanted.root
    assert 1.0 < root[0, 1] - root[-1, 1] < 1.3  # SMPL's legs are about 0.79 m, ours 0.90 m


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"poses": None}, "'poses' is missing"),
        ({"trans": None}, "'trans' is missing"),
        ({"mocap_framerate": None}, "frame rate is missing"),
        ({"mocap_framerate": np.array(-60.0)}, "frame rate is -60"),
        ({"mocap_framerate": np.array("fast")}, "frame rate is fast"),
        ({"poses": np.zeros((8, 63))}, r"poses \(8, 63\)"),
        ({"trans": np.zeros((7, 3))}, r"trans \(7, 3\)"),
        ({"poses": np.zeros((0, 156)), "trans": np.zeros((0, 3))}, r"poses \(0, 156\)"),
        ({"poses": np.full((8, 156), np.inf)}, "'poses' is not finite"),
        ({"poses": np.full((8, 156), "x")}, "'poses' is missing or wrong"),
    ],
)
def test_what_is_wrong_is_told(tmp_path, change, complaint):
    arrays = {k: v for k, v in (amass() | change).items() if v is not None}
    with pytest.raises(UserError, match=complaint) as error:
        clip_of(tmp_path, arrays)
    assert "\n" not in str(error.value)


def test_advice_without_the_package_and_without_model_files(tmp_path, monkeypatch):
    np.savez(tmp_path / "a.npz", **amass())
    monkeypatch.setitem(__import__("sys").modules, "smplx", None)
    with pytest.raises(UserError, match="pip install smplx, and get the model files from https"):
        write_own_body(tmp_path / "a.npz", tmp_path, 30.0, tmp_path / "out.npz")


def test_smpl_moves_its_own_body(tmp_path):
    """With the real package, on a model of SMPL's format whose vertices are made up.

    They follow `trans`, at 30 of 60 frames.
    """
    pytest.importorskip("smplx", reason="pip install smplx (its licence is its own) to test SMPL's own body")
    arrays = amass()
    arrays["trans"][:, 0] = np.arange(8)
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(UserError, match="SMPL_NEUTRAL.pkl: no such file"):
        write_own_body(tmp_path / "a.npz", tmp_path, 30.0, tmp_path / "out.npz")
    made_up = _made_up_model()
    (tmp_path / "smpl").mkdir()
    (tmp_path / "smpl" / "SMPL_NEUTRAL.pkl").write_bytes(pickle.dumps(made_up))
    said = write_own_body(tmp_path / "a.npz", tmp_path, 30.0, tmp_path / "out.npz")
    assert "4 frames of 6890 vertices at 30 a second, smpl model" in said
    with np.load(tmp_path / "out.npz") as out:
        stood = made_up["v_template"] @ Rotation.from_rotvec(STAND).as_matrix().T
        np.testing.assert_allclose(out["positions"][3], stood + arrays["trans"][6], atol=1e-5)
        np.testing.assert_array_equal(out["faces"], made_up["f"])


def _made_up_model() -> dict[str, np.ndarray]:
    """Arrays of the shapes that SMPL's file has; all joints are at the origin, so that the root turns about it."""
    rng = np.random.default_rng(0)
    parents = np.array([-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19, 20, 21])
    return {
        "v_template": rng.normal(size=(6890, 3)),
        "f": np.arange(30, dtype=np.uint32).reshape(10, 3),
        "shapedirs": np.zeros((6890, 3, 10)),
        "posedirs": np.zeros((6890, 3, 207), np.float32),
        "J_regressor": np.zeros((24, 6890)),
        "weights": np.eye(24)[rng.integers(0, 24, 6890)],
        "kintree_table": np.stack([parents, np.arange(24)]),
    }
