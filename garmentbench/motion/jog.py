"""A run at 2.5 m/s: between one foot and the other the body flies freely.

At this speed knees bend by about 90 degrees in the swing, and a foot stands for nearly 0.39 of the cycle; 130 degrees
and 0.22 are a sprinter's (Novacheck 1998, "The biomechanics of running"). Beyond 95, skinning folds our bodies' calves
into their thighs, where there is no place for cloth.
"""

from dataclasses import replace

import numpy as np

from garmentbench.motion.easing import smoothstep
from garmentbench.motion.legs import rest_leg
from garmentbench.motion.notation import Bearing, Hips, Score
from garmentbench.motion.steps import ALWAYS, GRAVITY, Plant
from garmentbench.motion.variation import drift, hurry
from garmentbench.scenes.bodies import BakedBody

_BEGIN = 0.78  # the first foot lands [s]
_PERIOD = 0.72  # two steps [s]
_CONTACT = 0.26  # a foot is on the ground [s]
_STRIDE = 1.8  # [m] in two steps, of the base body
_LEG = 0.90215  # its leg [m]
_STARTING = 5  # steps until it is up to speed
_OFF, _ON = -0.047, -0.082  # the pelvis against rest when a foot leaves the ground, and when one lands [m]


def run_score(baked: BakedBody, seconds: float) -> Score:
    """A run forward that lasts at least the given seconds."""
    scale = rest_leg(baked, "L").reach / _LEG
    times = np.arange(0.0, seconds + 8.0, 0.01)
    lands = np.interp(0.5 * np.arange(int(2 * _cycles(times[-1]))), _cycles(times), times)
    grown = np.minimum(0.1 + (np.arange(len(lands)) + 1) / _STARTING, 1.0)
    lengths = 0.5 * scale * _STRIDE * grown * (1 + 0.02 * drift(np.arange(len(lands)) / 2, 6))
    contact = _CONTACT + (1 - grown) * 0.15 * _PERIOD  # the first steps are steps of a walk
    return Score(
        *(_plants(baked, side, scale, lands, np.cumsum(lengths), contact) for side in "LR"),
        height=_height(scale, lands, contact),
        bearing=_bearing,
        hips=Hips(out=0.0, up=-3.0, turn=0.0),
        shift=0.1,
        smooth=0.17,
    )


def _cycles(t: np.ndarray) -> np.ndarray:
    """Pairs of steps at each time; a whole number where the left foot lands."""
    even = (t - _BEGIN) / _PERIOD
    return even + hurry(np.maximum(even, 0.0))


def _plants(
    baked: BakedBody, side: str, scale: float, lands: np.ndarray, places: np.ndarray, contact: np.ndarray
) -> list[Plant]:
    rest = baked.joints[baked.joint_names.index(f"foot.{side}")]
    x = np.sign(rest[0]) * 0.055 * scale
    own = range(0 if side == "L" else 1, len(lands), 2)
    leaves = [lands[k] + contact[k] for k in own]
    plants = [Plant(-ALWAYS, lands[own[0]] - 0.4, *rest[:2], push=25.0)]
    for k, leave in zip(own, [*leaves[:-1], ALWAYS], strict=True):
        at = x, rest[1] - places[k]
        plant = Plant(lands[k], leave, *at, strike=6.0, push=60.0, lift=0.055, tuck=42.0, brisk=True)
        plants.append(plant if k > 1 else replace(plant, lift=0.06, tuck=25.0))
    return plants


def _height(scale: float, lands: np.ndarray, contact: np.ndarray) -> list[tuple[float, tuple[float, float, float]]]:
    """Parabolas of free flight, joined smoothly on the ground."""
    knots = [(0.0, (0.0, 0.0, 0.0)), (_BEGIN, (-0.05 * scale, 0.0, 0.0))]
    for k in range(1, len(lands) - 1):
        leave = lands[k] + contact[k]
        flight = lands[k + 1] - leave
        off, fall = scale * _OFF, scale * (_OFF - _ON) / (_PERIOD / 2 - _CONTACT)  # [m], [m/s]
        speed = 0.5 * GRAVITY * flight - fall
        knots += [
            (leave, (off, speed, -GRAVITY)),
            (lands[k + 1], (off - fall * flight, speed - GRAVITY * flight, -GRAVITY)),
        ]
    return knots


def _bearing(t: np.ndarray) -> Bearing:
    """Bent arms swing against the legs, the chest against the pelvis."""
    cycles = _cycles(t)
    strength = smoothstep(cycles + 0.6)
    back = strength * np.cos(2 * np.pi * (cycles - 0.02))  # 1: the left arm is back
    arms = {}
    for side, sign, k in (("L", 1.0, 0), ("R", -1.0, 1)):
        amplitude = 36 * (1 + 0.08 * drift(cycles, k))
        arms |= {
            f"swing.{side}": 4 - sign * amplitude * back,
            f"space.{side}": 27 + 1.5 * drift(cycles, 2 + k),
            f"elbow.{side}": 25 + strength * (57 - 14 * sign * back),
            f"roll.{side}": -6 * strength,
        }
    return arms | {
        "lean": 3 + strength * (7 + 0.7 * drift(cycles, 4)),
        "tilt": 2 + 5 * strength,
        "surge": 0.12 * strength,  # the foot lands not far ahead of the body
        "turn": -7 * back,
        "twist": 9 * back,
    }
