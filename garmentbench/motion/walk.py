"""From a gait and its phases to the rotations of all bones and the path of the pelvis."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from garmentbench.motion.easing import bump, rolling_start
from garmentbench.motion.foot import FLAT, STANCE, FootRoll, pitch_up, roll_foot
from garmentbench.motion.gait import Gait
from garmentbench.motion.legs import rest_leg, solve_leg, unit
from garmentbench.motion.variation import Varied, vary
from garmentbench.scenes.bodies import BakedBody

MID_STANCE = 0.225  # phase at which the pelvis passes over the flat foot
_STARTING = 0.36  # the pelvis comes up to speed within this many cycles before and after it
_STRETCH = 0.994  # of a leg's full reach, at most, in walking: the knee keeps a bend of 12 degrees
_LIMIT = 0.9985  # ... ever, which only a start at great speed comes to; the rest pose has 0.9973
_PASSING = 0.12  # distance of the ankles' lines [m] when one foot passes the other, at least: feet are 10 cm wide
# How far each bone of the trunk has turned from the pelvis' attitude (0) to the chest's (1).
_TRUNK = {"pelvis": 0.0, "spine": 0.2, "waist": 0.6, "chest": 1.0, "neck": 1.0, "clavicle.L": 1.0, "clavicle.R": 1.0}


@dataclass(frozen=True)
class Walk:
    """Bone rotations and root path. rotations: world-oriented, (T, J, 3, 3). root: pelvis joint [m], (T, 3)."""

    rotations: np.ndarray
    root: np.ndarray


def walk(baked: BakedBody, gait: Gait, phase: np.ndarray, dressed: np.ndarray, first: float = 0.0) -> Walk:
    """Walk forward (-y) through `phase`.

    Args:
        baked: The body.
        gait: How it walks.
        phase: Phase at each frame, shape (T,); it stands still with both feet flat before its feet first leave.
        dressed: From 0 (trunk and arms as in the rest pose) to 1 (all walking), shape (T,).
        first: The phase from which on what varies between strides is counted.
    """
    roll = roll_foot(baked, gait)
    rotations = np.tile(np.eye(3), (len(phase), len(baked.joint_names), 1, 1))
    _trunk(baked, vary(gait, phase - first), phase, dressed, rotations)
    for side, offset in (("L", 0.0), ("R", 0.5)):  # the two arms vary each in its own time
        _arm(baked, vary(gait, phase - first + 20 * offset), side, phase + offset, dressed, rotations)
    root = _pelvis(baked, gait, phase, dressed)
    root[:, 2] += dressed * (_pelvis_height(baked, gait, roll) - baked.joints[0, 2])
    root[:, 2] = np.minimum(root[:, 2], _highest(baked, gait, roll, phase, root, rotations, _LIMIT))
    for side in "LR":
        _leg(baked, gait, roll, side, phase, dressed, root, rotations)
    return Walk(rotations, root)


def _turns(axis: str, degrees: np.ndarray) -> Rotation:
    return Rotation.from_euler(axis, degrees[:, None], degrees=True)


def _trunk(baked: BakedBody, gait: Varied, phase: np.ndarray, dressed: np.ndarray, rotations: np.ndarray) -> None:
    """The pelvis turns with the leading leg and drops towards the swinging one; the chest turns against it."""
    cycle = 2 * np.pi * phase
    turn, drop = -gait.pelvis_turn * np.cos(cycle), -gait.hip_sway * np.sin(cycle + 0.3)
    for name, chest in _TRUNK.items():
        attitude = (
            _turns("z", dressed * turn * (1 - 2.2 * chest))
            * _turns("y", dressed * drop * (1 - 1.35 * chest))
            * _turns("x", dressed * gait.lean * (0.3 + 0.7 * chest))
        )
        rotations[:, baked.joint_names.index(name)] = attitude.as_matrix()


def _arm(
    baked: BakedBody, gait: Varied, side: str, phase: np.ndarray, dressed: np.ndarray, rotations: np.ndarray
) -> None:
    """An arm hangs `arm_space` off the body and swings against its leg, whose phase it is given; the elbow bends on the
    way up."""
    out = 1.0 if side == "L" else -1.0
    joint = {name: baked.joint_names.index(f"{name}.{side}") for name in ("upper_arm", "fore_arm", "hand")}
    upper, fore = (
        unit(baked.joints[joint[end]] - baked.joints[joint[start]])
        for start, end in (("upper_arm", "fore_arm"), ("fore_arm", "hand"))
    )
    swing = -np.cos(2 * np.pi * (phase - 0.04))
    elbow = gait.elbow * (1 + 0.45 * np.sin(2 * np.pi * (phase - 0.33)))
    hanging = Rotation.align_vectors([[0.0, 0.0, -1.0]], [upper])[0]
    raised = _turns("x", -gait.arm_swing * swing) * _turns("y", -out * gait.arm_space)
    hinge = unit(np.cross(upper, fore))
    bend = np.radians(elbow) - np.arccos(np.dot(upper, fore))
    chest = Rotation.from_matrix(rotations[:, baked.joint_names.index("chest")])
    arm = chest * Rotation.from_rotvec(dressed[:, None] * (raised * hanging).as_rotvec())
    rotations[:, joint["upper_arm"]] = arm.as_matrix()
    lower = arm * Rotation.from_rotvec((dressed * bend)[:, None] * hinge)
    rotations[:, joint["fore_arm"]] = rotations[:, joint["hand"]] = lower.as_matrix()


def _pelvis(baked: BakedBody, gait: Gait, phase: np.ndarray, dressed: np.ndarray) -> np.ndarray:
    """Path of the pelvis joint with its rest height as the mean, shape (T, 3)."""
    root = np.tile(baked.joints[0], (len(phase), 1))
    root[:, 0] += dressed * gait.side_sway * np.sin(2 * np.pi * (phase - 0.05))
    root[:, 1] -= gait.stride * _STARTING * rolling_start((phase - MID_STANCE) / _STARTING)
    root[:, 2] += dressed * _bob(gait, phase)
    return root


def _bob(gait: Gait, phase: np.ndarray) -> np.ndarray:
    """Rise and fall of the pelvis [m]: highest over each standing leg."""
    return gait.bob * np.cos(4 * np.pi * (phase - MID_STANCE))


def _foot_phase(phase: np.ndarray, side: str) -> np.ndarray:
    """A foot's own phase (0: its heel strike), which begins when it first leaves the ground."""
    return np.maximum(phase + (0.0 if side == "L" else 0.5), FLAT)


def _ankle(baked: BakedBody, gait: Gait, roll: FootRoll, side: str, phase: np.ndarray) -> np.ndarray:
    """Path of an ankle, shape (T, 3). A foot moves to the side only while it is in the air."""
    phase = _foot_phase(phase, side)
    rest = baked.joints[baked.joint_names.index(f"foot.{side}")]
    lead = 0.0 if side == "L" else 0.5  # the right foot's steps fall half a stride short of the left's
    steps, swing = np.floor(phase), np.clip((phase - np.floor(phase) - STANCE) / (1 - STANCE), 0.0, 1.0)
    gone = steps + swing_path(swing)
    first = np.minimum(gone, 1.0)  # from the rest stance into the line of walking
    path = np.empty((len(phase), 3))
    outward = gait.step_width / 2 + max(0.0, _PASSING - gait.step_width) * bump(swing)
    path[:, 0] = rest[0] + first * (np.sign(rest[0]) * outward - rest[0])
    path[:, 1] = rest[1] - gait.stride * (gone - lead * first) - roll.forward(phase)
    path[:, 2] = roll.height(phase) + (rest[2] - roll.height(FLAT))
    return path


def swing_path(u: np.ndarray) -> np.ndarray:
    """Share of a step covered at time u of the swing: speeds up, goes on evenly, slows down; C2."""
    ramp = 0.38
    return (rolling_start((2 * u - ramp) / ramp) - rolling_start((2 * u - 2 + ramp) / ramp)) * ramp / 2 / (1 - ramp)


def _leg(
    baked: BakedBody,
    gait: Gait,
    roll: FootRoll,
    side: str,
    phase: np.ndarray,
    dressed: np.ndarray,
    root: np.ndarray,
    rotations: np.ndarray,
) -> None:
    """Foot and toes roll as they must; thigh and calf follow."""
    joint = {name: baked.joint_names.index(f"{name}.{side}") for name in ("thigh", "calf", "foot", "toes")}
    leg = rest_leg(baked, side)
    hip = root + rotations[:, 0] @ (baked.joints[joint["thigh"]] - baked.joints[0])
    forward = np.array([np.sign(leg.thigh[0, 0]) * 0.12, -1.0, 0.0])  # the knees turn out a little, as the feet do
    knee = leg.knee + dressed[:, None] * (forward - leg.knee)
    ankle = _ankle(baked, gait, roll, side, phase)
    rotations[:, joint["thigh"]], rotations[:, joint["calf"]] = solve_leg(leg, hip, ankle, knee)
    pitch, bend = roll.pitch(_foot_phase(phase, side)), roll.bend(_foot_phase(phase, side))
    rotations[:, joint["foot"]] = pitch_up(pitch)
    rotations[:, joint["toes"]] = pitch_up(pitch + bend)


def _highest(
    baked: BakedBody,
    gait: Gait,
    roll: FootRoll,
    phase: np.ndarray,
    root: np.ndarray,
    rotations: np.ndarray,
    stretch: float,
) -> np.ndarray:
    """The height of the pelvis joint [m] at which a leg comes to `stretch` of its reach, shape (T,)."""
    heights = []
    for side in "LR":
        thigh = baked.joints[baked.joint_names.index(f"thigh.{side}")] - baked.joints[0]
        ankle, hip = _ankle(baked, gait, roll, side, phase), rotations[:, 0] @ thigh
        across = (ankle - root - hip)[:, :2]
        up = np.sqrt((stretch * rest_leg(baked, side).reach) ** 2 - np.sum(across**2, axis=1))
        heights.append(ankle[:, 2] + up - hip[:, 2])
    return np.min(heights, axis=0)


def _pelvis_height(baked: BakedBody, gait: Gait, roll: FootRoll) -> float:
    """The mean height of the pelvis joint [m] at which the legs are just not stretched at any time of the cycle."""
    phase = 3 + np.arange(240) / 240
    rotations = np.tile(np.eye(3), (len(phase), len(baked.joint_names), 1, 1))
    _trunk(baked, vary(replace(gait, variation=0.0), phase), phase, np.ones_like(phase), rotations)
    root = _pelvis(baked, gait, phase, np.ones_like(phase))
    return float(np.min(_highest(baked, gait, roll, phase, root, rotations, _STRETCH) - _bob(gait, phase)))
