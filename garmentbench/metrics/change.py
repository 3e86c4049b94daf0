"""Change: how far a stressed run ends up from the same one without the stress.

    change = 100 / (T V) sum_t sum_i |A^-1 x_ti - y_ti|    [cm]

x: positions in the stressed scene, A: where that scene was moved and turned to, y: positions of the same simulator or
method in the scene without the stress. It is measured where the stress should change nothing in the end: the scene
moved far away (0 for a method that does not depend on where it is) and a push at the start (0 once it has died out).

When it lies. A method that never moves the cloth doesn't change either: read `rollout_l2` beside it.
"""

import numpy as np
from jaxtyping import Float

from garmentbench.metrics.l2 import l2
from garmentbench.metrics.metric import Metric


def change(
    stressed: Float[np.ndarray, "frames vertices 3"],
    plain: Float[np.ndarray, "other_frames vertices 3"],
    turn_degrees: float,
    translate: tuple[float, float, float],
) -> float:
    """Mean distance [cm] over the frames that both have, of positions [m], shape (T, V, 3)."""
    frames = min(len(stressed), len(plain))
    c, s = np.cos(np.radians(turn_degrees)), np.sin(np.radians(turn_degrees))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    back = (np.asarray(stressed[:frames], np.float64) - np.array(translate)) @ turn  # rows times turn: its inverse
    return l2(back, np.asarray(plain[:frames], np.float64))


CHANGE = Metric("change", "cm", "changed by", change)
