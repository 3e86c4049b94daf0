"""The spin-and-swing step: turns on the ball of the foot, legs and arms that swing out."""

import numpy as np

from garmentbench.motion.dances.dance import Dance, Phrase, Step
from garmentbench.motion.easing import between, wave
from garmentbench.motion.notation import Bearing, Hips

_PIVOT = {"raised": 14.0, "pivot": 65.0, "strike": -8.0, "push": 25.0}
# Round the standing foot, in front of it or behind it.
_ROUND, _ROUND_BACK = {"kick": (0.02, 0.15)}, {"kick": (-0.04, -0.15)}


def _spin_arms(b: np.ndarray) -> Bearing:
    """Wound up against the turn, then carried along by it."""
    wind, open_ = between(b, -0.2, 1.6, 1.0), between(b, 1.2, 6.8, 1.4)
    return {
        "space.L": 30 + 34 * open_, "space.R": 30 + 34 * open_ + 16 * wind,
        "swing.L": 15 + 20 * wind, "swing.R": 15.0 + 10 * open_, "elbow.L": 45 + 12 * open_, "elbow.R": 45 + 12 * open_,
        "roll.L": -20 + 15 * open_, "roll.R": -20 + 15 * open_,
        "twist": -24 * wind + 16 * open_, "look": 18 * open_, "lean": 2.0,
    }  # fmt: skip


def _kick_arms(b: np.ndarray) -> Bearing:
    """The arms swing against the legs."""
    swing = wave(b, 4.0, 0.6)
    return {
        "space.L": 30.0, "space.R": 30.0, "swing.L": 6 + 42 * swing, "swing.R": 6 - 42 * swing,
        "elbow.L": 50 + 16 * swing, "elbow.R": 50 - 16 * swing, "twist": 14 * swing,
        "lean": 8.0 - 10 * between(b, 1.2, 3.2),
    }  # fmt: skip


def _side_arms(b: np.ndarray) -> Bearing:
    """Both arms swing from one side to the other, across the body."""
    side = wave(b, 4.0, 0.2)
    return {
        "space.L": 48 + 22 * side, "space.R": 48 - 22 * side, "swing.L": 32 - 8 * side, "swing.R": 32 + 8 * side,
        "elbow.L": 40.0, "elbow.R": 40.0, "roll.L": -15.0 + 10 * side, "roll.R": -15.0 - 10 * side,
        "bend": -11 * side, "twist": 18 * side, "sway": 0.03 * side,
    }  # fmt: skip


SPIN = Dance(
    seed=6,
    beat=0.48,
    height=-0.035,
    hips=Hips(out=0.02, up=3.5, turn=2.0),
    phrases=(
        Phrase(8, (  # a whole turn in four steps
            Step("L", 1, 0.10, 0.0, -10.0), Step("L", 2.2, 0.06, 0.05, 60.0, 0.8, _PIVOT),
            Step("R", 3.2, -0.15, 0.03, 128.0, 0.8, _PIVOT | _ROUND_BACK),
            Step("L", 4.2, 0.08, 0.0, 250.0, 0.8, _PIVOT | _ROUND), Step("R", 5.2, -0.08, 0.0, 330.0, 0.8, _ROUND_BACK),
            Step("L", 6.2, 0.02, 0.0, 360.0, 0.8, _ROUND), Step("R", 7.2, turn=360.0),
        ), _spin_arms, dips=((1, -0.035), (2.4, 0.015), (5, 0.015), (6.4, -0.02), (8, 0.0)), end=(0.0, 0.0, 360.0)),
        Phrase(8, (  # kicks forward and back
            Step("L", 1, 0.0, 0.10), Step("R", 2.8, how={"kick": (0.0, 0.42), "lift": 0.30, "tuck": 30.0}, take=1.5),
            Step("L", 4.4, how={"kick": (0.0, -0.30), "lift": 0.20, "tuck": 45.0}, take=1.3),
            Step("R", 5.2, 0.0, -0.08),
            Step("L", 6.6, how={"kick": (0.0, 0.42), "lift": 0.28, "tuck": 30.0}, take=1.2), Step("R", 7.5),
        ), _kick_arms, dips=((1, -0.03), (2, 0.0), (3, -0.03), (4, 0.0), (5, -0.03), (6, 0.0), (7, -0.03), (8, 0.0))),
        Phrase(8, (  # from side to side
            Step("L", 1, 0.28), Step("R", 2, 0.20), Step("L", 3, 0.30),
            Step("R", 4.2, 0.26, how={"kick": (-0.10, 0.1), "lift": 0.08}), Step("R", 5.2, -0.02),
            Step("L", 6.2, 0.02), Step("R", 7.2),
        ), _side_arms, dips=((1, -0.04), (2, 0.0), (3, -0.04), (4, 0.0), (5, -0.04), (6, 0.0), (7, -0.03), (8, 0.0))),
        Phrase(4, (  # half a turn, quicker
            Step("L", 1, 0.05, 0.0, 50.0, 0.7, _PIVOT), Step("R", 2, -0.07, 0.0, 120.0, 0.8, _ROUND_BACK),
            Step("L", 3, 0.03, 0.0, 180.0, 0.7, _ROUND), Step("R", 3.8, turn=180.0),
        ), lambda b: {"space.L": 34 + 34 * between(b, 0.2, 3.8), "space.R": 34 + 34 * between(b, 0.2, 3.8),
                      "elbow.L": 50.0, "elbow.R": 50.0, "twist": -14 * wave(b, 4.0) * between(b, 0, 4)},
            dips=((2, 0.01), (4, 0.0)), end=(0.0, 0.0, 180.0)),
    ),
)  # fmt: skip
