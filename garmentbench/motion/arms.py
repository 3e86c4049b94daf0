"""Holding the arms of somebody of another build off our torso."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from garmentbench.motion.clip import Clip
from garmentbench.motion.easing import smoothstep
from garmentbench.scenes.bodies import BakedBody

_HANGING = (0.0, 0.5)  # cosine of the arm against straight down: from where on it is turned, and turned in full


def turn_out(clip: Clip, degrees: float, baked: BakedBody) -> Clip:
    """The arms turned outward about the chest's forward axis; less the more they are raised, not at all from the
    horizontal on."""
    rotations = clip.rotations.copy()
    chest = rotations[:, baked.joint_names.index("chest")]
    for side, sign in (("L", -1.0), ("R", 1.0)):
        arm, fore, hand = (baked.joint_names.index(f"{name}.{side}") for name in ("upper_arm", "fore_arm", "hand"))
        bone = baked.joints[fore] - baked.joints[arm]
        down = -np.sum((rotations[:, arm] @ bone) * chest[..., 2], axis=1) / np.linalg.norm(bone)
        share = smoothstep((down - _HANGING[0]) / (_HANGING[1] - _HANGING[0]))
        out = Rotation.from_rotvec(sign * np.radians(degrees) * share[:, None] * chest[..., 1]).as_matrix()
        rotations[:, [arm, fore, hand]] = out[:, None] @ rotations[:, [arm, fore, hand]]
    return replace(clip, rotations=rotations)
