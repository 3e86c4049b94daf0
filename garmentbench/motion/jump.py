"""Jumps, one after another: crouch, take-off, free flight, landing, and a pause that is never quite as long."""

from dataclasses import dataclass

import numpy as np

from garmentbench.motion.easing import eased
from garmentbench.motion.legs import rest_leg
from garmentbench.motion.notation import Bearing, Hips, Score
from garmentbench.motion.steps import ALWAYS, GRAVITY, Plant
from garmentbench.motion.variation import drift
from garmentbench.scenes.bodies import BakedBody

_SEED = 7
_BEGIN = 0.8  # [s]
_LEG = 0.90215  # the base body's leg [m]
_OFF, _ON = 0.085, 0.015  # the pelvis against rest on tiptoe: taking off, and touching down [m]
_TAKE_OFF = 0.30  # from the lowest crouch to taking off [s]
_ABSORB = 0.26  # from touching down to the lowest point [s]


@dataclass(frozen=True)
class _Jump:
    """One jump. Times [s]; metres; degrees."""

    crouch: float  # when the pelvis begins to sink
    lowest: float
    off: float
    on: float
    absorbed: float
    risen: float
    depth: float  # of the crouch
    soft: float  # ... of the landing
    speed: float  # upward, when taking off [m/s]
    to: tuple[float, float]
    turn: float
    arms: float  # how far they swing up


def jump_score(baked: BakedBody, seconds: float) -> Score:
    """Jumps that last at least the given seconds."""
    scale = rest_leg(baked, "L").reach / _LEG
    jumps = _jumps(seconds, scale)
    height = [(0.0, (0.0, 0.0, 0.0))]
    for jump in jumps:
        height += [
            (jump.crouch, (-0.02 * scale, 0.0, 0.0)),
            (jump.lowest, (-scale * jump.depth, 0.0, 6.0)),
            (jump.off, (scale * _OFF, jump.speed, -GRAVITY)),
            (jump.on, (scale * _ON, jump.speed - GRAVITY * (jump.on - jump.off), -GRAVITY)),
            (jump.absorbed, (-scale * jump.soft, 0.0, 6.0)),
            (jump.risen, (-0.02 * scale, 0.0, 0.0)),
        ]
    return Score(
        *(_plants(baked, side, jumps) for side in "LR"),
        height=height,
        bearing=lambda t: _bearing(jumps, t),
        hips=Hips(out=0.0, up=0.0),
        smooth=0.10,
    )


def _jumps(seconds: float, scale: float) -> list[_Jump]:
    chance = np.random.default_rng(_SEED)
    jumps, t, place, turn = [], _BEGIN, np.zeros(2), 0.0
    while t < seconds + 4.0:
        high, size = chance.uniform(0.10, 0.26) * scale, chance.uniform(0.85, 1.1)
        speed = float(np.sqrt(2 * GRAVITY * high))
        fall = scale * (_OFF - _ON)
        flight = (speed + np.sqrt(speed**2 + 2 * GRAVITY * fall)) / GRAVITY
        lowest = t + 0.42 * size
        off = lowest + _TAKE_OFF
        on = off + flight
        place = 0.5 * place + chance.uniform(-0.12, 0.12, 2) * scale  # back towards where it began
        turn += float(chance.choice([0.0, 0.0, -40.0, 40.0]))
        risen = on + _ABSORB + 0.5
        jumps.append(_Jump(
            t, lowest, off, on, on + _ABSORB, risen, depth=0.25 * size, soft=0.12 + 0.5 * high, speed=speed,
            to=(float(place[0]), float(place[1])), turn=turn, arms=float(chance.uniform(60.0, 105.0)),
        ))  # fmt: skip
        t = risen + float(chance.choice([0.05, 0.3, 0.9]))
    return jumps


def _plants(baked: BakedBody, side: str, jumps: list[_Jump]) -> list[Plant]:
    rest = baked.joints[baked.joint_names.index(f"foot.{side}")]
    plants = [Plant(-ALWAYS, jumps[0].off, *rest[:2], push=58.0)]
    for jump, leave in zip(jumps, [*(j.off for j in jumps[1:]), ALWAYS], strict=True):
        c, s = np.cos(np.radians(jump.turn)), np.sin(np.radians(jump.turn))
        x, y = jump.to[0] + 0.8 * c * rest[0], jump.to[1] + 0.8 * s * rest[0] + rest[1]
        plants.append(Plant(jump.on, leave, x, y, jump.turn, strike=-30.0, push=58.0, lift=0.03, tuck=40.0, hop=True))
    return plants


def _bearing(jumps: list[_Jump], t: np.ndarray) -> Bearing:
    """The trunk bows in the crouch, the arms go back and then throw the body up."""
    lean, tilt, swing, elbow = [(0.0, 3.0)], [(0.0, 2.0)], [(0.0, 0.0)], [(0.0, 25.0)]
    for j in jumps:
        bow, bowed = 100 * j.depth, 100 * j.soft
        lean += [(j.crouch, 3.0), (j.lowest, 3 + bow), (j.off + 0.03, 4.0), (j.on, 5.0)]
        lean += [(j.absorbed + 0.05, 3 + 1.2 * bowed), (j.risen, 3.0)]
        tilt += [(j.crouch, 2.0), (j.lowest, 2 + 1.1 * bow), (j.off + 0.03, 2.0), (j.on, 4.0)]
        tilt += [(j.absorbed, 2 + bowed), (j.risen, 2.0)]
        swing += [
            (j.crouch, 0.0),
            (j.lowest - 0.06, -38.0),
            (j.off + 0.16, j.arms),
            (j.absorbed + 0.1, -8.0),
            (j.risen, 0.0),
        ]
        elbow += [(j.crouch, 25.0), (j.lowest, 22.0), (j.off, 50.0), (j.on, 30.0), (j.absorbed, 50.0), (j.risen, 25.0)]
    bearing = {"lean": eased(lean, t), "tilt": eased(tilt, t)}
    for k, side in enumerate("LR"):
        bearing |= {
            f"swing.{side}": eased(swing, t) + 3 * drift(t / 2, k),
            f"elbow.{side}": eased(elbow, t),
            f"space.{side}": 26 + 1.5 * drift(t / 2, 2 + k),
        }
    return bearing
