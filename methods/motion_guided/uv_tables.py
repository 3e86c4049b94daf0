"""Tables of a released model: how values go between vertices and maps in UV space, and the frames of displacements.

Ours follow from the template; a model that was trained with others keeps them (see `authors_model`).
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from garmentbench.geometry.uvmap import Chart


@dataclass(frozen=True)
class UVTables:
    """Tables of a garment of V vertices and maps of S pixels a side.

    Attributes:
        chart: From vertices to a map of S pixels a side.
        pixels: The four pixels of a map of 2 S a side that each vertex is sampled at, shape (V, 4).
        weights: Their weights, shape (V, 4).
        frames: H_0, columns tangent, bitangent and normal, shape (V, 3, 3).
    """

    chart: Chart
    pixels: np.ndarray
    weights: np.ndarray
    frames: np.ndarray

    def sampling(self, size: int) -> sp.csr_matrix:
        """Sampling of a map of `size` pixels a side, 2 S or S, at the vertices, shape (V, size^2).

        A map of S is first made twice as large, bilinearly, its corners staying where they are, as in the authors'
        code.
        """
        large = 2 * self.chart.size
        sampling = table_matrix(self.pixels, self.weights, large)
        return sampling if size == large else sampling @ enlargement(size, large)

    def arrays(self) -> dict[str, np.ndarray]:
        """All of it by name, to be stored among other arrays."""
        chart = {f"table_chart_{name}": np.asarray(value) for name, value in vars(self.chart).items()}
        return chart | {f"table_{name}": getattr(self, name) for name in ("pixels", "weights", "frames")}

    @classmethod
    def from_arrays(cls, arrays: dict[str, np.ndarray]) -> "UVTables | None":
        """What `arrays` gave; None where it is not among the arrays."""
        if "table_frames" not in arrays:
            return None
        size, *rest = (arrays[f"table_chart_{name}"] for name in ("size", "pixels", "vertices", "weights"))
        return cls(Chart(int(size), *rest), *(arrays[f"table_{name}"] for name in ("pixels", "weights", "frames")))


def table_matrix(pixels: np.ndarray, weights: np.ndarray, size: int) -> sp.csr_matrix:
    """Rows of four pixels and weights, shape (V, 4) each, as a matrix, shape (V, size^2)."""
    rows = np.repeat(np.arange(len(pixels)), pixels.shape[1])
    return sp.csr_matrix((weights.ravel(), (rows, pixels.ravel())), (len(pixels), size * size))


def enlargement(small: int, large: int) -> sp.csr_matrix:
    """Bilinear enlargement of square maps with their corner pixels kept in place, shape (large^2, small^2)."""
    at = np.linspace(0, small - 1, large)
    low = np.minimum(np.floor(at).astype(int), small - 2)
    rows, high = np.arange(large), at - low
    line = sp.csr_matrix((np.r_[1 - high, high], (np.r_[rows, rows], np.r_[low, low + 1])), (large, small))
    return sp.csr_matrix(sp.kron(line, line))
