"""Putting a garment outside without an optimiser (option `Collision.solver`). Ours, not the paper's.

A vertex's plane is fixed for the frame, so what it lacks is known at once. Only the cloth round it has to follow: what
was put out is smoothed over the mesh, and what smoothing took back is put out again.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from jaxtyping import Float, Int

from garmentbench.geometry.mesh import unique_edges
from garmentbench.geometry.weld import weld
from garmentbench.methods.motion_guided.body_surface import BodySurface, Planes
from garmentbench.methods.motion_guided.config import Collision
from garmentbench.sequence import Body


def neighbour_means(count: int, faces: Int[np.ndarray, "faces 3"], seams: Int[np.ndarray, "seams 2"]) -> sp.csr_matrix:
    """Matrix, shape (V, V), that gives each of `count` vertices the mean of its own and its neighbours' values; copies
    of a point at a seam have the same neighbours."""
    point, points = weld(count, seams)
    edges = unique_edges(point[faces])
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


@dataclass(frozen=True)
class PushOut:
    """Puts a garment outside of a body.

    Attributes:
        surface: Of the body.
        neighbours: See `neighbour_means`.
        options: `rounds`, `passes` and `clearance` count.
    """

    surface: BodySurface
    neighbours: sp.csr_matrix
    options: Collision

    @classmethod
    def of(
        cls,
        rest: Float[np.ndarray, "vertices 3"],
        faces: Int[np.ndarray, "faces 3"],
        seams: Int[np.ndarray, "seams 2"],
        body: Body,
        options: Collision,
    ) -> "PushOut":
        """For a garment of rest shape `rest` [m], whose `seams` are pairs of copies of a point."""
        return cls(BodySurface(body, rest), neighbour_means(len(rest), faces, seams), options)

    def __call__(
        self,
        garment: Float[np.ndarray, "vertices 3"],
        body: Float[np.ndarray, "body 3"],
        planes: Planes | None = None,
    ) -> Float[np.ndarray, "vertices 3"]:
        """The garment [m], put before the planes of the body [m] that are nearest to it, and to where it then is; the
        array itself where all of it is before them. planes: The nearest ones, where they are known."""
        o = self.options
        for k in range(o.passes):
            if planes is None or k > 0:
                planes = self.surface.planes(garment, body)
            if not (planes.depths(garment) > 0).any():
                break
            garment = garment + pushed_out(planes, garment, self.neighbours, o.rounds, o.clearance)
        return garment
