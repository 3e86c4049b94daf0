"""The hip-led Latin step: knees and hips at work under a quiet trunk; the bent arms follow the hips."""

import numpy as np

from garmentbench.motion.dances.dance import LOW, Dance, Phrase, Step
from garmentbench.motion.easing import between, wave
from garmentbench.motion.notation import Bearing, Hips


def _latin_arms(b: np.ndarray, space: float = 28.0) -> dict[str, np.ndarray | float]:
    follow = wave(b, 2.0, 0.6)
    return {
        "space.L": space + 5 * follow, "space.R": space - 5 * follow,
        "swing.L": 12 + 14 * follow, "swing.R": 12 - 14 * follow,
        "elbow.L": 88 - 12 * follow, "elbow.R": 88 + 12 * follow,
        "roll.L": 5.0, "roll.R": 5.0,
        "twist": 7 * follow, "bend": 3 * wave(b, 2.0, 0.2),
    }  # fmt: skip


def _latin_open(b: np.ndarray) -> Bearing:
    """One arm is led out and up, then the other."""
    first, second = between(b, 0.5, 4.0, 1.6), between(b, 4.2, 7.8, 1.6)
    arms = _latin_arms(b)
    return arms | {
        "space.L": arms["space.L"] + 75 * first, "space.R": arms["space.R"] + 75 * second,
        "elbow.L": arms["elbow.L"] - 60 * first, "elbow.R": arms["elbow.R"] - 60 * second,
        "roll.L": 5 + 45 * first, "roll.R": 5 + 45 * second,
        "twist": 14 * (first - second), "look": 12 * (first - second),
    }  # fmt: skip


LATIN = Dance(
    seed=1,
    beat=0.44,
    height=-0.045,
    hips=Hips(out=0.045, up=9.0, turn=9.0),
    phrases=(
        Phrase(8, (  # forward and back
            Step("L", 1, 0.0, 0.22), Step("R", 2, how=LOW), Step("L", 3),
            Step("R", 5, 0.0, -0.22), Step("L", 6, how=LOW), Step("R", 7),
        ), _latin_arms),
        Phrase(8, (  # to the sides
            Step("L", 1, 0.24), Step("R", 2, how=LOW), Step("L", 3),
            Step("R", 5, -0.24), Step("L", 6, how=LOW), Step("R", 7),
        ), _latin_open),
        Phrase(8, (  # a quarter turn
            Step("L", 1, 0.0, 0.16, 20.0), Step("R", 2, turn=45.0, how={"lift": 0.03}), Step("L", 3, turn=70.0),
            Step("R", 5, 0.0, -0.14, 90.0), Step("L", 6, turn=90.0, how=LOW), Step("R", 7, turn=90.0),
        ), lambda b: _latin_arms(b, 36.0), end=(0.0, 0.0, 90.0)),
        Phrase(8, (  # crossed in front, with the hips
            Step("L", 1, -0.10, 0.20), Step("R", 2, how=LOW), Step("L", 3),
            Step("R", 4, 0.10, 0.20), Step("L", 5, how=LOW), Step("R", 6), Step("L", 7, how=LOW), Step("R", 8, how=LOW),
        ), lambda b: _latin_arms(b) | {"twist": 14 * wave(b, 6.0, 0.0)}),
    ),
)  # fmt: skip
