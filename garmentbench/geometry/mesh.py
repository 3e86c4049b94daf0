"""What follows from a triangle mesh: normals, edges, the Laplacian and tangent frames."""

import numpy as np
import scipy.sparse as sp
from jaxtyping import Float, Int


def corner_matrix(faces: Int[np.ndarray, "faces 3"], vertex_count: int) -> sp.csr_matrix:
    """Vertex-face incidence, shape (V, F): 1 where the vertex is a corner of the face."""
    rows, columns = faces.ravel(), np.repeat(np.arange(len(faces)), 3)
    return sp.csr_matrix((np.ones(rows.size, np.float32), (rows, columns)), (vertex_count, len(faces)))


def lengths(vectors: Float[np.ndarray, "*n d"]) -> Float[np.ndarray, "*n"]:
    """Lengths along the last axis: those of `np.linalg.norm`, to the last digit, in a third of its time."""
    total = vectors[..., 0] * vectors[..., 0]
    for k in range(1, vectors.shape[-1]):
        total += vectors[..., k] * vectors[..., k]
    return np.sqrt(total)


def normalised(vectors: Float[np.ndarray, "*n d"]) -> Float[np.ndarray, "*n d"]:
    """Unit vectors along the last axis; a zero vector stays zero."""
    length = lengths(vectors)[..., None]
    return vectors / np.where(length > 0, length, 1)


def cross(u: Float[np.ndarray, "*n 3"], v: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3"]:
    """Cross products along the last axis: those of `np.cross`, to the last digit, and faster."""
    out = np.moveaxis(np.empty((3, *u.shape[:-1]), u.dtype), 0, -1)  # a coordinate after the other in memory
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.multiply(u[..., j], v[..., k], out=out[..., i])
        out[..., i] -= u[..., k] * v[..., j]
    return out


def face_normals(
    positions: Float[np.ndarray, "*n vertices 3"], faces: Int[np.ndarray, "faces 3"]
) -> Float[np.ndarray, "*n faces 3"]:
    """Unit face normals, shape (..., F, 3), of positions [m], shape (..., V, 3)."""
    x = np.moveaxis(positions, -1, 0)  # a coordinate after the other: numpy is slow along an axis of three
    a, b, c = (np.take(x, faces[:, k], axis=-1) for k in range(3))
    return normalised(cross(np.moveaxis(b - a, 0, -1), np.moveaxis(c - a, 0, -1)))


def angles(first: Float[np.ndarray, "*n 3"], second: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n"]:
    """Angles between vectors [rad]; exact for small ones, too."""
    (a, b, c), (x, y, z) = np.moveaxis(first, -1, 0), np.moveaxis(second, -1, 0)
    return np.arctan2(lengths(cross(first, second)), a * x + b * y + c * z)


def vertex_normals(
    positions: Float[np.ndarray, "*n vertices 3"],
    faces: Int[np.ndarray, "faces 3"],
    corners: sp.csr_matrix | None = None,
) -> Float[np.ndarray, "*n vertices 3"]:
    """Unit vertex normals, the uniform average of the faces' unit normals, shape (..., V, 3).

    Args:
        positions: Vertices [m], shape (..., V, 3).
        faces: Triangles, shape (F, 3).
        corners: `corner_matrix(faces, V)`, to spare making it when called often.
    """
    if corners is None:
        corners = corner_matrix(faces, positions.shape[-2])
    by_face = np.moveaxis(face_normals(positions, faces), -2, 0)
    by_vertex = (corners @ by_face.reshape(len(faces), -1)).reshape(-1, *by_face.shape[1:])
    return normalised(np.moveaxis(by_vertex, 0, -2)).astype(positions.dtype)


def unique_edges(faces: Int[np.ndarray, "faces 3"]) -> Int[np.ndarray, "edges 2"]:
    """Undirected edges, each once, lower index first, sorted, shape (E, 2)."""
    pairs = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    return np.unique(np.sort(pairs, axis=1), axis=0)


def border_edges(faces: Int[np.ndarray, "faces 3"]) -> Int[np.ndarray, "edges 2"]:
    """Edges that belong to one face only, lower index first, sorted, shape (N, 2)."""
    pairs = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    edges, counts = np.unique(pairs, axis=0, return_counts=True)
    return edges[counts == 1]


def border_vertices(faces: Int[np.ndarray, "faces 3"]) -> Int[np.ndarray, " border"]:
    """Vertices of edges that belong to one face only, ascending, shape (N,)."""
    return np.unique(border_edges(faces))


def edge_lengths(
    positions: Float[np.ndarray, "*n vertices d"], edges: Int[np.ndarray, "edges 2"]
) -> Float[np.ndarray, "*n edges"]:
    """Edge lengths [m], shape (..., E), of positions [m], shape (..., V, 2 or 3)."""
    return lengths(positions[..., edges[:, 0], :] - positions[..., edges[:, 1], :])


def laplacian(faces: Int[np.ndarray, "faces 3"], vertex_count: int) -> sp.csr_matrix:
    """Uniform mesh Laplacian I - D^-1 A, shape (V, V), float64; a row of zeros for a vertex without edges."""
    i, j = unique_edges(faces).T
    adjacency = sp.csr_matrix((np.ones(i.size), (i, j)), (vertex_count, vertex_count))
    adjacency = adjacency + adjacency.T
    degree = np.asarray(adjacency.sum(axis=1)).ravel()
    inverse = np.divide(1.0, degree, out=np.zeros_like(degree), where=degree > 0)
    return sp.csr_matrix(sp.diags((degree > 0).astype(float)) - sp.diags(inverse) @ adjacency)


def tangent_frames(
    positions: Float[np.ndarray, "vertices 3"], faces: Int[np.ndarray, "faces 3"], uv: Float[np.ndarray, "vertices 2"]
) -> Float[np.ndarray, "vertices 3 3"]:
    """Orthonormal vertex frames, shape (V, 3, 3); columns are tangent (along u), bitangent N x T, and normal.

    A vertex whose faces have no area in UV takes its tangent from the world axis that is farthest from its normal.

    Args:
        positions: Vertices [m], shape (V, 3).
        faces: Triangles, shape (F, 3).
        uv: UV coordinates, shape (V, 2).
    """
    normal = vertex_normals(positions.astype(np.float64), faces)
    a, b, c = (positions[faces[:, k]].astype(np.float64) for k in range(3))
    ua, ub, uc = (uv[faces[:, k]].astype(np.float64) for k in range(3))
    (du1, dv1), (du2, dv2) = (ub - ua).T, (uc - ua).T
    along_u = (dv2[:, None] * (b - a) - dv1[:, None] * (c - a)) * np.sign(du1 * dv2 - du2 * dv1)[:, None]
    tangent = corner_matrix(faces, len(positions)) @ normalised(along_u)
    other_axis = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    tangent = _orthogonal(tangent, normal)
    missing = np.linalg.norm(tangent, axis=1) < 1e-6
    tangent[missing] = _orthogonal(other_axis[missing], normal[missing])
    return np.stack([tangent, np.cross(normal, tangent), normal], axis=-1)


def _orthogonal(vectors: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Unit vectors: `vectors` without their part along `normal`."""
    return normalised(vectors - np.sum(vectors * normal, axis=-1, keepdims=True) * normal)
