"""The statistics of the ladder: of shares that were counted, of runs that ended or didn't, of distances that grow."""

import math

import numpy as np
from jaxtyping import Bool, Float, Int

Z = 1.959964  # of a normal distribution, 95 % of which is within
ROUNDING = 1e-6  # [m] of float32 positions; distances below it mean nothing


def wilson(passed: int, starts: int) -> tuple[float, float]:
    """The 95 % interval of a share of which `passed` of `starts` were seen, in 0 to 1.

    (p + z^2/2n -+ z sqrt(p (1 - p) / n + z^2/4n^2)) / (1 + z^2/n) with p = passed / n (Wilson 1927, "Probable
    inference, the law of succession, and statistical inference").

    >>> [round(bound, 2) for bound in wilson(10, 10)]
    [0.72, 1.0]
    """
    p, n = passed / starts, starts
    middle, half = p + Z**2 / (2 * n), Z * math.sqrt(p * (1 - p) / n + Z**2 / (4 * n**2))
    return max(0.0, (middle - half) / (1 + Z**2 / n)), min(1.0, (middle + half) / (1 + Z**2 / n))


def kaplan_meier(
    frames: Int[np.ndarray, " runs"], ended: Bool[np.ndarray, " runs"]
) -> tuple[Int[np.ndarray, " steps"], Float[np.ndarray, " steps"]]:
    """The share of runs that are whole after so many frames: where it falls, and to what (Kaplan and Meier 1958,
    "Nonparametric estimation from incomplete observations"). A run that came to its end leaves without having fallen.

    Args:
        frames: That each run was whole for, shape (N,).
        ended: Did it end there? Else nothing is known of it from there on; shape (N,).
    """
    steps, shares, share = [0], [1.0], 1.0
    for frame in np.unique(frames[ended]):
        share *= 1 - np.sum(ended & (frames == frame)) / np.sum(frames >= frame)
        steps.append(int(frame))
        shares.append(float(share))
    return np.array(steps), np.array(shares)


def growth_rate(apart: Float[np.ndarray, " frames"], fps: float) -> float | None:
    """The rate at which a distance grows [1/s]: the slope of its logarithm over time, by least squares. Below 0 it
    shrinks. None where fewer than three frames are apart by more than rounding.

    Args:
        apart: The distance in each frame [m], shape (T,).
        fps: Frames a second.
    """
    known = np.flatnonzero(np.isfinite(apart) & (apart > ROUNDING))
    return float(np.polyfit(known / fps, np.log(apart[known]), 1)[0]) if len(known) >= 3 else None
