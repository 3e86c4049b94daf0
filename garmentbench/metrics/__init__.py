"""What is measured. One file a metric; its docstring says what it measures, how, and when it lies."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Metric:
    """A metric.

    Attributes:
        name: As in results.csv.
        unit: Its unit.
        needs_body: It means something only on a skin or an inner garment; elsewhere it has no row.
        module: The module that explains it.
        best: "low", "high", or "one" (the nearer to 1 the better).
    """

    name: str
    unit: str
    module: str
    needs_body: bool = False
    best: str = "low"


METRICS = {
    m.name: m
    for m in (
        Metric("one_step_l2", "cm", "l2"),
        Metric("rollout_l2", "cm", "l2"),
        Metric("interpenetration", "%", "interpenetration", needs_body=True),
        Metric("interpenetration_before", "%", "interpenetration", needs_body=True),
        Metric("interpenetration_strict", "%", "interpenetration_strict", needs_body=True),
        Metric("depth_p95", "mm", "interpenetration_strict", needs_body=True),
        Metric("self_intersection", "%", "self_intersection"),
        Metric("strain_p95", "%", "strain"),
        Metric("strain_p99_max", "%", "strain"),
        Metric("jitter", "m/s^2", "jitter"),
        Metric("liveliness", "1", "liveliness", best="one"),
        Metric("skill", "1", "skill", best="high"),
        Metric("stable_frames", "frames", "stable_frames", best="high"),
        Metric("energy_left", "%", "energy_left"),
        Metric("change", "cm", "change"),
        Metric("difference", "cm", "difference"),
        Metric("difference_p95", "cm", "difference"),
        Metric("ms_per_frame", "ms", "ms_per_frame"),
        Metric("ms_per_frame_p95", "ms", "ms_per_frame"),
        Metric("ms_prepare", "ms", "ms_per_frame"),
        Metric("ms_predict", "ms", "ms_per_frame"),
        Metric("ms_collide", "ms", "ms_per_frame"),
    )
}
