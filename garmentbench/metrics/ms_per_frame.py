"""Time a frame, batch 1, after warm-up, synchronised with the device.

    ms_per_frame, ms_per_frame_p95: median and 95th percentile over frames of a step's wall time    [ms]
    ms_prepare, ms_predict, ms_collide: medians of its parts: input maps and the like, prediction, collision stage

The parts' medians need not add up to the whole's.

When it lies. It is the time on one machine, at one number of threads and one precision, all named in the run: compare
within a table, not between tables. Other work on the machine shows in the 95th percentile first. What is done once at
`begin` doesn't count. A step that is timed once a frame can't tell a pipeline's throughput.
"""

import numpy as np


def time_per_frame(ms: np.ndarray) -> dict[str, float]:
    """The five times [ms] by metric name, from parts (prepare, predict, collide) of each frame [ms], shape (T, 3).

    Frames with NaN are left out; NaN where none is left.
    """
    timed = ms[np.isfinite(ms).all(axis=1)]
    if not len(timed):
        timed = np.full((1, 3), np.nan)
    total, parts = timed.sum(axis=1), np.median(timed, axis=0)
    names = ("ms_prepare", "ms_predict", "ms_collide")
    whole = {"ms_per_frame": float(np.median(total)), "ms_per_frame_p95": float(np.percentile(total, 95))}
    return whole | {name: float(part) for name, part in zip(names, parts)}
