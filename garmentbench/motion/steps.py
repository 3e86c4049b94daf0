"""Steps: where a foot stands and when, and how it gets from one place to the next."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import BPoly
from scipy.ndimage import gaussian_filter1d

from garmentbench.motion.easing import eased, smooth_maximum, smoothstep
from garmentbench.motion.tread import Tread

_SETTLE = 0.14  # seconds in which a foot that has landed comes down flat, at most
_PEEL = 0.30  # ... in which it comes off the floor, heel first, at most
_AFTER = 0.04  # ... for which it goes on rolling after it has left
_NUDGE = 1e-3  # ... over which a path's speed is measured
_BLUR = 1.5  # a foot's contact jumps from vertex to vertex: its height is smoothed over this many times
_WINDOW = 9  # ... and raised by what it then lacks within this many times
GRAVITY = 9.81  # [m/s^2]
ALWAYS = 1e6  # ... from the first to the last


@dataclass(frozen=True)
class Plant:
    """A foot on the floor, and the swing that took it there. Seconds, metres, degrees.

    Attributes:
        land, leave: When it comes down and goes off.
        x, y: The ankle's place when the foot is flat; midway through a pivot.
        turn: Its heading when it lands, to the left of the rest pose's.
        pivot: It turns so far to the left on its ball while it stands.
        strike: Pitch at which it lands; toes up, or toes down where negative.
        raised: Height of the heel, as a pitch, while it stands: 0 is flat.
        push: Pitch, heel up, at which it leaves.
        lift: Height of its lowest point in the swing.
        tuck: Pitch, heel up, in the middle of the swing.
        kick: Excursion of the swing, to the left and forward in the landing foot's frame.
        hop: The foot is carried up as a body is that flies freely as long as the swing lasts.
        brisk: It goes off the floor and comes down more sharply, so that a low swing clears the floor.
    """

    land: float
    leave: float
    x: float
    y: float
    turn: float = 0.0
    pivot: float = 0.0
    strike: float = 6.0
    raised: float = 0.0
    push: float = 32.0
    lift: float = 0.05
    tuck: float = 12.0
    kick: tuple[float, float] = (0.0, 0.0)
    hop: bool = False
    brisk: bool = False


@dataclass(frozen=True)
class FootPath:
    """A foot at each time, arrays of length T.

    Attributes:
        ankle: [m], shape (T, 3).
        turn: Heading [rad].
        pitch, bend: Of the foot, toes up; of the toes against it [rad].
        stands: From 0 (in the air) to 1 (carries weight).
    """

    ankle: np.ndarray
    turn: np.ndarray
    pitch: np.ndarray
    bend: np.ndarray
    stands: np.ndarray


def foot_path(tread: Tread, side: str, plants: list[Plant], t: np.ndarray, shift: float) -> FootPath:
    """The path of a foot.

    Args:
        tread: How it rolls.
        side: "L" or "R".
        plants: Where it stands, in order; the first has stood, and the last will stand, for ever.
        t: Times [s], evenly spaced, shape (T,).
        shift: Time [s] in which weight comes onto a foot, or goes off it.
    """
    pitch, turn = _pitch(plants, t), _turn(plants, t)
    ankle = np.empty((len(t), 3))
    air = np.zeros(len(t))  # how far through its swing
    lift, stands = np.zeros(len(t)), np.zeros(len(t))
    for plant in plants:
        on = (t >= plant.land) & (t <= plant.leave)
        ankle[on, :2] = _stance(tread, side, plant, plants, t[on])
        stands[on] = _weight(plant, t[on], shift)
    for before, after in pairwise(plants):
        on = (t > before.leave) & (t < after.land)
        u = (t[on] - before.leave) / (after.land - before.leave)
        ankle[on, :2] = _swing(tread, side, before, after, plants, t[on]) + _soft_bump(u)[:, None] * _kick(after)
        air[on], lift[on] = u, after.lift * (_bump(u) if after.brisk else _soft_bump(u))
        if after.hop:
            lift[on] += 0.5 * GRAVITY * (t[on] - before.leave) * (after.land - t[on])
    bend = np.maximum(-pitch, 0.0) * (1 - smoothstep(air / 0.3) * smoothstep((1 - air) / 0.3))
    ankle[:, 2] = _smooth(tread.height(pitch, bend) + lift)
    return FootPath(ankle, turn, pitch, bend, stands)


def _smooth(needed: np.ndarray) -> np.ndarray:
    """A smooth height of the ankle at which the rolling foot is nowhere below the floor."""
    smooth = gaussian_filter1d(needed, _BLUR, mode="nearest")
    return smooth + smooth_maximum(needed - smooth, _WINDOW)


def _pitch(plants: list[Plant], t: np.ndarray) -> np.ndarray:
    """Pitch [rad], shape (T,)."""
    knots = []
    for k, plant in enumerate(plants):
        stance = plant.leave - plant.land
        if k:
            gap = plant.land - plants[k - 1].leave
            knots += [(plant.land - 0.45 * gap, -plant.tuck), (plant.land - 0.02, plant.strike)]
            knots.append((plant.land + min(_SETTLE, 0.35 * stance), -plant.raised))
        else:
            knots.append((plant.land, -plant.raised))
        if k < len(plants) - 1:
            gap = plants[k + 1].land - plant.leave
            knots.append((plant.leave - min(_PEEL, 0.5 * stance), -plant.raised))
            knots.append((plant.leave + min(_AFTER, 0.2 * gap), -plant.push))
    return np.radians(eased(knots, t))


def _turn(plants: list[Plant], t: np.ndarray) -> np.ndarray:
    """Heading [rad], shape (T,)."""
    knots = []
    for plant in plants:
        knots += [(plant.land, plant.turn), (plant.leave, plant.turn + plant.pivot)]
    return np.radians(eased(knots, t))


def _stance(tread: Tread, side: str, plant: Plant, plants: list[Plant], t: np.ndarray) -> np.ndarray:
    """The ankle over the floor [m], shape (T, 2): it rolls over the sole and turns about the ball."""
    ball = tread.ball * ([1, 1] if side == "L" else [-1, 1])
    midway, now = np.radians(plant.turn + 0.5 * plant.pivot), _turn(plants, t)
    centre = np.array([plant.x, plant.y]) + _turned(ball, midway)
    forward = np.stack([np.zeros_like(t), -tread.rolled(_pitch(plants, t))], axis=-1)
    return centre + _turned(forward - ball, now)


def _swing(tread: Tread, side: str, before: Plant, after: Plant, plants: list[Plant], t: np.ndarray) -> np.ndarray:
    """The ankle over the floor in the air, shape (T, 2): it takes over place, speed and acceleration at both ends."""
    ends = []
    for plant, at in ((before, before.leave), (after, after.land)):
        points = _stance(tread, side, plant, plants, at + _NUDGE * np.array([-1.0, 0.0, 1.0]))
        ends.append(
            [points[1], (points[2] - points[0]) / (2 * _NUDGE), (points[2] - 2 * points[1] + points[0]) / _NUDGE**2]
        )
    return BPoly.from_derivatives([before.leave, after.land], ends)(t)


def _kick(plant: Plant) -> np.ndarray:
    return _turned(np.array([plant.kick[0], -plant.kick[1]]), np.radians(plant.turn))


def _weight(plant: Plant, t: np.ndarray, shift: float) -> np.ndarray:
    shift = min(shift, 0.5 * (plant.leave - plant.land))
    return smoothstep((t - plant.land) / shift) * smoothstep((plant.leave - t) / shift)


def _bump(u: np.ndarray) -> np.ndarray:
    """From 0 over 1 in the middle to 0, C1."""
    return 8 * (u * (1 - u)) ** 1.5


def _soft_bump(u: np.ndarray) -> np.ndarray:
    """From 0 over 1 in the middle to 0, C2."""
    return 64 * (u * (1 - u)) ** 3


def _turned(points: np.ndarray, angle: np.ndarray | float) -> np.ndarray:
    """Points over the floor, shape (..., 2), turned to the left."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)
