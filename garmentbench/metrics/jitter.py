"""Jitter: acceleration that the reference does not have.

    jitter = mean_t mean_i max(0, |a_ti| - |a*_ti|),   a_t = (x_t+1 - 2 x_t + x_t-1) fps^2    [m/s^2]

with a of the prediction and a* of the reference.

When it lies. Only the sizes of accelerations are compared: a motion that is right but late shows some jitter where the
reference happens to be calm. A garment that doesn't move relative to a calm body has none at all, however wrong: read
`liveliness` beside it. Differences of frames amplify rounding: at 30 fps and 1 m from the origin float32 adds about
1e-4 m/s^2, at 1 km 0.1 m/s^2.
"""

import numpy as np
from jaxtyping import Float

from garmentbench.geometry.mesh import lengths
from garmentbench.metrics.metric import Metric


def accelerations(
    positions: Float[np.ndarray, "frames vertices 3"], fps: float
) -> Float[np.ndarray, "frames-2 vertices"]:
    """Sizes of accelerations [m/s^2], shape (T - 2, V), of positions [m], shape (T, V, 3)."""
    return lengths(np.diff(positions, n=2, axis=0)) * fps**2


def jitter(
    predicted: Float[np.ndarray, "frames vertices 3"], reference: Float[np.ndarray, "frames vertices 3"], fps: float
) -> float:
    """Mean excess of acceleration over the reference's [m/s^2], of positions [m], shape (T, V, 3); NaN for T < 3."""
    if len(predicted) < 3:
        return float("nan")
    excess = accelerations(predicted, fps) - accelerations(reference, fps)
    return float(np.maximum(excess, 0).mean(dtype=np.float64))


JITTER = Metric("jitter", "m/s^2", "jitter", lambda m: jitter(m.predicted, m.reference, m.template.fps), compares=True)
