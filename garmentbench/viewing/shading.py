"""Normals for shading that keep a crease a crease."""

import numpy as np
import scipy.sparse as sp
from jaxtyping import Float, Int

from garmentbench.geometry.mesh import face_normals, normalised

SMOOTH = 181.0  # no crease at all
CREASE = 40.0  # [degrees] faces at a vertex that are turned further against each other are shaded apart


def corner_normals(
    positions: Float[np.ndarray, "vertices 3"], faces: Int[np.ndarray, "faces 3"], crease: float = CREASE
) -> Float[np.ndarray, "faces 3 3"]:
    """Unit normals at the corners of each face, shape (F, 3, 3).

    Each is the mean of the normals of those faces at the vertex that are turned against this one by less than `crease`
    [degrees]. Vertices in the same place, as both copies of a seam's point are, count as one.
    """
    _, point = np.unique(positions, axis=0, return_inverse=True)
    owner = np.repeat(np.arange(len(faces)), 3)
    at = sp.csr_matrix((np.ones(len(owner)), (np.arange(len(owner)), point.ravel()[faces.ravel()])))
    corner, other = (at @ at.T).nonzero()
    normals = face_normals(positions.astype(np.float64), faces)
    near = np.einsum("pc,pc->p", normals[owner[corner]], normals[owner[other]]) > np.cos(np.radians(crease))
    near |= owner[corner] == owner[other]
    sums = np.zeros((len(owner), 3))
    np.add.at(sums, corner[near], normals[owner[other[near]]])
    return normalised(sums).reshape(-1, 3, 3)
