"""Trunk and arms: from the channels of a bearing to the rotations of their bones."""

import numpy as np
from scipy.spatial.transform import Rotation

from garmentbench.motion.legs import unit
from garmentbench.motion.notation import FullBearing
from garmentbench.scenes.bodies import BakedBody

# How far each bone of the trunk has turned from the pelvis' attitude (0) to the chest's (1).
_TRUNK = {"pelvis": 0.0, "spine": 0.2, "waist": 0.6, "chest": 1.0, "neck": 0.8, "clavicle.L": 1.0, "clavicle.R": 1.0}
_SHRUG = 0.35  # the collar bone rises by so much of what the arm is raised beyond ...
_SHRUGS_AT = 55.0  # ... this [degrees]


def bear_trunk(
    baked: BakedBody, bearing: FullBearing, heading: np.ndarray, dressed: np.ndarray, rotations: np.ndarray
) -> None:
    """Fill in the trunk's bones and the head. heading [rad], dressed: shape (T,); rotations: (T, J, 3, 3)."""
    pelvis = np.stack([bearing["turn"], bearing["list"], bearing["tilt"]], axis=1)
    chest = np.stack([bearing["twist"], -bearing["bend"], bearing["lean"]], axis=1)
    facing = Rotation.from_euler("z", heading[:, None])

    def attitude(angles: np.ndarray) -> np.ndarray:
        return (facing * Rotation.from_euler("ZYX", dressed[:, None] * angles, degrees=True)).as_matrix()

    for name, share in _TRUNK.items():
        rotations[:, baked.joint_names.index(name)] = attitude(pelvis + share * (chest - pelvis))
    head = np.stack([0.3 * bearing["twist"] + bearing["look"], -0.3 * bearing["bend"], 0.3 * bearing["lean"]], axis=1)
    rotations[:, baked.joint_names.index("head")] = attitude(head)


def bear_arm(baked: BakedBody, bearing: FullBearing, side: str, dressed: np.ndarray, rotations: np.ndarray) -> None:
    """Fill in an arm's bones; the chest's must be there. dressed: shape (T,); rotations: (T, J, 3, 3)."""
    out = 1.0 if side == "L" else -1.0
    joint = {name: baked.joint_names.index(f"{name}.{side}") for name in ("clavicle", "upper_arm", "fore_arm", "hand")}
    upper, fore = (
        unit(baked.joints[joint[end]] - baked.joints[joint[start]])
        for start, end in (("upper_arm", "fore_arm"), ("fore_arm", "hand"))
    )
    space, swing, roll, elbow = (bearing[f"{name}.{side}"] for name in ("space", "swing", "roll", "elbow"))
    chest = Rotation.from_matrix(rotations[:, baked.joint_names.index("chest")])
    hanging = Rotation.align_vectors([[0.0, 0.0, -1.0]], [upper])[0]
    raised = _about("x", -swing) * _about("y", -out * space) * _about("z", out * roll) * hanging
    arm = chest * Rotation.from_rotvec(dressed[:, None] * raised.as_rotvec())
    height = np.degrees(np.arccos(np.clip(-raised.apply(upper)[:, 2], -1.0, 1.0)))  # off the hanging line
    shrug = _SHRUG * 10.0 * np.logaddexp(0.0, (height - _SHRUGS_AT) / 10.0)  # a smooth max(0, ...)
    rotations[:, joint["clavicle"]] = (chest * _about("y", -out * dressed * shrug)).as_matrix()
    rotations[:, joint["upper_arm"]] = arm.as_matrix()
    bend = np.radians(elbow) - np.arccos(np.dot(upper, fore))
    lower = arm * Rotation.from_rotvec((dressed * bend)[:, None] * unit(np.cross(upper, fore)))
    rotations[:, joint["fore_arm"]] = rotations[:, joint["hand"]] = lower.as_matrix()


def _about(axis: str, degrees: np.ndarray) -> Rotation:
    return Rotation.from_euler(axis, degrees[:, None], degrees=True)
