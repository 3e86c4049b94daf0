"""Difference: how far two simulations of the same scene are apart, neither of which is the truth.

    difference = 100 / (T V) sum_t sum_i |x_ti - y_ti|    [cm]
    difference_p95 = 95th percentile of 100 |x_ti - y_ti| over all frames and vertices    [cm]

x, y: positions by the same simulator with another step, start or mesh (the convergence study), or by two simulators
(the cross-check). Vertices are compared one to one; of a refined mesh those that it shares with the coarse one.

When it lies. A small difference between runs of one simulator says that it agrees with itself, not that it is right:
what both leave out (contact between vertices, the body's own softness) does not show. Two engines may differ by the
material as much as by their errors. A mean over still and moving frames is smaller than that over the moving ones.
"""

import numpy as np
from jaxtyping import Float

from garmentbench.metrics.metric import Metric


def difference(first: Float[np.ndarray, "frames vertices 3"], second: Float[np.ndarray, "frames vertices 3"]) -> float:
    """Mean distance [cm] of positions [m], both of shape (T, V, 3)."""
    return float(distances_cm(first, second).mean())


def difference_p95(
    first: Float[np.ndarray, "frames vertices 3"], second: Float[np.ndarray, "frames vertices 3"]
) -> float:
    """95th percentile of the distances [cm] of positions [m], both of shape (T, V, 3)."""
    return float(np.percentile(distances_cm(first, second), 95))


def distances_cm(
    first: Float[np.ndarray, "frames vertices 3"], second: Float[np.ndarray, "frames vertices 3"]
) -> Float[np.ndarray, "frames vertices"]:
    """Distance of each vertex in each frame [cm], shape (T, V), of positions [m], both of shape (T, V, 3)."""
    return 100 * np.linalg.norm(np.asarray(first, np.float64) - np.asarray(second, np.float64), axis=-1)


DIFFERENCE = Metric("difference", "cm", "difference", difference)
DIFFERENCE_P95 = Metric("difference_p95", "cm", "95th percentile", difference_p95)
DIFFERENCES = (DIFFERENCE, DIFFERENCE_P95)
