"""Blend weights that spread over a joint, so that skin rolls into a crease where narrow ones fold it through itself.

Between two bones whose weights change within a finger's breadth, skinning turns faces inside out in armpits, elbows,
groins and the hollows of knees. Where skin passes through skin there is no place for cloth.
"""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

SPREAD = 0.035  # [m] standard deviation of what one vertex' weights are spread over
AS_THEY_ARE = ("head", "hand", "foot", "toes")  # fine forms, and bare
_LEAST = 0.02  # cotangent of an edge: the faces' angles there would pull weights below 0


def spread(weights: np.ndarray, vertices: np.ndarray, faces: np.ndarray, names: list[str]) -> np.ndarray:
    """Weights that have flowed over the skin as heat does, one implicit step of SPREAD^2 / 2.

    Args:
        weights: Rows sum to 1, shape (V, J).
        vertices: At rest [m], shape (V, 3).
        faces: Shape (F, 3).
        names: Of the joints.
    """
    flowing, area = _cotangents(vertices, faces)
    flown = splu(sp.csc_array(sp.diags_array(area) + SPREAD**2 / 2 * flowing)).solve(area[:, None] * weights)
    soft = weights[:, [name.split(".")[0] not in AS_THEY_ARE for name in names]].sum(axis=1, keepdims=True)
    out = (1 - soft) * weights + soft * np.maximum(flown, 0.0)
    return out / out.sum(axis=1, keepdims=True)


def _cotangents(vertices: np.ndarray, faces: np.ndarray) -> tuple[sp.csr_array, np.ndarray]:
    """The cotangent Laplacian, shape (V, V), and the vertices' areas [m^2], shape (V,)."""
    count = len(vertices)
    entries, area = [], np.zeros(count)
    for k in range(3):
        o, i, j = (np.roll(faces, -k, axis=1)[:, c] for c in range(3))
        a, b = vertices[i] - vertices[o], vertices[j] - vertices[o]
        double = np.linalg.norm(np.cross(a, b), axis=1)
        half = np.maximum(np.sum(a * b, axis=1) / np.maximum(double, 1e-12), _LEAST) / 2
        entries.append(sp.coo_array((half, (i, j)), (count, count)))
        area += np.bincount(o, double / 6, count)
    joined = sp.csr_array(sum(entries[1:], entries[0]))
    joined = joined + joined.T
    return sp.csr_array(sp.diags_array(joined.sum(axis=1)) - joined), area
