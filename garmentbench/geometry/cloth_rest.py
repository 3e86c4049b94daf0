"""Where a garment's cloth is at rest: flat, as it was cut, where that is known; else as it is put on.

The one place for rest lengths and rest areas: the simulator, the metrics and the methods take theirs from here.
"""

import numpy as np
from jaxtyping import Float, Int

from garmentbench.geometry.mesh import edge_lengths, unique_edges
from garmentbench.geometry.weld import weld
from garmentbench.sequence import Garment


def cloth_at_rest(garment: Garment) -> Float[np.ndarray, "vertices 3"]:
    """Where each vertex is in cloth without load [m], shape (V, 3), float64: its pattern, with z = 0, or `rest`.

    A triangle's shape can be taken from it; panels of a pattern lie apart, so that a seam's two sides are two lines.
    """
    if garment.cut is None:
        return garment.rest.astype(np.float64)
    return np.column_stack([garment.cut.astype(np.float64), np.zeros(len(garment.cut))])


def rest_areas(garment: Garment) -> Float[np.ndarray, " faces"]:
    """Area of each face without load [m^2], shape (F,), float64."""
    a, b, c = cloth_at_rest(garment)[garment.faces].transpose(1, 0, 2)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def rest_lengths(garment: Garment) -> tuple[Int[np.ndarray, "edges 2"], Float[np.ndarray, " edges"]]:
    """Edges, lower vertex first, shape (E, 2), and their lengths without load [m], shape (E,), float64.

    The two sides of a seam are sewn to one length, the mean of both.
    """
    edges = unique_edges(garment.faces)
    lengths = edge_lengths(cloth_at_rest(garment), edges)
    point, _ = weld(len(garment.rest), garment.seams)
    _, line = np.unique(np.sort(point[edges], axis=1), axis=0, return_inverse=True)
    line = line.ravel()
    return edges, (np.bincount(line, lengths) / np.bincount(line))[line]
