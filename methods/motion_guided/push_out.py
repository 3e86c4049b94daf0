"""Putting a garment outside without an optimiser (option `Collision.solver`). Ours, not the paper's.

A vertex's plane is fixed for the frame, so what it lacks is known at once. Only the cloth round it has to follow: what
was put out is smoothed over the mesh, and what smoothing took back is put out again.
"""

import numpy as np
import scipy.sparse as sp

from garmentbench.geometry.mesh import unique_edges
from garmentbench.geometry.weld import weld
from garmentbench.methods.motion_guided.body_surface import Planes
from garmentbench.methods.motion_guided.canonical import Canonical


def neighbour_means(canonical: Canonical) -> sp.csr_matrix:
    """Matrix, shape (V, V), that gives each vertex the mean of its own and its neighbours' values; copies of a point at
    a seam have the same neighbours."""
    count = len(canonical.rest)
    point, points = weld(count, canonical.seams)
    edges = unique_edges(point[canonical.faces])
    rows, columns = np.concatenate([edges, edges[:, ::-1], np.repeat(np.arange(points)[:, None], 2, axis=1)]).T
    near = sp.csr_matrix((np.ones(len(rows)), (rows, columns)), (points, points))
    copies = sp.csr_matrix((np.ones(count), (point, np.arange(count))), (points, count))
    of_point = near @ sp.diags(1 / np.asarray(copies.sum(axis=1)).ravel()) @ copies
    return sp.csr_matrix((sp.diags(1 / np.asarray(near.sum(axis=1)).ravel()) @ of_point)[point], dtype=np.float32)


def pushed_out(
    planes: Planes, garment: np.ndarray, neighbours: sp.csr_matrix, rounds: int, clearance: float
) -> np.ndarray:
    """How far each vertex has to move [m], shape (V, 3), so that none is behind its plane, smooth over the cloth.

    Args:
        planes: Of the vertices.
        garment: Vertices [m], shape (V, 3).
        neighbours: See `neighbour_means`.
        rounds: Of smoothing and putting back.
        clearance: How far before its plane a vertex is put that is behind it [m].
    """
    depths, normals = planes.depths(garment), planes.normals
    depths = depths + np.float32(clearance) * (depths > 0)
    offset = np.maximum(depths, 0)[:, None] * normals
    for _ in range(rounds):
        offset = neighbours @ offset
        lacking = np.maximum(depths - np.einsum("vx,vx->v", offset, normals), 0)
        offset += lacking[:, None] * normals
    return offset
