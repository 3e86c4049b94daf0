"""L2: how far the prediction is from the reference.

    l2 = 100 / (T V) sum_t sum_i |x_ti - y_ti|    [cm], x predicted and y reference positions [m]

`one_step_l2` is the l2 of predictions that each start from three true frames (teacher-forced); `rollout_l2` is that
of a free-running roll-out over its first k predicted frames, k being the column `horizon`.

When it lies. Vertices that slide along the cloth count as errors though nobody sees them, and a smooth average of all
possible folds scores better than sharp folds in the wrong place: read `liveliness` beside it. Dense regions of the
mesh weigh more than coarse ones. The reference is one run of a simulator: where cloth is chaotic another run is as
right, and `error` is measured against all of them. A difference below the `spread` means nothing. A free roll-out
that over its whole length is nearer to this one run than half the spread is marked: by the triangle inequality no
prediction that doesn't know the run comes so near on average, so it may have read it. The paper doesn't define its
L2; this one is ours.
"""

import numpy as np
from jaxtyping import Float

from garmentbench.geometry.mesh import lengths
from garmentbench.metrics.metric import Metric


def frame_l2(
    predicted: Float[np.ndarray, "frames vertices 3"], reference: Float[np.ndarray, "frames vertices 3"]
) -> Float[np.ndarray, " frames"]:
    """L2 of each frame [cm], shape (T,), of positions [m], shape (T, V, 3). NaN where a position is not finite."""
    return 100 * lengths(predicted - reference).mean(axis=-1, dtype=np.float64)


def l2(predicted: Float[np.ndarray, "frames vertices 3"], reference: Float[np.ndarray, "frames vertices 3"]) -> float:
    """Mean L2 [cm] of positions [m], shape (T, V, 3); NaN if any position is not finite."""
    return float(frame_l2(predicted, reference).mean())


ROLLOUT_L2 = Metric("rollout_l2", "cm", "roll-out", lambda m: l2(m.predicted, m.reference), whole=False, compares=True)
ONE_STEP_L2 = Metric("one_step_l2", "cm", "1-step", lambda m: l2(m.predicted, m.reference), whole=False)
