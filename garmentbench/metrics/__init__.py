"""What is measured. One file a metric: what it measures, how, when it lies, its formula, and the `Metric` itself."""

from garmentbench.errors import unknown_name
from garmentbench.metrics.change import CHANGE
from garmentbench.metrics.difference import DIFFERENCES
from garmentbench.metrics.dihedral_rms import DIHEDRAL_RMS
from garmentbench.metrics.displacement_spectrum import DISPLACEMENT_SPECTRUM
from garmentbench.metrics.energy_left import ENERGY_LEFT
from garmentbench.metrics.ensemble import ENERGY_SCORE, ERROR, ERROR_OVER_SPREAD
from garmentbench.metrics.faces_inside import FACES_INSIDE, SKIN_FRAMES
from garmentbench.metrics.interpenetration import INTERPENETRATION, INTERPENETRATION_BEFORE
from garmentbench.metrics.interpenetration_strict import DEPTH_P95, INTERPENETRATION_STRICT
from garmentbench.metrics.jitter import JITTER
from garmentbench.metrics.l2 import ONE_STEP_L2, ROLLOUT_L2
from garmentbench.metrics.liveliness import LIVELINESS
from garmentbench.metrics.metric import Metric, Motion, scores
from garmentbench.metrics.ms_per_frame import TIMES
from garmentbench.metrics.normal_angle import NORMAL_ANGLE
from garmentbench.metrics.novelty import NOVEL_FRAMES, NOVELTY_CORRELATION
from garmentbench.metrics.push_growth import PUSH_GROWTH
from garmentbench.metrics.self_intersection import CROSSING_FACES_MAX, SELF_INTERSECTION
from garmentbench.metrics.skill import SKILL
from garmentbench.metrics.spread import SPREAD
from garmentbench.metrics.stable_frames import STABLE_FRAMES
from garmentbench.metrics.strain import STRAIN_MEAN, STRAIN_P95, STRAIN_P99_MAX

__all__ = ["METRICS", "STUDY_METRICS", "Metric", "Motion", "metric", "scores"]

METRICS = {  # what every roll-out is scored by
    m.name: m
    for m in (
        ROLLOUT_L2,
        ONE_STEP_L2,
        ERROR,
        ERROR_OVER_SPREAD,
        ENERGY_SCORE,
        STABLE_FRAMES,
        SELF_INTERSECTION,
        STRAIN_P95,
        JITTER,
        LIVELINESS,
        INTERPENETRATION,
        INTERPENETRATION_STRICT,
        DEPTH_P95,
        FACES_INSIDE,
        SKIN_FRAMES,
        INTERPENETRATION_BEFORE,
        DIHEDRAL_RMS,
        NORMAL_ANGLE,
        DISPLACEMENT_SPECTRUM,
        NOVELTY_CORRELATION,
        NOVEL_FRAMES,
        *TIMES,
    )
}
STUDY_METRICS = {  # numbers that only some table has; their `compute` takes what its own signature says
    m.name: m
    for m in (
        SKILL,
        SPREAD,
        PUSH_GROWTH,
        CHANGE,
        *DIFFERENCES,
        ENERGY_LEFT,
        CROSSING_FACES_MAX,
        STRAIN_MEAN,
        STRAIN_P99_MAX,
    )
}


def metric(name: str) -> Metric:
    """The metric of that name. Raises `UsageError` for an unknown one."""
    known = METRICS | STUDY_METRICS
    if name not in known:
        raise unknown_name("metric", name, list(known))
    return known[name]
