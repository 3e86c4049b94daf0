"""The bouncing arm-led step: the knees give on every beat, the arms lead."""

import numpy as np

from garmentbench.motion.dances.dance import LOW, Dance, Phrase, Step
from garmentbench.motion.easing import wave
from garmentbench.motion.notation import Bearing, Hips


def _bounces(beats: int, depth: float = 0.075) -> tuple[tuple[float, float], ...]:
    """Down on every beat, up between them."""
    return tuple((k / 2, -depth if k % 2 == 0 else 0.0) for k in range(1, 2 * beats + 1))


def _touches(width: float = 0.20) -> tuple[Step, ...]:
    """Step and touch, to the left and to the right."""
    return (
        Step("L", 1, width), Step("R", 2, width - 0.04, how=LOW),
        Step("R", 3, -width), Step("L", 4, 0.04 - width, how=LOW),
        Step("L", 5, width), Step("R", 6, width - 0.04, how=LOW), Step("R", 7, 0.0), Step("L", 7.9, 0.0, how=LOW),
    )  # fmt: skip


def _pump(b: np.ndarray) -> Bearing:
    """Both fore-arms up, pumping on the beat."""
    push = wave(b, 1.0, 0.25)
    return {
        "space.L": 62.0 + 14 * push, "space.R": 62.0 + 14 * push, "elbow.L": 72 - 24 * push, "elbow.R": 72 - 24 * push,
        "roll.L": 84.0, "roll.R": 84.0, "lean": 1.0, "bend": 6 * wave(b, 4.0, 0.2), "twist": 5 * wave(b, 4.0, 0.6),
    }  # fmt: skip


def _swaying(b: np.ndarray) -> Bearing:
    """Lifted arms sway from side to side and take the chest along."""
    side = wave(b, 4.0, 0.3)
    return {
        "space.L": 62 + 22 * side, "space.R": 62 - 22 * side, "elbow.L": 62.0, "elbow.R": 62.0,
        "roll.L": 80.0, "roll.R": 80.0,
        "bend": -13 * side, "sway": 0.025 * side, "look": 8 * side,
    }  # fmt: skip


def _punches(b: np.ndarray) -> Bearing:
    """Alternate fists to the front."""
    turn = wave(b, 2.0, 0.2)
    return {
        "space.L": 32.0, "space.R": 32.0, "swing.L": 52 + 26 * turn, "swing.R": 52 - 26 * turn,
        "elbow.L": 58 - 36 * turn, "elbow.R": 58 + 36 * turn, "roll.L": -5.0, "roll.R": -5.0,
        "twist": -18 * turn, "lean": 7.0,
    }  # fmt: skip


def _wings(b: np.ndarray) -> Bearing:
    """Bent arms beat like wings, from the ribs to the shoulders."""
    up = wave(b, 2.0, 0.3)
    return {
        "space.L": 56 + 22 * up, "space.R": 56 + 22 * up, "elbow.L": 76.0, "elbow.R": 76.0, "roll.L": 10.0 + 25 * up,
        "roll.R": 10.0 + 25 * up, "lean": 5 - 4 * up, "swing.L": 8.0, "swing.R": 8.0,
    }  # fmt: skip


_JOG = {"lift": 0.10, "tuck": 38.0, "strike": -14.0, "push": 45.0}

BOUNCE = Dance(
    seed=2,
    beat=0.47,
    height=-0.03,
    hips=Hips(out=0.015, up=2.5, turn=0.0),
    phrases=(
        Phrase(8, _touches(), _pump, _bounces(8)),
        Phrase(8, _touches(0.14), _swaying, _bounces(8)),
        Phrase(8, (  # on the spot, in a wide stand
            Step("L", 1, 0.06, 0.08), Step("R", 2, -0.06, -0.06), Step("L", 7), Step("R", 7.8),
        ), _punches, _bounces(8, 0.09)),
        Phrase(8, (  # jogging on the spot
            *(Step("LR"[k % 2], 1 + k, how=_JOG, take=0.7) for k in range(7)), Step("R", 7.95, how=LOW, take=0.5),
        ), _wings, _bounces(8, 0.06)),
    ),
)  # fmt: skip
