"""The body as the collision stage sees it: a tangent plane for each garment vertex."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from garmentbench.geometry.mesh import corner_matrix, face_normals, normalised
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.sequence import Body

ROUNDED = 1e-5  # [m]


@dataclass(frozen=True)
class Planes:
    """Tangent planes of each garment vertex's nearest body vertex: points [m] and unit normals, shape (V, 3)."""

    points: np.ndarray
    normals: np.ndarray

    def depths(self, garment: np.ndarray) -> np.ndarray:
        """-o [m], shape (V,), of garment vertices [m], shape (V, 3): how far each is behind its plane."""
        return np.einsum("vx,vx->v", self.points - garment, self.normals)


class BodySurface:
    """A body mesh, of whose vertices only those are looked at that can be nearest to a garment.

    Args:
        body: The body.
        garment: The garment at rest on it [m], shape (V, 3).
    """

    def __init__(self, body: Body, garment: np.ndarray) -> None:
        self.faces = body.faces
        self.corners = corner_matrix(body.faces, len(body.rest))
        _, self.at_rest = nearest_vertices(garment, body.rest)

    def planes(self, garment: np.ndarray, body: np.ndarray) -> Planes:
        """Planes of garment vertices [m], shape (V, 3), on body vertices [m], shape (B, 3), found once a frame."""
        nearest = self.nearest(garment, body)
        chosen, place = np.unique(nearest, return_inverse=True)
        return Planes(body[nearest], self.normals(body, chosen)[place])

    def nearest(self, garment: np.ndarray, body: np.ndarray) -> np.ndarray:
        """Index of each garment vertex's nearest body vertex, shape (V,), as `nearest_vertices` gives it.

        None is farther than the one that was nearest at rest, so all lie in a box.
        """
        farthest = np.linalg.norm(garment - body[self.at_rest], axis=1, keepdims=True) + ROUNDED
        low, high = (garment - farthest).min(axis=0), (garment + farthest).max(axis=0)
        inside = np.flatnonzero(((body >= low) & (body <= high)).all(axis=1))
        return inside[nearest_vertices(garment, body[inside])[1]]

    def normals(self, body: np.ndarray, chosen: np.ndarray) -> np.ndarray:
        """`vertex_normals` of some vertices, shape (K,), alone, shape (K, 3)."""
        rows = self.corners[chosen]
        faces, column = np.unique(rows.indices, return_inverse=True)
        near = sp.csr_matrix((rows.data, column.ravel(), rows.indptr), (len(chosen), len(faces)))
        return normalised(near @ face_normals(body, self.faces[faces])).astype(body.dtype)
