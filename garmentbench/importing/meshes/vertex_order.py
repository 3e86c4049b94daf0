"""Which vertices of a frame are not where their neighbours are: some of them have changed their places.

A median over edges doesn't see that two vertices of a thousand were swapped. Here each vertex is judged: by how much
longer its edges became, against their length or the mesh's median length, whichever is more; and by how much farther it
is from the middle of its neighbours, against its mean distance from that. Skin stretches where arms are raised, and
cloth folds, but the product of both stays small: measured at most 0.07 on the suite's garments against their rest
shapes, and 0.5 on its bodies in recorded dances. Two vertices swapped across a garment have 0.4 and more, across a
body 1.7.
"""

import numpy as np
import scipy.sparse as sp

from garmentbench.geometry.mesh import unique_edges

CLOTH, SKIN = 0.3, 1.0  # of the product, above which a vertex is out of place
_STRETCHED = 0.5  # at least one edge of such a vertex is longer by this


class Order:
    """A shape that frames are compared with.

    Args:
        shape: Positions, shape (V, 3).
        faces: Shape (F, 3).
        limit: `CLOTH` or `SKIN`.
    """

    def __init__(self, shape: np.ndarray, faces: np.ndarray, limit: float = CLOTH) -> None:
        self._edges, self._limit = unique_edges(faces), limit
        a, b = self._edges.T
        ones, count = np.ones(len(a)), len(shape)
        self._sum = sp.csr_matrix((np.tile(ones, 2), (np.r_[a, b], np.r_[b, a])), shape=(count, count))
        self._ends = sp.csr_matrix((np.tile(ones, 2), (np.r_[a, b], np.tile(np.arange(len(a)), 2))), (count, len(a)))
        self._share = 1 / np.maximum(np.asarray(self._sum.sum(axis=1)).ravel(), 1)
        self._length = self._lengths(shape)
        self._unit = np.maximum(self._length, np.median(self._length) if len(a) else 1.0)
        self._apart = self._from_neighbours(shape)

    def off(self, frame: np.ndarray) -> float:
        """Median deviation of a frame's edges from the shape's, as a logarithm; 0 where none can be compared."""
        with np.errstate(all="ignore"):
            ratio = self._lengths(frame) / self._length
        ratio = ratio[np.isfinite(ratio) & (ratio > 0)]
        return float(np.median(np.abs(np.log(ratio)))) if len(ratio) else 0.0

    def misplaced(self, frame: np.ndarray) -> np.ndarray:
        """Vertices that are out of place in a frame of the shape's size, shape (V, 3), or beside such; the worst first,
        shape (N,). One alone can't have changed its place: none then."""
        stretch = (self._lengths(frame) - self._length) / self._unit
        if not (stretch > _STRETCHED).any():
            return np.zeros(0, np.int64)
        mean = self._share * (self._ends @ stretch)
        far = self._ends @ (stretch > _STRETCHED).astype(np.float64) > 0
        product = mean * np.maximum(self._from_neighbours(frame) - self._apart, 0)
        found = np.flatnonzero(far & (product > self._limit))
        return found[np.argsort(-product[found], kind="stable")] if len(found) > 1 else found[:0]

    def _lengths(self, positions: np.ndarray) -> np.ndarray:
        return np.linalg.norm(positions[self._edges[:, 0]] - positions[self._edges[:, 1]], axis=1)

    def _from_neighbours(self, positions: np.ndarray) -> np.ndarray:
        """How far each vertex is from the middle of its neighbours, over their mean distance from that, shape (V,)."""
        middle = self._share[:, None] * (self._sum @ positions)
        a, b = self._edges.T
        ring = np.bincount(a, np.linalg.norm(positions[b] - middle[a], axis=1), len(positions))
        ring += np.bincount(b, np.linalg.norm(positions[a] - middle[b], axis=1), len(positions))
        return np.linalg.norm(positions - middle, axis=1) / np.maximum(self._share * ring, 1e-30)
