"""Strain: how much the cloth is stretched or squeezed.

    strain_p95 = 100 mean_t p95_e | l_te / L_e - 1 |,   l an edge's length in frame t, L without load    [%]
    strain_mean = 100 mean_t mean_e | l_te / L_e - 1 |,   strain_p99_max = 100 max_t p99_e | l_te / L_e - 1 |    [%]

The last two are the simulator's own, taken while it runs.

When it lies. It doesn't know the material: cloth that should stretch is judged as cloth that should not, so compare it
with the reference's own strain, which stands beside it. Short edges have large strains for a small error; the 95th
percentile leaves the worst twentieth out, and with it a single torn seam. Bending doesn't show.
"""

import numpy as np
from jaxtyping import Float, Int

from garmentbench.geometry.cloth_rest import rest_lengths
from garmentbench.geometry.mesh import edge_lengths
from garmentbench.metrics.metric import Metric, Motion


def strain_percentile(
    garment: Float[np.ndarray, "frames vertices 3"],
    edges: Int[np.ndarray, "edges 2"],
    lengths: Float[np.ndarray, " edges"],
    q: float,
) -> Float[np.ndarray, " frames"]:
    """Percentile `q` of the absolute edge strain in each frame, shape (T,).

    Args:
        garment: [m], shape (T, V, 3), finite.
        edges: Pairs of vertices, shape (E, 2).
        lengths: Of the edges without load [m], shape (E,).
        q: From 0 to 100.
    """
    edges, lengths = edges[lengths > 0], lengths[lengths > 0]
    return np.array([np.percentile(np.abs(edge_lengths(g, edges) / lengths - 1), q) for g in garment])


def strain_p95(
    garment: Float[np.ndarray, "frames vertices 3"],
    edges: Int[np.ndarray, "edges 2"],
    lengths: Float[np.ndarray, " edges"],
) -> float:
    """95th percentile of the absolute edge strain [%], mean over frames; arguments as for `strain_percentile`."""
    return float(100 * strain_percentile(garment, edges, lengths, 95).mean())


def _strain_p95(positions: np.ndarray, motion: Motion) -> float:
    return strain_p95(positions, *rest_lengths(motion.template.garment))


def strain_mean(mean_strain: Float[np.ndarray, " frames"]) -> float:
    """Mean over frames [%] of each frame's mean absolute edge strain; frames with NaN are left out."""
    return 100 * float(np.nanmean(mean_strain))


def strain_p99_max(p99_strain: Float[np.ndarray, " frames"]) -> float:
    """Largest [%] of the frames' 99th percentiles of absolute edge strain; frames with NaN are left out."""
    return 100 * float(np.nanmax(p99_strain))


STRAIN_P95 = Metric(
    "strain_p95",
    "%",
    "strain, 95th percentile",
    lambda m: m.once(_strain_p95, m.predicted),
)
STRAIN_MEAN = Metric("strain_mean", "%", "strain, mean", strain_mean)
STRAIN_P99_MAX = Metric("strain_p99_max", "%", "largest strain, 99th percentile", strain_p99_max)
