"""From a coarse mesh of a garment to a fine one: what a simulation of the one says of the other."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import KDTree

from garmentbench.geometry.mesh import cross, normalised
from garmentbench.sequence import Garment

_NEAR = 24  # triangles that are looked at for each vertex, those whose centres are nearest


@dataclass(frozen=True)
class Carrier:
    """A fine mesh hung up in a coarse one.

    Attributes:
        corners: Of the coarse triangle that carries each fine vertex, shape (V, 3).
        weights: Barycentric weights of these corners, shape (V, 3).
        offset: From the point that they give to the vertex [m], in the triangle's own frame, shape (V, 3).
    """

    corners: Int[np.ndarray, "vertices 3"]
    weights: Float[np.ndarray, "vertices 3"]
    offset: Float[np.ndarray, "vertices 3"]

    @classmethod
    def of(cls, coarse: Garment, fine: Garment) -> "Carrier":
        """By the UV map, which both meshes of a garment share.

        Not by the nearest point in space: where cloth is folded (pleats) that may lie in another layer. What the coarse
        mesh at rest lacks to the fine one's rest shape is carried along in the triangles' frames, so that at rest, and
        however the whole is moved, the fine mesh is exact.
        """
        triangles, places = coarse.uv[coarse.faces].astype(np.float64), fine.uv.astype(np.float64)
        count = min(_NEAR, len(triangles))
        _, near = KDTree(triangles.mean(axis=1)).query(places, k=count)
        near = np.asarray(near).reshape(len(places), count)
        weights = _weights(triangles[near], places[:, None])
        missed = np.linalg.norm(np.einsum("vtk,vtkc->vtc", weights, triangles[near]) - places[:, None], axis=-1)
        best = np.arange(len(places)), missed.argmin(axis=1)
        corners = coarse.faces[near[best]]
        hung = cls(corners, weights[best], np.zeros((len(places), 3)))
        rest = coarse.rest.astype(np.float64)
        apart = fine.rest.astype(np.float64) - hung(rest)
        return cls(corners, weights[best], np.einsum("vji,vj->vi", _frames(rest[corners]), apart))

    def __call__(self, positions: Float[np.ndarray, "coarse 3"]) -> Float[np.ndarray, "vertices 3"]:
        """Positions of the fine mesh [m], shape (V, 3), of those of the coarse one, shape (C, 3)."""
        triangles = positions[self.corners]
        on = np.einsum("vk,vkc->vc", self.weights, triangles)
        return on + np.einsum("vij,vj->vi", _frames(triangles), self.offset)


def _weights(triangles: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Barycentric weights, shape (V, T, 3), of places, (V, 1, 2), in flat triangles, (V, T, 3, 2); of a place outside
    those of a point on the border."""
    a, b, c = (triangles[..., k, :] for k in range(3))
    u, v, w = b - a, c - a, places - a
    area = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    area = np.where(np.abs(area) < 1e-15, np.inf, area)
    of_b = (w[..., 0] * v[..., 1] - w[..., 1] * v[..., 0]) / area
    of_c = (u[..., 0] * w[..., 1] - u[..., 1] * w[..., 0]) / area
    weights = np.clip(np.stack([1 - of_b - of_c, of_b, of_c], axis=-1), 0, None)
    return weights / weights.sum(axis=-1, keepdims=True)


def _frames(triangles: np.ndarray) -> np.ndarray:
    """Orthonormal frames of triangles, shape (V, 3, 3), columns along the first edge, across it, and the normal."""
    along = normalised(triangles[:, 1] - triangles[:, 0])
    normal = normalised(cross(along, triangles[:, 2] - triangles[:, 0]))
    return np.stack([along, cross(normal, along), normal], axis=-1)
