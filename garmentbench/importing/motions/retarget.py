"""From a recorded skeleton to our body: bone directions and twists are taken over, paths scaled by the legs' length;
and when a foot stands on the ground, seen from how high and how fast ankle and toes are."""

import numpy as np
from scipy.ndimage import binary_closing, binary_opening
from scipy.spatial.transform import Rotation

from garmentbench.importing.motions.calibrate import calibrate
from garmentbench.importing.motions.recording import world
from garmentbench.importing.motions.skeleton import Upright
from garmentbench.motion.clip import Clip
from garmentbench.motion.legs import rest_leg
from garmentbench.scenes.bodies import BakedBody

_SLOW = 0.35  # [m/s]
_REST = 0.15  # [m/s] of ankle and toes while a foot is flat; in rolling one of them is faster
_LOW = 0.05  # above the height at which it stands [m]
_SHORTEST = 0.1  # of a contact, and of a gap between two [s]


def standing_feet(ankles: np.ndarray, toes: np.ndarray | None, fps: float) -> np.ndarray:
    """Contact phases.

    Args:
        ankles: Left and right ankle [m, of a body of our size], shape (T, 2, 3).
        toes: Left and right toes; None where the recording has none.
        fps: Frames a second.

    Returns:
        Is the left, right foot on the ground? Shape (T, 2), bool.
    """
    points = [ankles] if toes is None else [ankles, toes]
    still = np.any([_still(p, fps, _SLOW) for p in points], axis=0)
    length = max(2, round(_SHORTEST * fps))
    window = np.ones((length, 1), bool)
    closed = binary_closing(np.pad(still, ((length, length), (0, 0)), mode="edge"), window)
    return binary_opening(closed, window)[length : len(closed) - length]


def flat_feet(ankles: np.ndarray, toes: np.ndarray | None, fps: float) -> np.ndarray:
    """When the whole foot is at rest on the ground, not rolling; as `standing_feet`."""
    points = [ankles] if toes is None else [ankles, toes]
    return np.all([_still(p, fps, _REST) for p in points], axis=0)


def _still(points: np.ndarray, fps: float, speed: float) -> np.ndarray:
    """Is a point slow, and near the height at which its slow moments are lowest? Shape (T, 2)."""
    slow = np.linalg.norm(np.gradient(points, 1 / fps, axis=0), axis=-1) < speed
    return slow & (points[..., 2] < standing_height(points, slow) + _LOW)


def standing_height(points: np.ndarray, standing: np.ndarray) -> np.ndarray:
    """The low end of the heights that a left and right point, shape (T, 2, 3), have while they stand [m], shape (2,).

    Each foot its own: in motion captured from video one may stand 20 cm above the other.
    """
    heights = np.where(standing | ~standing.any(axis=0), points[..., 2], np.nan)
    return np.nanpercentile(heights, 10, axis=0)


_SPINE = {"spine": 0.2, "waist": 0.6}  # how far each has turned from the pelvis (0) to the chest (1), as in walks


def retarget(upright: Upright, baked: BakedBody) -> Clip:
    """The recording's motion on our skeleton; the feet are not yet planted.

    Args:
        upright: The recording in our axes and size.
        baked: The body.

    Returns:
        The clip, at the recording's frame rate; where it is and which way it faces is the recording's matter.
    """
    recording, joints = upright.recording, upright.joints
    rotations, positions = world(recording)
    ankles, hips = (positions[:, [joints[f"{name}.L"], joints[f"{name}.R"]]] for name in ("foot", "thigh"))
    toes = _pair(positions, joints, "toes")
    standing = standing_feet(ankles, toes, recording.fps)
    flat = flat_feet(ankles, toes, recording.fps)
    constant = calibrate(upright, np.where(flat.any(axis=0), flat, standing), baked)
    ours = np.empty((len(recording), len(baked.joint_names), 3, 3))
    for i, name in enumerate(baked.joint_names):
        parent = baked.parents[i]
        ours[:, i] = rotations[:, joints[name]] @ constant[name] if name in constant else ours[:, max(parent, 0)]
    _bend_spine(baked, ours)
    root = _root(baked, ours, hips.mean(axis=1), standing_height(ankles, standing).min())
    return Clip(ours, root, standing, recording.fps, rest_leg(baked, "L").reach)


def _pair(positions: np.ndarray, joints: dict[str, int], name: str) -> np.ndarray | None:
    """Positions of a left and right joint, shape (T, 2, 3); None where the recording has none."""
    pair = [joints[f"{name}.{side}"] for side in "LR" if f"{name}.{side}" in joints]
    return positions[:, pair] if len(pair) == 2 else None


def _bend_spine(baked: BakedBody, rotations: np.ndarray) -> None:
    """Spread the bend from the pelvis to the chest over the bones in between."""
    pelvis, chest = (Rotation.from_matrix(rotations[:, baked.joint_names.index(n)]) for n in ("pelvis", "chest"))
    bend = (pelvis.inv() * chest).as_rotvec()
    for name, share in _SPINE.items():
        rotations[:, baked.joint_names.index(name)] = (pelvis * Rotation.from_rotvec(share * bend)).as_matrix()


def _root(baked: BakedBody, rotations: np.ndarray, hips: np.ndarray, floor: float) -> np.ndarray:
    """Path of the pelvis joint, from the path of the middle of the recording's hips."""
    joints = dict(zip(baked.joint_names, baked.joints, strict=True))
    middle = (joints["thigh.L"] + joints["thigh.R"]) / 2 - joints["pelvis"]
    root = hips - rotations[:, 0] @ middle
    return root - [0.0, 0.0, floor - joints["foot.L"][2]]
