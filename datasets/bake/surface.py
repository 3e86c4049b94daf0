"""Triangle surfaces: clipping, neighbours, staying outside a body. Used while baking garments only."""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree


def clip(points: np.ndarray, faces: np.ndarray, level: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The part of a surface where a linear function is positive.

    Args:
        points: shape (V, 3) or (V, D); further columns are interpolated along.
        faces: shape (F, 3).
        level: The function at the vertices, shape (V,).

    Returns:
        Points, faces and whether a point lies on the cut, shape (V',).
    """
    level = np.where(np.abs(level) < 1e-9, 1e-9, level)
    kept, new, cuts = [], list(points), {}

    def cut(a: int, b: int) -> int:
        key = (min(a, b), max(a, b))
        if key not in cuts:
            t = level[a] / (level[a] - level[b])
            cuts[key] = len(new)
            new.append((1 - t) * points[a] + t * points[b])
        return cuts[key]

    for face in faces:
        inside = level[face] > 0
        if inside.all():
            kept.append(face)
        elif inside.any():
            odd = np.flatnonzero(inside == (inside.sum() == 1))[0]
            a, b, c = face[odd], face[(odd + 1) % 3], face[(odd + 2) % 3]
            ab, ac = cut(a, b), cut(a, c)
            kept += [(a, ab, ac)] if inside[odd] else [(ab, b, c), (ab, c, ac)]
    on_cut = np.arange(len(new)) >= len(points)
    used, faces = np.unique(np.array(kept), return_inverse=True)
    return np.array(new)[used], faces.reshape(-1, 3), on_cut[used]


def normals(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Vertex normals weighted by area, shape (V, 3)."""
    a, b, c = points[faces].transpose(1, 0, 2)
    out = np.zeros_like(points)
    for corner in faces.T:
        np.add.at(out, corner, np.cross(b - a, c - a))
    return out / np.linalg.norm(out, axis=1, keepdims=True)


def edges(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges, shape (E, 2), and how many faces each has, shape (E,)."""
    every = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    return np.unique(every, axis=0, return_counts=True)


def border_loops(faces: np.ndarray) -> list[np.ndarray]:
    """All borders of a surface, each in the faces' direction, from its smallest vertex on."""
    directed = set(map(tuple, faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).tolist()))
    following = {a: b for a, b in directed if (b, a) not in directed}
    loops = []
    while following:
        loop = [min(following)]
        while (after := following.pop(loop[-1])) != loop[0]:
            loop.append(after)
        loops.append(np.array(loop))
    return loops


def border_loop(faces: np.ndarray) -> np.ndarray:
    """The border of a disk, in the faces' direction, shape (B,)."""
    loops = border_loops(faces)
    assert len(loops) == 1, "a panel must have one border"
    return loops[0]


def averaging(faces: np.ndarray, count: int) -> sp.csr_array:
    """The mean over a vertex's neighbours; at a border, over its neighbours on the border. Shape (V, V)."""
    pairs, faces_each = edges(faces)
    border = np.zeros(count, bool)
    border[pairs[faces_each == 1]] = True
    i, j = np.concatenate([pairs, pairs[:, ::-1]]).T
    keep = ~border[i] | np.tile(faces_each == 1, 2)
    weights = sp.csr_array((np.ones(keep.sum()), (i[keep], j[keep])), (count, count))
    return sp.diags_array(1 / weights.sum(axis=1)) @ weights


class Skin:
    """A closed surface, for signed distances near it, from dense samples with normals."""

    def __init__(self, points: np.ndarray, faces: np.ndarray):
        # 15 points on every triangle: barycentric coordinates in steps of a quarter.
        steps = np.array([(i, j, 4 - i - j) for i in range(5) for j in range(5 - i)]) / 4
        self.samples = np.einsum("sc,fcx->sfx", steps, points[faces]).reshape(-1, 3)
        facing = np.einsum("sc,fcx->sfx", steps, normals(points, faces)[faces]).reshape(-1, 3)
        self.facing = facing / np.linalg.norm(facing, axis=1, keepdims=True)
        self.tree = cKDTree(self.samples)

    def distance(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Signed distance [m] (positive outside), shape (P,), and the direction outwards, shape (P, 3)."""
        _, nearest = self.tree.query(points)
        out = self.facing[nearest]
        return np.einsum("pc,pc->p", points - self.samples[nearest], out), out


def push_out(
    points: np.ndarray, faces: np.ndarray, skin: Skin, clearance: np.ndarray | float, rounds: int = 20
) -> np.ndarray:
    """Move vertices until they, and the middles of edges and faces, are at least `clearance` [m] off the skin."""
    pairs, _ = edges(faces)
    points = points.copy()
    clearance = np.broadcast_to(clearance, len(points))
    for _ in range(rounds):
        moved = 0.0
        for group in (np.arange(len(points))[:, None], pairs, faces):
            distance, out = skin.distance(points[group].mean(1))
            lack = np.maximum(clearance[group].mean(1) - distance, 0)
            moved = max(moved, lack.max())
            push, hits = np.zeros_like(points), np.zeros(len(points))
            for corner in group.T:
                np.add.at(push, corner, lack[:, None] * out)
                np.add.at(hits, corner, lack > 0)
            points += push / np.maximum(hits, 1)[:, None]
        if moved < 1e-4:
            break
    return points


def largest_part(points: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The connected part with the most points."""
    pairs, _ = edges(faces)
    graph = sp.coo_array((np.ones(len(pairs)), tuple(pairs.T)), (len(points),) * 2)
    part = connected_components(graph, directed=False)[1]
    kept = part[faces[:, 0]] == np.bincount(part).argmax()
    used, faces = np.unique(faces[kept], return_inverse=True)
    return points[used], faces.reshape(-1, 3)
