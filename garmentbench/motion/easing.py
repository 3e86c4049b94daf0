"""Smooth steps, from which motions are put together."""

from itertools import pairwise

import numpy as np
from scipy.ndimage import convolve1d, maximum_filter1d


def smoothstep(u: np.ndarray | float) -> np.ndarray:
    """From 0 to 1 for u from 0 to 1, constant outside, C2 everywhere: 6 u^5 - 15 u^4 + 10 u^3."""
    u = np.clip(u, 0.0, 1.0)
    return u**3 * (u * (6 * u - 15) + 10)


def rolling_start(u: np.ndarray | float) -> np.ndarray:
    """0 before u = -1, u after u = 1, C2: the path of something that gets from standstill to speed 1."""
    v = np.clip((np.asarray(u) + 1) / 2, 0.0, 1.0)
    return np.where(np.asarray(u) > 1, u, 2 * v**3 - v**4)  # the integral of the step 3 v^2 - 2 v^3


def bump(u: np.ndarray) -> np.ndarray:
    """From 0 at u = 0 over 1 at u = 1/2 to 0 at u = 1, 0 outside, C1."""
    u = np.clip(u, 0.0, 1.0)
    return 16 * (u * (1 - u)) ** 2


def cyclic_steps(phase: np.ndarray, steps: tuple[tuple[float, float, float], ...]) -> np.ndarray:
    """Sum of smooth steps (from phase, to phase, amount) that come again in each cycle; periodic if they sum to 0."""
    total = np.zeros_like(phase)
    for start, stop, amount in steps:
        cycle = np.floor(phase - start)
        total += amount * (cycle + smoothstep((phase - start - cycle) / (stop - start)))
    return total


def eased(knots: list[tuple[float, float]], t: np.ndarray) -> np.ndarray:
    """A path that rests at each knot (time, value) and goes on to the next in a smooth step; shape of t."""
    total = np.full(np.shape(t), float(knots[0][1]))
    for (start, low), (stop, high) in pairwise(knots):
        if high != low:
            total += (high - low) * smoothstep((t - start) / (stop - start))
    return total


def smooth_maximum(values: np.ndarray, width: int) -> np.ndarray:
    """A smooth path, shape (T,), that is nowhere below `values` or 0, and 0 where no value near is above.

    The maximum over a window of `width`, an odd number, averaged over the same window with weights that sum to 1.
    """
    window = np.hanning(width + 2)[1:-1]
    return convolve1d(maximum_filter1d(np.maximum(values, 0.0), width), window / window.sum(), mode="nearest")


def wave(u: np.ndarray, period: float, late: float = 0.0) -> np.ndarray:
    """A sine of that period, which rises through 0 at u = `late`."""
    return np.sin(2 * np.pi * (u - late) / period)


def between(u: np.ndarray, start: float, stop: float, ease: float = 1.0) -> np.ndarray:
    """1 from `start` + `ease` to `stop` - `ease`, 0 outside of `start` and `stop`, C2."""
    return smoothstep((u - start) / ease) * smoothstep((stop - u) / ease)
