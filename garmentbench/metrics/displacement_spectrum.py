"""Has the cloth as much shape at every scale as the reference: folds, waves and wrinkles of each width?

    E_k(x) = mean over t and points of |S^(n_k) x_t - S^(n_k+1) x_t|^2,   n = 0, 1, 2, 4, 8, 16, 32    [m^2]
    displacement_spectrum = mean_k |log2(E_k(prediction) / E_k(reference))|    [1]

S smooths once: half of each point and half of its neighbours' mean, by the cotangents of the cloth without load, so
that flat cloth stays as it is on any mesh (seams sewn; a border's points have their neighbours along it). Two
neighbouring powers differ by what has a width of about sqrt(n) edges: bands of an octave, without eigenvectors. 0 is
the reference's spectrum; 1: twice or half its energy in the mean band.

When it lies. It knows neither place nor time: the right folds in the wrong place have the right spectrum. What the body
forces on the cloth (a shoulder's roundness) is in it on both sides, and makes missing folds look smaller. Noise from
vertex to vertex makes up for missing wrinkles in the finest band. It compares nothing across meshes.
"""

from itertools import pairwise

import numpy as np
import scipy.sparse as sp
from jaxtyping import Float

from garmentbench.geometry.cloth_rest import cloth_at_rest
from garmentbench.geometry.mesh import border_edges
from garmentbench.geometry.weld import weld
from garmentbench.metrics.metric import Metric, Motion, blocks
from garmentbench.sequence import Garment

POWERS = (0, 1, 2, 4, 8, 16, 32)
LEAST = 1e-3  # of the mean weight: an obtuse triangle's negative cotangent would not smooth


def smoother(garment: Garment) -> sp.csr_matrix:
    """S of the points of a sewn garment, shape (P, P)."""
    point, count = weld(len(garment.rest), garment.seams)
    corners, faces = cloth_at_rest(garment)[garment.faces], point[garment.faces]
    to, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cotangent = (to * back).sum(axis=2) / np.maximum(np.linalg.norm(np.cross(to, back), axis=2), 1e-12)
    rows, columns = np.roll(faces, -1, axis=1).ravel(), np.roll(faces, 1, axis=1).ravel()  # the edge across the corner
    weights = sp.csr_matrix((cotangent.ravel(), (rows, columns)), shape=(count, count))
    weights = weights + weights.T
    weights.data = np.maximum(weights.data, LEAST * np.abs(weights.data).mean())
    rim = _rim(faces, count)
    inner = np.asarray(rim.sum(axis=1)).ravel() == 0
    weights = sp.diags(inner.astype(float)) @ weights + rim
    around = np.maximum(np.asarray(weights.sum(axis=1)).ravel(), 1e-12)
    return (0.5 * (sp.identity(count) + sp.diags(1 / around) @ weights)).tocsr()


def _rim(faces: np.ndarray, count: int) -> sp.csr_matrix:
    """1 where two points of a border are neighbours along it, shape (P, P)."""
    a, b = border_edges(faces).T
    return sp.csr_matrix((np.ones(2 * len(a)), (np.r_[a, b], np.r_[b, a])), shape=(count, count))


def band_energies(positions: Float[np.ndarray, "frames vertices 3"], garment: Garment) -> Float[np.ndarray, " bands"]:
    """E_k of positions [m], shape (T, V, 3), from the narrowest to the widest band [m^2], shape (6,)."""
    point, count = weld(len(garment.rest), garment.seams)
    first = np.zeros(count, np.int64)
    first[point] = np.arange(len(point))
    smooth, energies = smoother(garment), np.zeros(len(POWERS) - 1)
    for block in blocks(positions[:, first]):
        x = (block - block.mean(axis=1, keepdims=True)).transpose(1, 0, 2).reshape(count, -1)
        for k, (low, high) in enumerate(pairwise(POWERS)):
            smoothed = x
            for _ in range(high - low):
                smoothed = smooth @ smoothed
            energies[k] += np.sum((x - smoothed) ** 2)
            x = smoothed
    return energies / (count * len(positions))


def _energies(positions: np.ndarray, motion: Motion) -> np.ndarray:
    return band_energies(positions, motion.template.garment)


def _distance(motion: Motion) -> float:
    wanted, found = motion.once(_energies, motion.reference), motion.once(_energies, motion.predicted)
    there = wanted > 0
    return float(np.mean(np.abs(np.log2(found[there] / wanted[there])))) if there.any() else float("nan")


DISPLACEMENT_SPECTRUM = Metric(
    "displacement_spectrum",
    "1",
    "spectrum off",
    _distance,
)
