"""The three dances, named for what they are: a hip-led Latin step, a spin-and-swing step, a bouncing arm-led step."""

import numpy as np

from garmentbench.motion.dance import Dance, Phrase, Step
from garmentbench.motion.easing import smoothstep
from garmentbench.motion.score import Bearing, Hips

_LOW = {"lift": 0.02, "push": 18.0, "tuck": 6.0, "strike": 2.0}  # a step that hardly leaves the floor


def _wave(b: np.ndarray, period: float, late: float = 0.0) -> np.ndarray:
    return np.sin(2 * np.pi * (b - late) / period)


def _between(b: np.ndarray, start: float, stop: float, ease: float = 1.0) -> np.ndarray:
    """1 from one beat to another, 0 outside, smooth."""
    return smoothstep((b - start) / ease) * smoothstep((stop - b) / ease)


# --- the hip-led Latin step: knees and hips at work under a quiet trunk, elbows bent, the arms follow the hips ---


def _latin_arms(b: np.ndarray, space: float = 28.0) -> Bearing:
    follow = _wave(b, 2.0, 0.6)
    return {
        "space.L": space + 5 * follow, "space.R": space - 5 * follow,
        "swing.L": 12 + 14 * follow, "swing.R": 12 - 14 * follow,
        "elbow.L": 88 - 12 * follow, "elbow.R": 88 + 12 * follow,
        "roll.L": 5.0, "roll.R": 5.0,
        "twist": 7 * follow, "bend": 3 * _wave(b, 2.0, 0.2),
    }  # fmt: skip


def _latin_open(b: np.ndarray) -> Bearing:
    """One arm is led out and up, then the other."""
    first, second = _between(b, 0.5, 4.0, 1.6), _between(b, 4.2, 7.8, 1.6)
    arms = _latin_arms(b)
    return arms | {
        "space.L": arms["space.L"] + 75 * first, "space.R": arms["space.R"] + 75 * second,
        "elbow.L": arms["elbow.L"] - 60 * first, "elbow.R": arms["elbow.R"] - 60 * second,
        "roll.L": 5 + 45 * first, "roll.R": 5 + 45 * second,
        "twist": 14 * (first - second), "look": 12 * (first - second),
    }  # fmt: skip


def _steps(*steps: tuple) -> tuple[Step, ...]:
    return tuple(Step(*step) for step in steps)


LATIN = Dance(
    seed=1,
    beat=0.44,
    height=-0.045,
    hips=Hips(out=0.045, up=9.0, turn=9.0),
    phrases=(
        Phrase(8, (  # forward and back
            Step("L", 1, 0.0, 0.22), Step("R", 2, how=_LOW), Step("L", 3),
            Step("R", 5, 0.0, -0.22), Step("L", 6, how=_LOW), Step("R", 7),
        ), _latin_arms),
        Phrase(8, (  # to the sides
            Step("L", 1, 0.24), Step("R", 2, how=_LOW), Step("L", 3),
            Step("R", 5, -0.24), Step("L", 6, how=_LOW), Step("R", 7),
        ), _latin_open),
        Phrase(8, (  # a quarter turn
            Step("L", 1, 0.0, 0.16, 20.0), Step("R", 2, turn=45.0, how={"lift": 0.03}), Step("L", 3, turn=70.0),
            Step("R", 5, 0.0, -0.14, 90.0), Step("L", 6, turn=90.0, how=_LOW), Step("R", 7, turn=90.0),
        ), lambda b: _latin_arms(b, 36.0), end=(0.0, 0.0, 90.0)),
        Phrase(8, (  # crossed in front, with the hips
            Step("L", 1, -0.10, 0.20), Step("R", 2, how=_LOW), Step("L", 3),
            Step("R", 4, 0.10, 0.20), Step("L", 5, how=_LOW), Step("R", 6), Step("L", 7, how=_LOW), Step("R", 8, how=_LOW),
        ), lambda b: _latin_arms(b) | {"twist": 14 * _wave(b, 6.0, 0.0)}),
    ),
)  # fmt: skip


# --- the spin-and-swing step: turns on the ball of the foot, legs and arms that swing out ---

_PIVOT = {"raised": 14.0, "pivot": 65.0, "strike": -8.0, "push": 25.0}
_ROUND, _ROUND_BACK = {"kick": (0.02, 0.15)}, {"kick": (-0.04, -0.15)}  # round the standing foot, in front of or behind it


def _spin_arms(b: np.ndarray) -> Bearing:
    """Wound up against the turn, then carried along by it."""
    wind, open_ = _between(b, -0.2, 1.6, 1.0), _between(b, 1.2, 6.8, 1.4)
    return {
        "space.L": 30 + 34 * open_, "space.R": 30 + 34 * open_ + 16 * wind,
        "swing.L": 15 + 20 * wind, "swing.R": 15.0 + 10 * open_, "elbow.L": 45 + 12 * open_, "elbow.R": 45 + 12 * open_,
        "roll.L": -20 + 15 * open_, "roll.R": -20 + 15 * open_,
        "twist": -24 * wind + 16 * open_, "look": 18 * open_, "lean": 2.0,
    }  # fmt: skip


def _kick_arms(b: np.ndarray) -> Bearing:
    """The arms swing against the legs."""
    swing = _wave(b, 4.0, 0.6)
    return {
        "space.L": 30.0, "space.R": 30.0, "swing.L": 6 + 42 * swing, "swing.R": 6 - 42 * swing,
        "elbow.L": 50 + 16 * swing, "elbow.R": 50 - 16 * swing, "twist": 14 * swing, "lean": 8.0 - 10 * _between(b, 1.2, 3.2),
    }  # fmt: skip


def _side_arms(b: np.ndarray) -> Bearing:
    """Both arms swing from one side to the other, across the body."""
    side = _wave(b, 4.0, 0.2)
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
            Step("R", 3.2, -0.15, 0.03, 128.0, 0.8, _PIVOT | _ROUND_BACK), Step("L", 4.2, 0.08, 0.0, 250.0, 0.8, _PIVOT | _ROUND),
            Step("R", 5.2, -0.08, 0.0, 330.0, 0.8, _ROUND_BACK), Step("L", 6.2, 0.02, 0.0, 360.0, 0.8, _ROUND), Step("R", 7.2, turn=360.0),
        ), _spin_arms, dips=((0, 0.0), (1, -0.035), (2.4, 0.015), (5, 0.015), (6.4, -0.02), (8, 0.0)), end=(0.0, 0.0, 360.0)),
        Phrase(8, (  # kicks forward and back
            Step("L", 1, 0.0, 0.10), Step("R", 2.8, how={"kick": (0.0, 0.42), "lift": 0.30, "tuck": 30.0}, take=1.5),
            Step("L", 4.4, how={"kick": (0.0, -0.30), "lift": 0.20, "tuck": 45.0}, take=1.3), Step("R", 5.2, 0.0, -0.08),
            Step("L", 6.6, how={"kick": (0.0, 0.42), "lift": 0.28, "tuck": 30.0}, take=1.2), Step("R", 7.5),
        ), _kick_arms, dips=((0, 0.0), (1, -0.03), (2, 0.0), (3, -0.03), (4, 0.0), (5, -0.03), (6, 0.0), (7, -0.03), (8, 0.0))),
        Phrase(8, (  # from side to side
            Step("L", 1, 0.28), Step("R", 2, 0.20), Step("L", 3, 0.30), Step("R", 4.2, 0.26, how={"kick": (-0.10, 0.1), "lift": 0.08}),
            Step("R", 5.2, -0.02), Step("L", 6.2, 0.02), Step("R", 7.2),
        ), _side_arms, dips=((0, 0.0), (1, -0.04), (2, 0.0), (3, -0.04), (4, 0.0), (5, -0.04), (6, 0.0), (7, -0.03), (8, 0.0))),
        Phrase(4, (  # half a turn, quicker
            Step("L", 1, 0.05, 0.0, 50.0, 0.7, _PIVOT), Step("R", 2, -0.07, 0.0, 120.0, 0.8, _ROUND_BACK),
            Step("L", 3, 0.03, 0.0, 180.0, 0.7, _ROUND), Step("R", 3.8, turn=180.0),
        ), lambda b: {"space.L": 34 + 34 * _between(b, 0.2, 3.8), "space.R": 34 + 34 * _between(b, 0.2, 3.8),
                      "elbow.L": 50.0, "elbow.R": 50.0, "twist": -14 * _wave(b, 4.0) * _between(b, 0, 4)},
            dips=((0, 0.0), (2, 0.01), (4, 0.0)), end=(0.0, 0.0, 180.0)),
    ),
)  # fmt: skip


# --- the bouncing arm-led step: the knees give on every beat, the arms lead ---


def _bounces(beats: int, depth: float = 0.075) -> tuple[tuple[float, float], ...]:
    return tuple((k / 2, -depth if k % 2 == 0 else 0.0) for k in range(2 * beats))


def _touches(width: float = 0.20) -> tuple[Step, ...]:
    """Step and touch, to the left and to the right."""
    return (
        Step("L", 1, width), Step("R", 2, width - 0.04, how=_LOW), Step("R", 3, -width), Step("L", 4, 0.04 - width, how=_LOW),
        Step("L", 5, width), Step("R", 6, width - 0.04, how=_LOW), Step("R", 7, 0.0), Step("L", 7.9, 0.0, how=_LOW),
    )  # fmt: skip


def _pump(b: np.ndarray) -> Bearing:
    """Both fore-arms up, pumping on the beat."""
    push = _wave(b, 1.0, 0.25)
    return {
        "space.L": 62.0 + 14 * push, "space.R": 62.0 + 14 * push, "elbow.L": 72 - 24 * push, "elbow.R": 72 - 24 * push,
        "roll.L": 84.0, "roll.R": 84.0, "lean": 1.0, "bend": 6 * _wave(b, 4.0, 0.2), "twist": 5 * _wave(b, 4.0, 0.6),
    }  # fmt: skip


def _swaying(b: np.ndarray) -> Bearing:
    """Lifted arms sway from side to side and take the chest along."""
    side = _wave(b, 4.0, 0.3)
    return {
        "space.L": 62 + 22 * side, "space.R": 62 - 22 * side, "elbow.L": 62.0, "elbow.R": 62.0, "roll.L": 80.0, "roll.R": 80.0,
        "bend": -13 * side, "sway": 0.025 * side, "look": 8 * side,
    }  # fmt: skip


def _punches(b: np.ndarray) -> Bearing:
    """Alternate fists to the front."""
    turn = _wave(b, 2.0, 0.2)
    return {
        "space.L": 32.0, "space.R": 32.0, "swing.L": 52 + 26 * turn, "swing.R": 52 - 26 * turn,
        "elbow.L": 58 - 36 * turn, "elbow.R": 58 + 36 * turn, "roll.L": -5.0, "roll.R": -5.0, "twist": -18 * turn, "lean": 7.0,
    }  # fmt: skip


def _wings(b: np.ndarray) -> Bearing:
    """Bent arms beat like wings, from the ribs to the shoulders."""
    up = _wave(b, 2.0, 0.3)
    return {
        "space.L": 56 + 22 * up, "space.R": 56 + 22 * up, "elbow.L": 76.0, "elbow.R": 76.0, "roll.L": 10.0 + 25 * up,
        "roll.R": 10.0 + 25 * up, "lean": 5 - 4 * up, "swing.L": 8.0, "swing.R": 8.0,
    }  # fmt: skip


_JOG = {"lift": 0.14, "tuck": 38.0, "strike": -14.0, "push": 45.0}

BOUNCE = Dance(
    seed=2,
    beat=0.47,
    height=-0.03,
    hips=Hips(out=0.015, up=2.5, turn=0.0),
    phrases=(
        Phrase(8, _touches(), _pump, _bounces(8)),
        Phrase(8, _touches(0.14), _swaying, _bounces(8)),
        Phrase(8, (Step("L", 1, 0.06, 0.08), Step("R", 2, -0.06, -0.06), Step("L", 7), Step("R", 7.8)), _punches, _bounces(8, 0.09)),
        Phrase(8, tuple(Step("LR"[k % 2], 1 + k, how=_JOG, take=0.7) for k in range(7)) + (Step("R", 7.95, how=_LOW, take=0.5),),
               _wings, _bounces(8, 0.06)),
    ),
)  # fmt: skip

DANCES = {"dance-latin": LATIN, "dance-spin": SPIN, "dance-bounce": BOUNCE}
