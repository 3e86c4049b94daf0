"""What a recorded skeleton tells by itself.

Which way is up, its unit, whether it is a mirror image, and rows that are no motion.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from garmentbench.errors import UserError
from garmentbench.importing.motions.recording import Recording, resample, world
from garmentbench.motion.clip import part
from garmentbench.motion.legs import unit
from garmentbench.scenes.bodies import BakedBody

UNITS = {"metres": 1.0, "centimetres": 0.01, "millimetres": 0.001, "inches": 0.0254, "CMU's 5.64 cm": 0.0254 / 0.45}
_AXES = {f"{sign}{name}": s * np.eye(3)[a] for a, name in enumerate("xyz") for sign, s in (("", 1.0), ("-", -1.0))}
_UPRIGHT = 0.8  # how much of the way from feet to chest must be along the up axis
_LEVEL = 0.4  # cosine between up and the lines from hip to hip and shoulder to shoulder of who stands
_BONES = (("thigh", "calf"), ("calf", "foot"), ("upper_arm", "fore_arm"), ("fore_arm", "hand"))
_ADULT = (1.2, 2.3)  # [m]
_NO_MOTION = 12.0  # [m/s]: so fast no joint moves against the hips, but a rest pose before the motion makes it jump
_MOTION = 4.0  # [m/s]
_LEAD = 0.1  # [s]
_STRAIGHT = np.cos(np.radians(25))  # an elbow that is bent by less in a T-pose is meant to be straight
_BENT = (
    0.03  # how far ahead knees are of the line from hip to ankle, over the thigh's length, to tell which way that is
)
_POINTS = 0.3  # cosine between a foot and the way ahead that tells
_ACROSS = 0.9  # how much of an upper arm is across the body in a T-pose


@dataclass(frozen=True)
class Upright:
    """A recording brought to our axes and size.

    Attributes:
        recording: z up, in metres, its legs as long as the body's.
        joints: Index of the recording's joint for each of ours that it has.
        up: Its own up axis, e.g. "y".
        rest_up: The axis along which its rest pose stands; "" where that is no person who stands.
        unit: Its own unit, as its height suggests.
        height: The person's height in that unit [m].
        mirrored: Was it a mirror image (left-handed axes), which here is turned back? None: nothing told.
        dropped: Rows left out at the start because they show a rest pose.
        start: Where the part that was asked for begins, after those rows [s].
        rest: The rest pose (one frame): the first of these rows, or that of rotations that are all zero.
        straightened: By how much the elbows of its T-pose are bent, which here are straight [degrees].
    """

    recording: Recording
    joints: dict[str, int]
    up: str
    rest_up: str
    unit: str
    height: float
    mirrored: bool | None
    dropped: int
    start: float
    rest: Recording
    straightened: float

    def at_rate(self, fps: float) -> "Upright":
        """The same at another frame rate."""
        return replace(self, recording=resample(self.recording, fps))


def bring_upright(
    recording: Recording,
    joints: dict[str, int],
    baked: BakedBody,
    path: Path,
    start: float = 0.0,
    stop: float | None = None,
) -> Upright:
    """Find out axes, size and handedness of a recording's part from `start` to `stop` [s], as if the rest did not
    exist.

    Raises `UserError` where the part is not inside it, no axis is up or a bone has no length.
    """
    first_frame = world(recording.frames(0, 1))[1]
    _check_bones(first_frame, joints, path)
    legs = _leg_length(first_frame, joints)
    ours = _leg_length(baked.joints[None], {name: i for i, name in enumerate(baked.joint_names)})
    height = np.ptp(baked.body.rest[:, 2]) * legs / ours
    unit = min(UNITS, key=lambda u: abs(np.log(height * UNITS[u] / 1.7)))
    if not _ADULT[0] < height * UNITS[unit] < _ADULT[1]:
        unit = "an unknown unit"
    scaled = recording.in_axes(np.eye(3), ours / legs)
    dropped = _rest_rows(scaled, joints)
    rest = scaled.frames(0, 1) if dropped else scaled.rest_pose()
    motion = scaled.frames(dropped, len(scaled))
    first, last = part(path, motion.seconds, motion.fps, start, stop, to_end=True)
    motion = motion.frames(first, last + 1)
    _, positions = world(motion)
    up = _up_axis(positions, joints)
    if not up:
        raise UserError(
            f"{path}: no axis is up: the chest is not above the feet; wanted somebody who stands most of the time"
        )
    rest_up = _rest_up(world(rest)[1], joints)
    _check_bones(positions, joints, path)
    mirrored = _is_mirrored(positions, joints, _AXES[up])
    turn = _turn_to_z(_AXES[up]) @ (_mirror(_AXES[up]) if mirrored else np.eye(3))
    motion, bend = _straight_elbows(motion.in_axes(turn), joints)
    rest = replace(rest.in_axes(turn), offsets=motion.offsets)
    return Upright(
        motion, joints, up, rest_up, unit, height * UNITS.get(unit, np.nan), mirrored, dropped, start, rest, bend
    )


def _is_mirrored(positions: np.ndarray, joints: dict[str, int], up: np.ndarray) -> bool | None:
    """Do toes and knees, positions of shape (T, J, 3), point to the back of who has left and right where the names say?
    None where neither tells: no toes, straight knees."""

    def at(name: str) -> np.ndarray:
        return np.stack([positions[:, joints[f"{name}.{side}"]] for side in "LR"], axis=1)

    hips, knees, ankles = (at(name) for name in ("thigh", "calf", "foot"))
    ahead = unit(np.cross(hips[:, 0] - hips[:, 1], up))[:, None]
    bent = (
        knees
        - hips
        - (ankles - hips)
        * (
            np.sum((knees - hips) * (ankles - hips), axis=-1) / np.maximum(np.sum((ankles - hips) ** 2, axis=-1), 1e-12)
        )[..., None]
    )
    told = float(np.mean(np.sum(bent * ahead, axis=-1)) / np.linalg.norm(knees - hips, axis=-1).mean()) / _BENT
    if "toes.L" in joints and "toes.R" in joints:
        feet = at("toes") - ankles
        told += (
            float(np.mean(np.sum(feet * ahead, axis=-1)) / max(np.linalg.norm(feet, axis=-1).mean(), 1e-12)) / _POINTS
        )
    return None if abs(told) < 1 else told < 0


def _mirror(up: np.ndarray) -> np.ndarray:
    """The mirroring of an axis that is not up, shape (3, 3)."""
    return np.diag([1.0, -1.0, 1.0] if up[0] else [-1.0, 1.0, 1.0])


def _up_axis(positions: np.ndarray, joints: dict[str, int]) -> str:
    """The axis along which the chest is from the feet, most of the time; "" where none is."""
    feet = positions[:, [joints["foot.L"], joints["foot.R"]]].mean(axis=1)
    body = np.median(positions[:, joints["chest"]] - feet, axis=0)
    up = max(_AXES, key=lambda a: _AXES[a] @ body)
    return up if _AXES[up] @ body > _UPRIGHT * np.linalg.norm(body) else ""


def _rest_up(positions: np.ndarray, joints: dict[str, int]) -> str:
    """The axis along which a rest pose stands; "" where it is no person who stands: of some programs all bones lie
    along one axis, of others it has no meaning."""
    up = _up_axis(positions, joints)
    if not up:
        return ""
    pairs = ("foot", "thigh", "upper_arm")
    feet, hips, shoulders = (positions[0, [joints[f"{name}.{side}"] for side in "LR"]] for name in pairs)
    legs, trunk = (unit(high.mean(axis=0) - low.mean(axis=0)) for low, high in ((feet, hips), (hips, shoulders)))
    across = max(abs(unit(pair[0] - pair[1]) @ _AXES[up]) for pair in (hips, shoulders))
    return up if min(legs @ _AXES[up], trunk @ _AXES[up]) > _UPRIGHT and across < _LEVEL else ""


def _check_bones(positions: np.ndarray, joints: dict[str, int], where: Path) -> None:
    """Raises `UserError` where two joints that give a bone its direction are at one place."""
    bones = [(f"{a}.{side}", f"{b}.{side}") for side in "LR" for a, b in _BONES] + [
        (f"{a}.L", f"{a}.R") for a in ("thigh", "upper_arm")
    ]
    size = np.ptp(positions, axis=1).max()
    for a, b in bones:
        if not np.linalg.norm(positions[:, joints[a]] - positions[:, joints[b]], axis=1).min() > 1e-4 * size:
            raise UserError(
                f"{where}: {a} and {b} are at one place; wanted a bone of some length, or other names with --map"
            )


def _turn_to_z(up: np.ndarray) -> np.ndarray:
    """A rotation, shape (3, 3), that takes axes to axes, `up` to z; where y was up, z ahead is then -y, as ours."""
    ahead = np.roll(np.abs(up), 1)
    return np.eye(3) if up[2] == 1 else np.stack([np.cross(up, ahead), -ahead, up])


def _leg_length(positions: np.ndarray, joints: dict[str, int]) -> float:
    """Mean length of thigh and calf together, of positions of shape (T, J, 3)."""
    ends = [(f"{a}.{side}", f"{b}.{side}") for side in "LR" for a, b in _BONES[:2]]
    bones = [positions[:, joints[a]] - positions[:, joints[b]] for a, b in ends]
    return float(np.linalg.norm(bones, axis=-1).mean() * 2)


def _rest_rows(recording: Recording, joints: dict[str, int]) -> int:
    """How many rows at the start show a rest pose, or the jump from it into the motion (CMU's conversions have
    such)."""
    _, positions = world(recording.frames(0, int(_LEAD * recording.fps) + 2))
    moving = positions[:, list(joints.values())] - positions[:, :1]
    speed = np.linalg.norm(np.diff(moving, axis=0), axis=-1).max(axis=1, initial=0) * recording.fps
    if not len(speed) or speed[0] < _NO_MOTION or len(speed) + 1 >= len(recording):
        return 0
    return 1 + int(np.argmax(np.append(speed, 0.0)[1:] < _MOTION))


def _straight_elbows(recording: Recording, joints: dict[str, int]) -> tuple[Recording, float]:
    """The recording with straight elbows in its T-pose, if it has one, and by how much they were bent [degrees].

    Figures of Poser and Daz hold their fore-arms 18 degrees ahead in their T-pose; whose motion was brought to them had
    straight arms in his.
    """
    _, positions = world(recording.rest_pose())
    place = {name: positions[0, i] for name, i in joints.items()}
    across = unit(place["upper_arm.L"] - place["upper_arm.R"])
    offsets, bend = recording.offsets.copy(), 0.0
    for side, out in (("L", across), ("R", -across)):
        arm, fore, hand = (place[f"{name}.{side}"] for name in ("upper_arm", "fore_arm", "hand"))
        upper, lower = fore - arm, hand - fore
        cosine = upper @ lower / max(np.linalg.norm(upper) * np.linalg.norm(lower), 1e-12)
        parent = recording.parents[joints[f"hand.{side}"]]
        if cosine < _STRAIGHT or unit(upper) @ out < _ACROSS or parent != joints[f"fore_arm.{side}"]:
            return recording, 0.0
        offsets[joints[f"hand.{side}"]] = np.linalg.norm(lower) * unit(upper)
        bend = max(bend, float(np.degrees(np.arccos(min(cosine, 1.0)))))
    return replace(recording, offsets=offsets), bend
