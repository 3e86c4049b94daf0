"""From a gait and its phases to the rotations of all bones and the path of the pelvis."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import BPoly, CubicSpline
from scipy.spatial.transform import Rotation

from garmentbench.motion.easing import bump, rolling_start, smoothstep
from garmentbench.motion.foot import FLAT, FootRoll, pitch_up, roll_foot
from garmentbench.motion.gait import Gait
from garmentbench.motion.knee import knee_bend
from garmentbench.motion.legs import rest_leg, solve_leg, unit, within
from garmentbench.motion.variation import Varied, vary
from garmentbench.scenes.bodies import BakedBody

MID_STANCE = 0.235  # phase at which the pelvis passes over the flat foot
_STARTING = 0.36  # the pelvis comes up to speed within this many cycles before and after it
_CARRIES = (0.38, 0.5)  # until then the leg that struck last says how high the pelvis is; from then on the other one
_LIMIT = 0.9997  # of a leg's full reach, at most; the rest pose has 0.9973
_SOFT = 0.002  # within this [m] of it the pelvis begins to go down
_PASSING = 0.12  # distance of the ankles' lines [m] when one foot passes the other, at least: feet are 10 cm wide
# How far each bone of the trunk has turned from the pelvis' attitude (0) to the chest's (1).
_TRUNK = {"pelvis": 0.0, "spine": 0.2, "waist": 0.6, "chest": 1.0, "clavicle.L": 1.0, "clavicle.R": 1.0}
# The head looks ahead: it follows the chest by this share, and looks at a point this far in front [m] while the pelvis
# sways and bobs (Hirasaki et al. 1999, "Effects of walking velocity on vertical head and body movements").
_HEAD_FOLLOWS = 0.35
_LOOKS_AT = 1.0
_WALKS_LOWER = 0.02  # the pelvis than at rest, on the whole [m]


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
    gait = gait.of_legs(rest_leg(baked, "L").reach)
    roll = roll_foot(baked, gait)
    varied, even = vary(gait, phase - first), vary(replace(gait, variation=0.0), phase)
    rotations = np.tile(np.eye(3), (len(phase), len(baked.joint_names), 1, 1))
    _trunk(baked, even, phase, dressed, rotations)
    root = _pelvis(baked, gait, phase, dressed)
    evenly = _carried(baked, gait, roll, phase, root, rotations)
    _trunk(baked, varied, phase, dressed, rotations)
    unevenly = _carried(baked, gait, roll, phase, root, rotations)
    root[:, 2] += dressed * (_rise(baked, gait, roll)(phase) - baked.joints[0, 2] + unevenly - evenly)
    root[:, 2] -= _too_high(baked, gait, roll, phase, root, rotations)
    _head(baked, varied, phase, dressed, root, rotations)
    for side, offset in (("L", 0.0), ("R", 0.5)):  # the two arms vary each in its own time
        _arm(baked, vary(gait, phase - first + 20 * offset), side, phase + offset, dressed, rotations)
        _leg(baked, gait, roll, side, phase, dressed, root, rotations)
    return Walk(rotations, root)


def _turns(axis: str, degrees: np.ndarray) -> Rotation:
    return Rotation.from_euler(axis, degrees[:, None], degrees=True)


def _trunk(baked: BakedBody, gait: Varied, phase: np.ndarray, dressed: np.ndarray, rotations: np.ndarray) -> None:
    """The pelvis turns with the leading leg and drops towards the swinging one; the chest turns against it."""
    for name, share in _TRUNK.items():
        rotations[:, baked.joint_names.index(name)] = _attitude(_trunk_angles(gait, phase, share), dressed)


def _trunk_angles(gait: Varied, phase: np.ndarray, share: float) -> np.ndarray:
    """Turn, list and lean [degrees] of what is that share of the way from the pelvis to the chest, shape (T, 3)."""
    cycle = 2 * np.pi * phase
    turn, drop = -gait.pelvis_turn * np.cos(cycle), -gait.hip_sway * np.sin(cycle + 0.3)
    return np.stack([turn * (1 - 2.2 * share), drop * (1 - 1.35 * share), gait.lean * (0.3 + 0.7 * share)], axis=1)


def _attitude(angles: np.ndarray, dressed: np.ndarray) -> np.ndarray:
    return Rotation.from_euler("ZYX", dressed[:, None] * angles, degrees=True).as_matrix()


def _head(
    baked: BakedBody, gait: Varied, phase: np.ndarray, dressed: np.ndarray, root: np.ndarray, rotations: np.ndarray
) -> None:
    """The head turns a little with the chest and keeps looking ahead, at a point in front; the neck is in between."""
    chest = _trunk_angles(gait, phase, 1.0)
    head = _HEAD_FOLLOWS * chest
    head[:, 0] += gait.look - np.degrees((root[:, 0] - baked.joints[0, 0]) / _LOOKS_AT)
    head[:, 2] += np.degrees((root[:, 2] - baked.joints[0, 2] + _WALKS_LOWER) / _LOOKS_AT)
    rotations[:, baked.joint_names.index("head")] = _attitude(head, dressed)
    rotations[:, baked.joint_names.index("neck")] = _attitude(0.5 * (head + chest), dressed)


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
    """Path of the pelvis joint over the floor, at its rest height, shape (T, 3)."""
    root = np.tile(baked.joints[0], (len(phase), 1))
    root[:, 0] += dressed * gait.side_sway * np.sin(2 * np.pi * (phase - 0.05))
    root[:, 1] -= gait.stride * _STARTING * rolling_start((phase - MID_STANCE) / _STARTING)
    return root


def _foot_phase(phase: np.ndarray, side: str) -> np.ndarray:
    """A foot's own phase (0: its heel strike), which begins when it first leaves the ground."""
    return np.maximum(phase + (0.0 if side == "L" else 0.5), FLAT)


def _ankle(baked: BakedBody, gait: Gait, roll: FootRoll, side: str, phase: np.ndarray) -> np.ndarray:
    """Path of an ankle, shape (T, 3). A foot moves to the side only while it is in the air."""
    phase = _foot_phase(phase, side)
    rest = baked.joints[baked.joint_names.index(f"foot.{side}")]
    lead = 0.0 if side == "L" else 0.5  # the right foot's steps fall half a stride short of the left's
    steps, swing = np.floor(phase), np.clip((phase % 1 - gait.stance) / (1 - gait.stance), 0.0, 1.0)
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
    ramp = 0.34
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
    ankle = within(_LIMIT * leg.reach, hip, _ankle(baked, gait, roll, side, phase))
    rotations[:, joint["thigh"]], rotations[:, joint["calf"]] = solve_leg(leg, hip, ankle, knee)
    pitch, bend = roll.pitch(_foot_phase(phase, side)), roll.bend(_foot_phase(phase, side))
    rotations[:, joint["foot"]] = pitch_up(pitch)
    rotations[:, joint["toes"]] = pitch_up(pitch + bend)


def _held(
    baked: BakedBody, side: str, span: np.ndarray | float, ankle: np.ndarray, root: np.ndarray, rotations: np.ndarray
) -> np.ndarray:
    """The height of the pelvis joint [m] at which hip and ankle are `span` apart, shape (T,)."""
    hip = rotations[:, 0] @ (baked.joints[baked.joint_names.index(f"thigh.{side}")] - baked.joints[0])
    across = (ankle - root - hip)[:, :2]
    return ankle[:, 2] + np.sqrt(np.maximum(span**2 - np.sum(across**2, axis=1), 0.0)) - hip[:, 2]


def _carried(
    baked: BakedBody, gait: Gait, roll: FootRoll, phase: np.ndarray, root: np.ndarray, rotations: np.ndarray
) -> np.ndarray:
    """The height of the pelvis joint [m] that the leg which carries asks for, whose knee bends as it must; (T,)."""
    held = np.zeros(len(phase))
    for side in "LR":
        own = _foot_phase(phase, side)
        span = rest_leg(baked, side).span(knee_bend(gait)(own))
        held += _carries(own) * _held(baked, side, span, _ankle(baked, gait, roll, side, phase), root, rotations)
    return held


def _carries(own: np.ndarray) -> np.ndarray:
    """How much of the pelvis' height a leg decides on, at its own phase; with the other's, 1."""
    start, stop = _CARRIES
    return 1 - smoothstep((own % 1 - start) / (stop - start)) + smoothstep((own % 1 - start - 0.5) / (stop - start))


def _rise(baked: BakedBody, gait: Gait, roll: FootRoll) -> CubicSpline:
    """Height of the pelvis joint [m] by the phase: what the leg that struck last asks for, then over to the other's."""
    phase = np.linspace(3.0, 3.0 + _CARRIES[0], 160)
    rotations = np.tile(np.eye(3), (len(phase), len(baked.joint_names), 1, 1))
    _trunk(baked, vary(replace(gait, variation=0.0), phase), phase, np.ones_like(phase), rotations)
    root = _pelvis(baked, gait, phase, np.ones_like(phase))
    held = CubicSpline(phase - 3, _carried(baked, gait, roll, phase, root, rotations))
    ends = [[held(at, order) for order in range(3)] for at in (_CARRIES[0], 0.0)]
    over = BPoly.from_derivatives(_CARRIES, ends)
    grid = np.linspace(0.0, 0.5, 241)
    height = np.where(grid < _CARRIES[0], held(grid), over(grid))
    height[-1] = height[0]
    return CubicSpline(grid, height, bc_type="periodic")


def _too_high(
    baked: BakedBody, gait: Gait, roll: FootRoll, phase: np.ndarray, root: np.ndarray, rotations: np.ndarray
) -> np.ndarray:
    """By how much the pelvis must go down [m] so that the legs reach the floor, shape (T,): only in the first steps."""
    starting = _SOFT * (1 - smoothstep((phase - 0.5) / 0.5)) + 1e-9
    down = np.zeros(len(phase))
    for side in "LR":
        stands = _foot_phase(phase, side) % 1 <= gait.stance
        highest = _held(
            baked, side, _LIMIT * rest_leg(baked, side).reach, _ankle(baked, gait, roll, side, phase), root, rotations
        )
        excess = np.where(stands, root[:, 2] - highest, -1.0)
        down = np.maximum(
            down, np.where(excess < starting, np.maximum(excess + starting, 0) ** 2 / (4 * starting), excess)
        )
    return down
