"""Strain: how much the cloth is stretched or squeezed.

    strain_p95 = 100 mean_t p95_e | l_te / L_e - 1 |,   l an edge's length in frame t, L in the template    [%]

When it lies. It doesn't know the material: cloth that should stretch is judged as cloth that should not, so compare it
with the reference's own strain, which stands beside it. Short edges have large strains for a small error; the 95th
percentile leaves the worst twentieth out, and with it a single torn seam. Bending doesn't show.
"""

import numpy as np

from garmentbench.geometry.mesh import edge_lengths, unique_edges


def strain_p95(garment: np.ndarray, rest: np.ndarray, faces: np.ndarray) -> float:
    """95th percentile of the absolute edge strain [%], mean over frames.

    Args:
        garment: [m], shape (T, V, 3), finite.
        rest: Template [m], shape (V, 3).
        faces: Shape (F, 3).
    """
    edges = unique_edges(faces)
    lengths = edge_lengths(rest.astype(np.float64), edges)
    edges, lengths = edges[lengths > 0], lengths[lengths > 0]
    return float(100 * np.mean([np.percentile(np.abs(edge_lengths(g, edges) / lengths - 1), 95) for g in garment]))
