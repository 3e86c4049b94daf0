"""Time a frame, batch 1, after warm-up, synchronised with the device.

    ms_per_frame, ms_per_frame_p95: median and 95th percentile over frames of a step's wall time    [ms]
    ms_prepare, ms_predict, ms_collide: medians of its parts: input maps and the like, prediction, collision stage
    ms_processor: median over frames of a step's processor time, of all threads together

The parts' medians need not add up to the whole's.

When it lies. It is the time on one machine, at one number of threads and one precision, all named in the run: compare
within a table, not between tables. What is done once at `begin` doesn't count. A step that is timed once a frame can't
tell a pipeline's throughput.
Other work on the machine makes wall time longer, but not processor time: where a wall time is more than 1.25 times the
processor time of the same steps (and more than 0.05 ms above it), its row is marked "timed under load". A method that
waits (for a file, a server, another process) is marked, too; load goes unmarked where a step's own threads keep more
than one core busy, and on a CUDA device, for which the processor waits, so that no processor time is taken.
"""

import numpy as np
from jaxtyping import Float

from garmentbench.metrics.metric import Metric, Motion

LOAD, SLACK_MS = 1.25, 0.05  # wall time over processor time, and the clocks' own noise [ms]


def timed(ms: Float[np.ndarray, "frames columns"]) -> Float[np.ndarray, "timed columns"]:
    """Frames without NaN; one of NaN where none is left."""
    kept = ms[np.isfinite(ms).all(axis=1)]
    return kept if len(kept) else np.full((1, ms.shape[1]), np.nan)


def percentile(ms: Float[np.ndarray, "frames columns"], q: float = 50) -> float:
    """Percentile over frames of a step's time [ms], of the times of its parts [ms], shape (T, parts)."""
    return float(np.percentile(timed(ms).sum(axis=1), q))


def part(ms: Float[np.ndarray, "frames 3"], k: int) -> float:
    """Median over frames of one part's time [ms], of the times of prepare, predict and collide [ms], shape (T, 3)."""
    return float(np.median(timed(ms)[:, k]))


def under_load(motion: Motion, metric: Metric) -> bool:
    """Was a time taken while the machine did other work? By wall time against processor time, as said above."""
    if motion.ms is None or motion.processor_ms is None or metric is MS_PROCESSOR:
        return False
    q = 95 if metric is MS_PER_FRAME_P95 else 50
    wall, own = percentile(motion.ms, q), percentile(motion.processor_ms[:, None], q)
    return wall > LOAD * own and wall > own + SLACK_MS


MS_PER_FRAME = Metric("ms_per_frame", "ms", "time a frame", lambda m: percentile(m.ms), whole=False)
MS_PER_FRAME_P95 = Metric(
    "ms_per_frame_p95", "ms", "time a frame, 95th percentile", lambda m: percentile(m.ms, 95), whole=False
)
MS_PREPARE = Metric("ms_prepare", "ms", "prepare", lambda m: part(m.ms, 0), whole=False)
MS_PREDICT = Metric("ms_predict", "ms", "predict", lambda m: part(m.ms, 1), whole=False)
MS_COLLIDE = Metric("ms_collide", "ms", "collide", lambda m: part(m.ms, 2), whole=False)
MS_PROCESSOR = Metric(
    "ms_processor",
    "ms",
    "processor time a frame",
    lambda m: percentile(m.processor_ms[:, None]),
    lambda m: m.processor_ms is not None,
    whole=False,
)
TIMES = (MS_PER_FRAME, MS_PER_FRAME_P95, MS_PREPARE, MS_PREDICT, MS_COLLIDE, MS_PROCESSOR)
