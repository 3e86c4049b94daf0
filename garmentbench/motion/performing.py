"""From a score to the rotations of all bones and the path of the pelvis."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BPoly, CubicSpline
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from garmentbench.motion.bearing import bear_arm, bear_trunk
from garmentbench.motion.easing import smooth_maximum, smoothstep
from garmentbench.motion.foot import pitch_up
from garmentbench.motion.legs import rest_leg, solve_leg
from garmentbench.motion.notation import NEUTRAL, FullBearing, Score, filled
from garmentbench.motion.steps import FootPath, foot_path
from garmentbench.motion.tread import tread
from garmentbench.motion.walk import Walk
from garmentbench.scenes.bodies import BakedBody

RATE = 120.0  # times a second at which the paths are worked out
_BEFORE = 1.0  # seconds of standing before time 0, for what is smoothed
_AFTER = 2.0  # ... after the last, so that a longer performance begins as a shorter one does
_STRETCH = 0.994  # of a leg's full reach, at most: the knee keeps a bend of 12 degrees
_AT_REST = 0.9975  # ... in the rest pose
_REACHING = 0.25  # seconds over which the pelvis goes down ahead of a step that is too long for the legs
_BEGINS = 0.4  # seconds from time 0 in which the bearing takes over from the rest pose
_IN_AIR = 0.15  # weight of a foot in the air in where the pelvis is held


@dataclass(frozen=True)
class _Paths:
    """What moves, on the even grid of times `t`; bearing has all channels, heading in radians."""

    t: np.ndarray
    feet: dict[str, FootPath]
    bearing: FullBearing
    heading: np.ndarray
    root: np.ndarray


def perform(baked: BakedBody, score: Score, seconds: np.ndarray, dressed: np.ndarray) -> Walk:
    """Perform a score.

    Args:
        baked: The body.
        score: What it does.
        seconds: Time in the score at each frame, from 0 on, shape (T,).
        dressed: From 0 (trunk and arms as in the rest pose) to 1 (all as written), shape (T,).
    """
    paths = _sampled(_paths(baked, score, float(seconds.max())), seconds)
    rotations = np.tile(np.eye(3), (len(seconds), len(baked.joint_names), 1, 1))
    rotations[:] = Rotation.from_euler("z", paths.heading[:, None]).as_matrix()[:, None]
    bear_trunk(baked, paths.bearing, paths.heading, dressed, rotations)
    for side in "LR":
        bear_arm(baked, paths.bearing, side, dressed, rotations)
        _leg(baked, paths, side, dressed, rotations)
    return Walk(rotations, paths.root)


def _paths(baked: BakedBody, score: Score, end: float) -> _Paths:
    t = np.arange(-round(_BEFORE * RATE), round((end + _AFTER) * RATE) + 1) / RATE
    rolling = tread(baked)
    feet = {
        side: foot_path(rolling, side, plants, t, score.shift)
        for side, plants in (("L", score.left), ("R", score.right))
    }
    bearing = filled(score.bearing(t), t.shape)
    left, begun = _weight_on_left(score, t), smoothstep(t / _BEGINS)
    bearing |= {
        "sway": bearing["sway"] + score.hips.out * left,
        "list": bearing["list"] - score.hips.up * left,
        "turn": bearing["turn"] + score.hips.turn * left,
    }
    heading = gaussian_filter1d(0.5 * (feet["L"].turn + feet["R"].turn), score.smooth * RATE, mode="nearest")
    root = baked.joints[0] + begun[:, None] * (_over_feet(baked, score, feet, bearing, heading) - baked.joints[0])
    times, knots = zip(*score.height, strict=True)
    wanted = baked.joints[0, 2] + BPoly.from_derivatives(times, [list(knot) for knot in knots])(
        np.clip(t, times[0], times[-1])
    )
    root[:, 2] = wanted
    root[:, 2] -= smooth_maximum(
        wanted - _highest(baked, feet, bearing, heading, root, t), 2 * round(_REACHING * RATE) + 1
    )
    return _Paths(t, feet, bearing, heading, root)


def _weight_on_left(score: Score, t: np.ndarray) -> np.ndarray:
    """From -1 (the weight is on the right foot) to 1, shape (T,): it goes onto the foot that has landed last."""
    landings = sorted([(p.land, 1.0) for p in score.left[1:]] + [(p.land, -1.0) for p in score.right[1:]])
    total, last = np.zeros(len(t)), 0.0
    for (land, side), (following, _) in zip(landings, [*landings[1:], (np.inf, 0.0)], strict=False):
        total += (side - last) * smoothstep((t - land + 0.1) / np.clip(following - land, 0.2, 0.6))
        last = side
    return total


def _over_feet(
    baked: BakedBody, score: Score, feet: dict[str, FootPath], bearing: FullBearing, heading: np.ndarray
) -> np.ndarray:
    """The pelvis over the floor: between the feet, nearer to the one that carries; shape (T, 3), z to be filled in."""
    share = {side: path.stands + _IN_AIR for side, path in feet.items()}
    held = sum(share[side][:, None] * path.ankle for side, path in feet.items()) / (share["L"] + share["R"])[:, None]
    middle = 0.5 * (feet["L"].ankle[0] + feet["R"].ankle[0])
    path = gaussian_filter1d(held, score.smooth * RATE, axis=0, mode="nearest")
    c, s = np.cos(heading), np.sin(heading)
    offset = np.stack([bearing["sway"], -bearing["surge"]], axis=1) + (baked.joints[0] - middle)[:2]
    path[:, 0] += c * offset[:, 0] - s * offset[:, 1]
    path[:, 1] += s * offset[:, 0] + c * offset[:, 1]
    return path


def _highest(
    baked: BakedBody,
    feet: dict[str, FootPath],
    bearing: FullBearing,
    heading: np.ndarray,
    root: np.ndarray,
    t: np.ndarray,
) -> np.ndarray:
    """The height of the pelvis joint [m] at which a leg is as far stretched as it may be, shape (T,)."""
    rotations = np.tile(np.eye(3), (len(t), len(baked.joint_names), 1, 1))
    bear_trunk(baked, bearing, heading, smoothstep(t / _BEGINS), rotations)
    stretch = _AT_REST + (_STRETCH - _AT_REST) * smoothstep(t / _BEGINS)
    heights = []
    for side, path in feet.items():
        hip = rotations[:, 0] @ (baked.joints[baked.joint_names.index(f"thigh.{side}")] - baked.joints[0])
        across = (path.ankle - root - hip)[:, :2]
        reach = stretch * rest_leg(baked, side).reach
        heights.append(path.ankle[:, 2] + np.sqrt(np.maximum(reach**2 - np.sum(across**2, axis=1), 0.0)) - hip[:, 2])
    return np.min(heights, axis=0)


def _sampled(paths: _Paths, seconds: np.ndarray) -> _Paths:
    """The same at other times."""

    def at(values: np.ndarray) -> np.ndarray:
        return CubicSpline(paths.t, values)(seconds)

    feet = {
        side: FootPath(**{name: at(values) for name, values in vars(path).items()}) for side, path in paths.feet.items()
    }
    return _Paths(seconds, feet, {name: at(paths.bearing[name]) for name in NEUTRAL}, at(paths.heading), at(paths.root))


def _leg(baked: BakedBody, paths: _Paths, side: str, dressed: np.ndarray, rotations: np.ndarray) -> None:
    """The foot is where it must be; thigh and calf follow. The knee points between where foot and pelvis point."""
    joint = {name: baked.joint_names.index(f"{name}.{side}") for name in ("thigh", "calf", "foot", "toes")}
    leg, foot = rest_leg(baked, side), paths.feet[side]
    hip = paths.root + rotations[:, 0] @ (baked.joints[joint["thigh"]] - baked.joints[0])
    forward = np.array([np.sign(leg.thigh[0, 0]) * 0.12, -1.0, 0.0])
    knee = leg.knee + dressed[:, None] * (forward - leg.knee)
    knee = Rotation.from_euler("z", 0.5 * (paths.heading + foot.turn)[:, None]).apply(knee)
    rotations[:, joint["thigh"]], rotations[:, joint["calf"]] = solve_leg(leg, hip, foot.ankle, knee)
    turned = Rotation.from_euler("z", foot.turn[:, None]).as_matrix()
    rotations[:, joint["foot"]] = turned @ pitch_up(foot.pitch)
    rotations[:, joint["toes"]] = turned @ pitch_up(foot.pitch + foot.bend)
