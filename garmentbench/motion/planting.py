"""Planting feet: while a foot stands it neither slides nor sinks, and it never goes through the floor (z = 0).

The lowest vertex of the sole is what touches the ground, as in the procedural walk: while the foot stands that vertex
stays where it is from one frame to the next, so a foot rolls from heel to ball. The ankle's path is moved by as much;
between two contacts the move changes smoothly. Thigh and calf follow by two-bone inverse kinematics, and where a leg is
too short the hips come down.
"""

from dataclasses import replace

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from garmentbench.motion.clip import Clip
from garmentbench.motion.easing import smoothstep
from garmentbench.motion.foot import pitch_up
from garmentbench.motion.legs import rest_leg, solve_leg, within
from garmentbench.scenes.bodies import BakedBody, joint_positions

_REACH = 0.998  # of a leg's length, at most
_SOFT = 0.004  # over which the floor takes over from the path of a foot in the air [m]
_TOES = np.radians(60)  # bend of the toes, at most
_FADE = 0.3  # [s] in which the speed of a correction fades out when a foot leaves the ground
_EASE = 0.1  # [s] over which hips come down and toes bend


def plant(clip: Clip, baked: BakedBody) -> Clip:
    """The clip with its feet planted, on a body with legs of any length."""
    clip = replace(clip, root=clip.root * (rest_leg(baked, "L").reach / clip.leg), leg=rest_leg(baked, "L").reach)
    width = max(_EASE * clip.fps, 1e-3)
    rotations = clip.rotations.copy()
    joints = {name: i for i, name in enumerate(baked.joint_names)}
    joint = joint_positions(baked, rotations, clip.root)
    ankles = np.empty((2, len(clip), 3))
    for k, side in enumerate("LR"):
        foot, toes = joints[f"foot.{side}"], joints[f"toes.{side}"]
        stands = gaussian_filter1d(clip.standing[:, k].astype(float), width / 2, mode="nearest")
        pitch = np.arcsin(np.clip(-rotations[:, foot, 2, 1], -1.0, 1.0))
        rotations[:, toes] = rotations[:, foot] @ pitch_up(stands * np.clip(-pitch, 0.0, _TOES))
        sole = _sole(baked, side, rotations[:, foot], rotations[:, toes])
        ankles[k] = _planted(joint[:, foot], sole, clip.standing[:, k], clip.fps)
    root = clip.root.copy()
    root[:, 2] -= _too_high(baked, rotations, root, ankles, clip.standing, width)
    for k, side in enumerate("LR"):
        leg, thigh = rest_leg(baked, side), joints[f"thigh.{side}"]
        hip = root + rotations[:, 0] @ (baked.joints[thigh] - baked.joints[0])
        knee = rotations[:, thigh] @ leg.knee
        bones = solve_leg(leg, hip, within(_REACH * leg.reach, hip, ankles[k]), knee)
        rotations[:, thigh], rotations[:, joints[f"calf.{side}"]] = bones
    return replace(clip, rotations=rotations, root=root)


def _sole(baked: BakedBody, side: str, foot: np.ndarray, toes: np.ndarray) -> np.ndarray:
    """The lower vertices of a foot relative to its ankle, shape (T, vertices, 3)."""
    ankle, ball = (baked.joint_names.index(f"{name}.{side}") for name in ("foot", "toes"))
    weight = baked.weights[:, [ankle, ball]]
    kept = (weight.sum(axis=1) > 0.99) & (baked.body.rest[:, 2] < baked.joints[ankle, 2])
    rest = baked.body.rest[kept].astype(np.float64)
    by_foot = (rest - baked.joints[ankle]) @ foot.swapaxes(1, 2)
    by_toes = (rest - baked.joints[ball]) @ toes.swapaxes(1, 2)
    by_toes += (foot @ (baked.joints[ball] - baked.joints[ankle]))[:, None]
    share = weight[kept, 1] / weight[kept].sum(axis=1)
    return by_foot + share[:, None] * (by_toes - by_foot)


def _planted(ankle: np.ndarray, sole: np.ndarray, standing: np.ndarray, fps: float) -> np.ndarray:
    """The path of an ankle [m], shape (T, 3), after planting."""
    lowest = sole[..., 2].argmin(axis=1)
    frames = np.arange(len(ankle) - 1)
    contact_moves = ankle[1:] + sole[frames + 1, lowest[:-1]] - ankle[:-1] - sole[frames, lowest[:-1]]
    moved = np.concatenate([np.zeros((1, 3)), -np.cumsum(contact_moves, axis=0)])
    height = -sole[..., 2].min(axis=1)
    moved[:, 2] = height - ankle[:, 2]
    phases = _phases(standing)
    for start, stop in phases:
        moved[start:stop, :2] -= moved[start:stop, :2].mean(axis=0)
    path = ankle + _between(moved, phases, _FADE * fps)
    above = path[:, 2] - height
    soft = (np.clip(above, -_SOFT, _SOFT) + _SOFT) ** 2 / (4 * _SOFT) + np.maximum(
        above - _SOFT, 0.0
    )  # max(above, 0), C1
    path[:, 2] = height + np.where(standing, 0.0, soft)
    return path


def _phases(standing: np.ndarray) -> list[tuple[int, int]]:
    """The runs (start, stop) of frames in which a foot stands."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], standing, [False]]).astype(int)))
    return list(zip(edges[::2], edges[1::2], strict=True))


def _between(moved: np.ndarray, phases: list[tuple[int, int]], fade: float) -> np.ndarray:
    """What contacts ask for, shape (T, 3), with smooth (C1) passages from one to the next; 0 where there is none.

    Between two contacts it eases from the one's end to the other's start; how fast it changed in them fades out within
    `fade` frames.
    """
    frames = np.arange(len(moved))
    out = np.zeros_like(moved)
    gaps = zip([None, *phases], [*phases, None], strict=True)
    for before, after in gaps if phases else ():
        last, first = -1 if before is None else before[1] - 1, len(moved) if after is None else after[0]
        k = frames[(frames > last) & (frames < first)]
        if before is None or after is None:
            out[k] = moved[first if before is None else last]
        else:
            out[k] = moved[last] + smoothstep((k - last) / (first - last))[:, None] * (moved[first] - moved[last])
        width = fade if before is None or after is None else min(fade, first - last)
        if before is not None and before[1] - before[0] > 1:
            out[k] += _fading(k - last, width) * (moved[last] - moved[last - 1])
        if after is not None and after[1] - after[0] > 1:
            out[k] -= _fading(first - k, width) * (moved[first + 1] - moved[first])
    for start, stop in phases:
        out[start:stop] = moved[start:stop]
    return out


def _fading(k: np.ndarray, width: float) -> np.ndarray:
    """k, but brought back to 0 at `width` without a kink, shape (N, 1)."""
    return (k * np.clip(1 - k / width, 0.0, None) ** 2)[:, None]


def _too_high(
    baked: BakedBody, rotations: np.ndarray, root: np.ndarray, ankles: np.ndarray, standing: np.ndarray, width: float
) -> np.ndarray:
    """By how much the hips must come down [m] for standing feet to be in reach, shape (T,); smooth."""
    down = np.zeros(len(root))
    for k, side in enumerate("LR"):
        leg, thigh = rest_leg(baked, side), baked.joint_names.index(f"thigh.{side}")
        line = root + rotations[:, 0] @ (baked.joints[thigh] - baked.joints[0]) - ankles[k]
        up = np.sqrt(np.maximum((_REACH * leg.reach) ** 2 - np.sum(line[:, :2] ** 2, axis=1), 0.0))
        down = np.maximum(down, np.where(standing[:, k], line[:, 2] - up, 0.0))
    return gaussian_filter1d(maximum_filter1d(down, 2 * round(2 * width) + 1), width, mode="nearest")
