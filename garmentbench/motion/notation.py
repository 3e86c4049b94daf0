"""What a motion on foot is written down as: steps, the pelvis' rise and fall, and the bearing of trunk and arms."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from garmentbench.motion.steps import Plant

# The bearing: its channels, and their values in an easy stand. Degrees; sway and surge in metres.
NEUTRAL = {
    "sway": 0.0,  # the pelvis, to the left of where the feet put it
    "surge": 0.0,  # ... and forward
    "list": 0.0,  # its left side down
    "tilt": 2.0,  # it leans forward
    "turn": 0.0,  # it turns to the left
    "bend": 0.0,  # the chest bends to the left
    "lean": 3.0,  # ... leans forward
    "twist": 0.0,  # ... turns to the left, against the feet
    "look": 0.0,  # the head turns to the left
    **{
        f"{name}.{side}": value
        for side in "LR"
        for name, value in (
            ("space", 24.0),  # the upper arm, off the body to the side: 90 is level, 180 straight up
            ("swing", 0.0),  # ... then swung forward
            ("roll", 0.0),  # ... turned about itself, so that a bent fore-arm points outward
            ("elbow", 25.0),  # its bend
        )
    },
}
SIDEWAYS = ("sway", "list", "turn", "bend", "twist", "look")  # change sign in the mirror

# Channels by name, each of shape (T,), or a number where it does not change; one that is not there is neutral.
Bearing = Mapping[str, np.ndarray | float]
FullBearing = dict[str, np.ndarray]  # with every channel, each of shape (T,)


@dataclass(frozen=True)
class Hips:
    """How the pelvis goes along with the weight, when all of it is on one foot: out over it, that side up, turned.

    Attributes:
        out: To the standing foot's side [m].
        up: The standing side up [degrees].
        turn: Towards the standing foot [degrees].
    """

    out: float = 0.01
    up: float = 2.0
    turn: float = 0.0


@dataclass(frozen=True)
class Score:
    """A motion on foot, from a stand at time 0 in the rest pose's place on. Seconds, metres.

    Attributes:
        left, right: The feet's plants; the first of each is where it stands at rest.
        height: Knots of the pelvis' height above its rest height: times, and value, speed and acceleration at each.
        bearing: The bearing at given times.
        hips: How the pelvis goes along with the weight.
        shift: Time in which weight comes onto a foot or goes off it.
        smooth: Width of the window over which the pelvis' path over the floor is smoothed (a standard deviation).
    """

    left: list[Plant]
    right: list[Plant]
    height: list[tuple[float, tuple[float, float, float]]]
    bearing: Callable[[np.ndarray], Bearing]
    hips: Hips = Hips()
    shift: float = 0.25
    smooth: float = 0.12


def mirrored(bearing: Bearing) -> Bearing:
    """Left and right exchanged."""
    swapped = {"L": "R", "R": "L"}
    return {
        (name[:-1] + swapped[name[-1]] if "." in name else name): (-values if name in SIDEWAYS else values)
        for name, values in bearing.items()
    }


def filled(bearing: Bearing, shape: tuple[int, ...]) -> FullBearing:
    """All channels of a bearing, in full."""
    return {name: np.broadcast_to(np.asarray(bearing.get(name, rest), float), shape) for name, rest in NEUTRAL.items()}
