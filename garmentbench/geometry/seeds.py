"""Seed points: a few body vertices that stand for the whole body, and the rigid frame of each over time."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from jaxtyping import Float, Int
from scipy.sparse.csgraph import dijkstra

from garmentbench.geometry.mesh import cross, edge_lengths, normalised, unique_edges
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.sequence import OBJECT, Template

REACH = 0.15  # [m] A body or inner garment farther than this from the rest garment neither touches it nor carries it.


@dataclass(frozen=True)
class SeedPoints:
    """Seed points on a body, N of them, with what their frames are made from.

    Attributes:
        vertices: Body vertices, shape (N,), int64.
        labels: Body part of each, shape (N,), int64; None where the body has no parts.
        rest: Canonical positions [m], shape (N, 3).
        frames: Canonical frames, columns tangent, bitangent and normal, shape (N, 3, 3).
        faces: The faces round each seed, which is their first corner; padded with empty ones, shape (N, K, 3), int64.
        along: How much the way to each of the other two corners counts towards the tangent [m], shape (N, K, 2).
    """

    vertices: Int[np.ndarray, " seeds"]
    labels: Int[np.ndarray, " seeds"] | None
    rest: Float[np.ndarray, "seeds 3"]
    frames: Float[np.ndarray, "seeds 3 3"]
    faces: Int[np.ndarray, "seeds ring 3"]
    along: Float[np.ndarray, "seeds ring 2"]


def select_seeds(template: Template, count: int) -> SeedPoints:
    """Geodesic farthest-point samples of the body, at most `count`, of what the garment can touch or follow.

    On an object that is everything; on a human or a garment, what lies within `REACH` of the rest garment. Geodesic
    distance is measured along mesh edges. Deterministic. Source: section 4.1 of Zhang et al. 2022.
    """
    body = template.required_body
    allowed = np.arange(len(body.rest))
    if body.kind != OBJECT:
        distance, _ = nearest_vertices(body.rest, template.garment.rest)
        allowed = np.flatnonzero(distance < REACH)
    vertices = farthest_points(body.rest, body.faces, allowed, count)
    labels = None if body.labels is None else body.labels[vertices].astype(np.int64)
    return seed_points(body.rest, body.faces, vertices, labels)


def farthest_points(
    positions: Float[np.ndarray, "vertices 3"],
    faces: Int[np.ndarray, "faces 3"],
    allowed: Int[np.ndarray, " allowed"],
    count: int,
) -> Int[np.ndarray, " chosen"]:
    """Geodesic farthest-point samples among the vertices `allowed`, in the order of choice, shape (<= count,), int64.

    Args:
        positions: Vertices [m], shape (V, 3).
        faces: Triangles, shape (F, 3).
        allowed: Vertices to choose from, shape (A,).
        count: How many.
    """
    edges = unique_edges(faces)
    lengths = edge_lengths(positions, edges).astype(np.float64)
    graph = sp.csr_matrix((lengths, edges.T), (len(positions), len(positions)))
    first = allowed[np.argmax(np.linalg.norm(positions[allowed] - positions[allowed].mean(axis=0), axis=1))]
    chosen, distance = [first], np.full(len(positions), np.inf)
    for _ in range(min(count, len(allowed)) - 1):
        reach = distance[allowed].max()
        distance = np.minimum(distance, dijkstra(graph, directed=False, indices=chosen[-1], limit=reach))
        chosen.append(allowed[np.argmax(distance[allowed])])
    return np.array(chosen, np.int64)


def seed_points(
    rest: Float[np.ndarray, "vertices 3"],
    faces: Int[np.ndarray, "faces 3"],
    vertices: Int[np.ndarray, " seeds"],
    labels: Int[np.ndarray, " seeds"] | None = None,
) -> SeedPoints:
    """Seed points at given body vertices, shape (N,), of a canonical body [m], shape (B, 3)."""
    corner = np.concatenate([faces, np.roll(faces, -1, axis=1), np.roll(faces, -2, axis=1)]).astype(np.int64)
    rounds = [corner[corner[:, 0] == v] for v in vertices]
    ring = np.tile(vertices[:, None, None], (1, max(len(r) for r in rounds), 3))
    for i, r in enumerate(rounds):
        ring[i, : len(r)] = r
    spokes = _spokes(rest, ring)
    along = np.einsum("nkcx,nx->nkc", spokes, np.eye(3)[np.argmin(np.abs(_normals(spokes)), axis=1)])
    return SeedPoints(vertices, labels, rest[vertices], _frames(rest, ring, along), ring, along)


def seed_frames(
    body: Float[np.ndarray, "*n vertices 3"], seeds: SeedPoints
) -> tuple[Float[np.ndarray, "*n seeds 3"], Float[np.ndarray, "*n seeds 3 3"], Float[np.ndarray, "*n seeds 3"]]:
    """Where the seeds are and how they have turned.

    A seed's rotation carries its whole tangent frame (its normal, and a tangent averaged over the faces round it)
    from the canonical pose to the present one, so that twist about the normal is kept.

    Args:
        body: Body vertices [m], shape (..., B, 3).
        seeds: The seed points.

    Returns:
        Positions [m], shape (..., N, 3); rotations from the canonical pose, shape (..., N, 3, 3); unit normals,
        shape (..., N, 3).
    """
    frames = _frames(body, seeds.faces, seeds.along)
    rotations = frames @ np.swapaxes(seeds.frames, -1, -2)
    return body[..., seeds.vertices, :], rotations.astype(body.dtype), frames[..., 2].astype(body.dtype)


def _spokes(body: np.ndarray, ring: np.ndarray) -> np.ndarray:
    """From each seed to the other two corners of the faces round it [m], shape (..., N, K, 2, 3)."""
    return body[..., ring[..., 1:], :] - body[..., ring[..., :1], :]


def _normals(spokes: np.ndarray) -> np.ndarray:
    """Unit normals of the seeds, the average of the unit normals of the faces round them, shape (..., N, 3)."""
    return normalised(normalised(cross(spokes[..., 0, :], spokes[..., 1, :])).sum(axis=-2))


def _frames(body: np.ndarray, ring: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Orthonormal frames of the seeds, shape (..., N, 3, 3), columns tangent, bitangent and normal."""
    spokes = _spokes(body, ring)
    normals = _normals(spokes)
    tangent = np.einsum("...nkcx,nkc->...nx", spokes, along)
    tangent = normalised(tangent - np.sum(tangent * normals, axis=-1, keepdims=True) * normals)
    return np.stack([tangent, cross(normals, tangent), normals], axis=-1)
