"""From a recorded skeleton to our body: bone directions and twists are taken over, paths scaled by the legs' length."""

import numpy as np
from scipy.spatial.transform import Rotation

from garmentbench.importing.motions.calibrate import calibrate
from garmentbench.importing.motions.contacts import flat_feet, standing_feet, standing_height
from garmentbench.importing.motions.recording import world
from garmentbench.importing.motions.skeleton import Upright
from garmentbench.motion.clip import Clip
from garmentbench.motion.legs import rest_leg
from garmentbench.scenes.bodies import BakedBody

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
    ankles, toes = (_pair(positions, joints, name) for name in ("foot", "toes"))
    standing = standing_feet(ankles, toes, recording.fps)
    flat = flat_feet(ankles, toes, recording.fps)
    constant = calibrate(upright, np.where(flat.any(axis=0), flat, standing), baked)
    ours = np.empty((len(recording), len(baked.joint_names), 3, 3))
    for i, name in enumerate(baked.joint_names):
        parent = baked.parents[i]
        ours[:, i] = rotations[:, joints[name]] @ constant[name] if name in constant else ours[:, max(parent, 0)]
    _bend_spine(baked, ours)
    root = _root(baked, ours, _pair(positions, joints, "thigh").mean(axis=1), standing_height(ankles, standing).min())
    return Clip(ours, root, standing, recording.fps, rest_leg(baked, "L").reach)


def _pair(positions: np.ndarray, joints: dict[str, int], name: str) -> np.ndarray | None:
    """Positions of a left and right joint, shape (T, 2, 3); None where the recording has none."""
    pair = [joints.get(f"{name}.{side}") for side in "LR"]
    return None if None in pair else positions[:, pair]


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
