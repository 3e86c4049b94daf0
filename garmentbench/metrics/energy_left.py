"""Energy left: does the cloth come to rest when the body does?

    energy_left = 100 E(last 30 frames) / E(frames up to the freeze)    [%],
    E = mean over frames of sum_i m_i |x_t - x_t-1|^2

Cloth on a body that stands still has to lose its kinetic energy; a solver or method that feeds it keeps some for ever.

When it lies. It is a ratio to the walking garment's energy, most of which is the walk itself: 0.1 % of it can still be
seen as a tremble (read the last frames of the recording). It is NaN where the garment did not move before the freeze.
"""

import numpy as np
from jaxtyping import Float

from garmentbench.metrics.metric import Metric

LAST = 30  # frames


def energy_left(
    garment: Float[np.ndarray, "frames vertices 3"], freeze_after: int, mass: Float[np.ndarray, " vertices"]
) -> float:
    """Kinetic energy of the last 30 frames over that before the body froze [%].

    Args:
        garment: [m], shape (T, V, 3), finite.
        freeze_after: Frame at which the body begins to stand still.
        mass: Of each vertex, in any unit, shape (V,).
    """
    energy = np.square(np.diff(garment, axis=0), dtype=np.float64).sum(axis=-1) @ mass
    before = energy[:freeze_after].mean()
    return float(100 * energy[-LAST:].mean() / before) if before > 0 else float("nan")


ENERGY_LEFT = Metric("energy_left", "%", "energy left", energy_left)
