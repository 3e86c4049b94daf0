"""The constant rotations between a recording's bones and ours, whatever its rest pose is.

For each of our bones two directions are looked for that mean the same on both skeletons: where the bone points, and how
it is twisted (the hinge of the elbow or knee; the line between the shoulders; the sole). In the recording each
direction is averaged in the frame of its own joint, which takes rest poses of any kind: T, A, or bones along x (Rokoko,
Maya). With F a joint's two directions as a frame at rest and R its world rotation: R_ours F_ours = R_theirs F_theirs.

Limbs and hinges are averaged over the motion. How trunk, shoulders, head and hands are held against each other, and
where a sole is, is taken from the recording's rest pose if that is a person standing; else the mean of the motion (of
soles: while they are flat on the ground) counts as ours at rest.
"""

import numpy as np

from garmentbench.importing.motions.recording import Recording, world
from garmentbench.importing.motions.skeleton import Upright
from garmentbench.motion.legs import unit
from garmentbench.scenes.bodies import BakedBody

Points = dict[str, np.ndarray]  # our joint -> positions of the recording's (or our) joint, each shape (N, 3)
_LIMBS = ("upper_arm", "fore_arm", "thigh", "calf")
_STRAIGHT = 0.05  # weight of where a hinge is by anatomy, against where the bend is (1: at a right angle)
_UP = np.array([0.0, 0.0, 1.0])


def calibrate(upright: Upright, flat: np.ndarray, baked: BakedBody) -> dict[str, np.ndarray]:
    """The rotations C of R_ours = R_theirs C, for each of our bones that the recording has.

    Args:
        upright: The recording in our axes and size.
        flat: Is the left, right foot flat on the ground? Shape (T, 2), bool.
        baked: Our body.

    Returns:
        Our joint -> C, shape (3, 3).
    """
    at_rest = {name: baked.joints[None, i] for i, name in enumerate(baked.joint_names)}
    moving, rest = (_points(r, upright.joints) for r in (upright.recording, upright.rest))
    stands = _stands(rest[1])
    out = {}
    for name in upright.joints:
        bone, _, side = name.partition(".")
        if bone == "toes":
            continue
        rotations, points = rest if stands and bone not in _LIMBS else moving
        theirs = np.stack([rotations[name].swapaxes(1, 2) @ d[..., None] for d in directions(name, points)])[..., 0]
        if bone == "foot" and not stands and flat[:, "LR".index(side)].any():
            theirs = theirs[:, flat[:, "LR".index(side)]]
        ours = directions(name, at_rest)
        out[name] = _frame(*theirs.sum(axis=1)) @ _frame(*ours[:, 0]).T
    return out


def directions(name: str, p: Points) -> np.ndarray:
    """The two directions of one of our bones, in world axes, not of length 1; shape (2, N, 3)."""
    bone, _, side = name.partition(".")
    hips, shoulders = p["thigh.L"] - p["thigh.R"], p["upper_arm.L"] - p["upper_arm.R"]
    trunk = (p["upper_arm.L"] + p["upper_arm.R"] - p["thigh.L"] - p["thigh.R"]) / 2
    if bone in ("upper_arm", "fore_arm", "hand"):
        upper, fore = p[f"fore_arm.{side}"] - p[f"upper_arm.{side}"], p[f"hand.{side}"] - p[f"fore_arm.{side}"]
        hinge = _hinge(upper, fore, np.cross(shoulders, trunk))
        return np.stack([upper if bone == "upper_arm" else fore, hinge])
    if bone in ("thigh", "calf"):
        thigh, calf = p[f"calf.{side}"] - p[f"thigh.{side}"], p[f"foot.{side}"] - p[f"calf.{side}"]
        return np.stack([thigh if bone == "thigh" else calf, _hinge(thigh, calf, -np.cross(hips, trunk))])
    if bone == "foot":
        ahead = p[f"toes.{side}"] - p[f"foot.{side}"] if f"toes.{side}" in p else np.cross(hips, _UP)
        return np.stack([np.broadcast_to(_UP, ahead.shape), ahead])
    return np.stack([hips if bone == "pelvis" else shoulders, trunk])


def _hinge(upper: np.ndarray, lower: np.ndarray, bends_to: np.ndarray) -> np.ndarray:
    """The axis about which a joint bends, longer the more it is bent; of a straight one, by where it would bend to."""
    upper = unit(upper)
    return np.cross(upper, unit(lower)) + _STRAIGHT * np.cross(upper, unit(bends_to))


def _points(recording: Recording, joints: dict[str, int]) -> tuple[Points, Points]:
    """World rotations and positions by our joints' names."""
    rotations, positions = world(recording)
    return {n: rotations[:, i] for n, i in joints.items()}, {n: positions[:, i] for n, i in joints.items()}


def _stands(p: Points) -> bool:
    """Is a pose (one frame) a person who stands straight and faces any way?"""
    hips, shoulders = (unit(p[f"{n}.L"] - p[f"{n}.R"])[0] for n in ("thigh", "upper_arm"))
    spine = unit(p["upper_arm.L"] + p["upper_arm.R"] - p["thigh.L"] - p["thigh.R"])[0]
    legs = [unit(p[f"thigh.{s}"] - p[f"foot.{s}"])[0] for s in "LR"]
    return bool(spine[2] > 0.9 and min(leg[2] for leg in legs) > 0.85 and hips @ shoulders > 0.9)


def _frame(primary: np.ndarray, secondary: np.ndarray) -> np.ndarray:
    """Columns: along `primary`, along `secondary` as far as it is across, and across both; shape (3, 3)."""
    first = unit(primary)
    second = unit(secondary - (secondary @ first) * first)
    return np.stack([first, second, np.cross(first, second)], axis=1)
