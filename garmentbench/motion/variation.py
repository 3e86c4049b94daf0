"""What differs from one stride of a person to the next.

A walk that is an exact loop of 33 frames holds 33 frames, however long it is recorded: a method that replays it is
perfect, and more training frames bring nothing. People's strides differ by 2 to 3 % in time and by a few degrees in the
arms and trunk (Hausdorff 2007, "Gait dynamics, fractals and falls"). Here they drift by sums of sines of periods from
2 to 9 cycles that have no common one: smooth, the same every time, and never twice the same.
"""

from dataclasses import dataclass

import numpy as np

from garmentbench.motion.gait import Gait

_PERIODS = np.array([2.236, 3.732, 6.083, 9.110])  # cycles


@dataclass(frozen=True)
class Varied:
    """What of a gait varies, at each phase; degrees, arrays of shape (T,)."""

    arm_space: np.ndarray
    arm_swing: np.ndarray
    elbow: np.ndarray
    hip_sway: np.ndarray
    pelvis_turn: np.ndarray
    lean: np.ndarray
    look: np.ndarray


def vary(gait: Gait, phase: np.ndarray) -> Varied:
    """The gait at each phase, shape (T,)."""
    drifts = [gait.variation * drift(phase, k) for k in range(7)]
    return Varied(
        arm_space=gait.arm_space + 1.5 * drifts[0],
        arm_swing=gait.arm_swing * (1 + 0.10 * drifts[1]),
        elbow=gait.elbow * (1 + 0.10 * drifts[2]),
        hip_sway=gait.hip_sway * (1 + 0.10 * drifts[3]),
        pelvis_turn=gait.pelvis_turn * (1 + 0.10 * drifts[4]),
        lean=gait.lean + 0.7 * drifts[5],
        look=1.2 * drifts[6],
    )


def hurry(cycles: np.ndarray) -> np.ndarray:
    """How far ahead of an even walk a person is after a number of cycles [cycles]: the pace varies by about 2 %.

    0 at the start, and so is its derivative, so that it takes up where a warm-up ends.
    """
    rate = 2 * np.pi / _PERIODS
    ahead = (1 - np.cos(rate * np.asarray(cycles)[..., None])) @ (1 / rate)
    return 0.014 * ahead


def drift(phase: np.ndarray, k: int) -> np.ndarray:
    """A smooth drift of variance 1, another one for each k."""
    angle = 2 * np.pi * np.asarray(phase)[..., None] / _PERIODS + 2.4 * (k + 1) * np.arange(1, len(_PERIODS) + 1)
    return np.sin(angle).sum(axis=-1) * np.sqrt(2 / len(_PERIODS))
