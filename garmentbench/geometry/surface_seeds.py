"""Seed points inside the triangles of a body, for models of others whose seeds are no vertices."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from garmentbench.geometry.mesh import normalised, vertex_normals


@dataclass(frozen=True)
class SurfaceSeeds:
    """Seed points in triangles of a body, N of them, with what their frames are made from.

    Attributes:
        corners: Body vertices of each seed's triangle, shape (N, 3), int64.
        weights: Their barycentric weights, shape (N, 3).
        labels: Body part of each, shape (N,), int64; None where the body has no parts.
        rest: Canonical positions [m], shape (N, 3).
        frames: Canonical frames, columns tangent, bitangent and normal, shape (N, 3, 3).
        faces: The body's triangles round the corners, shape (K, 3).
    """

    corners: Int[np.ndarray, "seeds 3"]
    weights: Float[np.ndarray, "seeds 3"]
    labels: Int[np.ndarray, " seeds"] | None
    rest: Float[np.ndarray, "seeds 3"]
    frames: Float[np.ndarray, "seeds 3 3"]
    faces: Int[np.ndarray, "faces 3"]


def surface_seeds(
    rest: Float[np.ndarray, "vertices 3"],
    faces: Int[np.ndarray, "faces 3"],
    corners: Int[np.ndarray, "seeds 3"],
    weights: Float[np.ndarray, "seeds 3"],
    labels: Int[np.ndarray, " seeds"] | None = None,
) -> SurfaceSeeds:
    """Seed points at given places, see `SurfaceSeeds`, on a canonical body [m], shape (B, 3), with faces (F, 3)."""
    near = faces[np.isin(faces, corners).any(axis=1)]
    return SurfaceSeeds(
        corners, weights, labels, _positions(rest, corners, weights), _frames(rest, near, corners, weights), near
    )


def surface_frames(
    body: Float[np.ndarray, "*n vertices 3"], seeds: SurfaceSeeds
) -> tuple[Float[np.ndarray, "*n seeds 3"], Float[np.ndarray, "*n seeds 3 3"], Float[np.ndarray, "*n seeds 3"]]:
    """Where the seeds are and how they have turned; as `geometry.seeds.seed_frames`.

    A seed's normal is the vertex normals' mean by its weights; its tangent is the first edge of its triangle.
    """
    frames = _frames(body, seeds.faces, seeds.corners, seeds.weights)
    rotations = frames @ np.swapaxes(seeds.frames, -1, -2)
    positions = _positions(body, seeds.corners, seeds.weights)
    return positions.astype(body.dtype), rotations.astype(body.dtype), frames[..., 2].astype(body.dtype)


def _positions(body: np.ndarray, corners: np.ndarray, weights: np.ndarray) -> np.ndarray:
    return np.einsum("...nkx,nk->...nx", body[..., corners, :], weights)


def _frames(body: np.ndarray, faces: np.ndarray, corners: np.ndarray, weights: np.ndarray) -> np.ndarray:
    normals = normalised(_positions(vertex_normals(body, faces), corners, weights))
    edge = body[..., corners[:, 1], :] - body[..., corners[:, 0], :]
    tangents = normalised(edge - np.sum(edge * normals, axis=-1, keepdims=True) * normals)
    return np.stack([tangents, np.cross(normals, tangents), normals], axis=-1)
