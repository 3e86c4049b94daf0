"""UV of corners to UV of vertices: into the unit square, split where the map is cut, or made anew.

And the pairs to sew again.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from garmentbench.geometry.unwrap import unwrap
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal

MOST_TILES = 100  # a UV map that spans more is damaged
_SAME = 1e-6  # UV coordinates this near are the same


@dataclass(frozen=True)
class VertexUV:
    """A mesh with one UV coordinate a vertex.

    Attributes:
        origin: The file's vertex of each vertex, shape (W,); a vertex on a cut of the UV map is there once a side.
        faces: Triangles of the new vertices, shape (F, 3), int32.
        uv: In [0, 1], shape (W, 2), float32.
        notes: What was done.
    """

    origin: np.ndarray
    faces: np.ndarray
    uv: np.ndarray
    notes: tuple[str, ...]


def vertex_uv(mesh: MeshSequence, make_uv: bool = False) -> VertexUV:
    """The mesh by its own UV map, or with `make_uv` by a new one.

    Raises `UserError` where it has no UV map and none is to be made, or where that is damaged.
    """
    if make_uv:
        return _made(mesh)
    uv = mesh.corner_uv
    where = mesh.files[-1] if mesh.files else mesh.name  # of a cache and its template, the template
    if uv is None or np.ptp(uv.reshape(-1, 2), axis=0).min() == 0:
        found = "has no UV map" if uv is None else "has a UV map without area"
        raise refusal(where, f"{found}, which the methods need", "unwrap the garment and export UV, or give --make-uv")
    if not np.isfinite(uv).all():
        raise refusal(where, "has UV coordinates that are NaN or infinite", "unwrap the garment again")
    uv, notes = _into_unit_square(where, uv.astype(np.float64))
    origin, faces, of_vertex = split(mesh.faces, uv)
    copies = len(origin) - len(np.unique(mesh.faces))
    cut = (f"{copies} vertices split along the cuts of the UV map",) if copies else ()
    return VertexUV(origin, faces, of_vertex, (*notes, *cut, *_left_out(mesh)))


def split(faces: np.ndarray, corner_uv: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices with one UV coordinate each.

    Args:
        faces: Shape (F, 3).
        corner_uv: Shape (F, 3, 2).

    Returns:
        The old vertex of each new one, shape (W,), in the old order; faces of the new ones, shape (F, 3), int32; their
        UV, shape (W, 2), float32.
    """
    vertex, uv = faces.ravel().astype(np.int64), corner_uv.reshape(-1, 2)
    grid = np.round(uv / _SAME).astype(np.int64)
    order = np.lexsort((grid[:, 1], grid[:, 0], vertex))
    sorted_keys = np.column_stack([vertex, grid])[order]
    new = np.concatenate([[True], (np.diff(sorted_keys, axis=0) != 0).any(axis=1)])
    number = np.empty(len(order), np.int64)
    number[order] = np.cumsum(new) - 1
    first = order[new]
    return vertex[first], number.reshape(-1, 3).astype(np.int32), uv[first].astype(np.float32)


def _into_unit_square(where: object, uv: np.ndarray) -> tuple[np.ndarray, tuple[str, ...]]:
    flat = uv.reshape(-1, 2)
    low, high = np.floor(flat.min(axis=0) + _SAME), np.ceil(flat.max(axis=0) - _SAME)
    tiles = float((high - low).max())
    if not low.any() and tiles <= 1:
        return np.clip(uv, 0, 1), ()
    if tiles > MOST_TILES or np.abs(low).max() > 1e6:
        found = f"its UV map spans {tiles:.3g} tiles from {low.tolist()}, wanted at most {MOST_TILES}"
        raise refusal(where, found, "scale the UV map into the unit square")
    span = " x ".join(f"[{a:.4g}, {b:.4g}]" for a, b in zip(flat.min(axis=0), flat.max(axis=0), strict=True))
    notes = f"UV map spanned {span}: moved and scaled by 1/{max(tiles, 1):g} into the unit square"
    return np.clip((uv - low) / max(tiles, 1), 0, 1), (notes,)


def _made(mesh: MeshSequence) -> VertexUV:
    still = np.asarray(mesh.still, np.float32)
    if not np.isfinite(still).all():
        raise refusal(mesh.where, "has rest positions that are not finite", "export it again")
    made = unwrap(still, mesh.faces)
    used = np.unique(made.faces)
    copies = len(made.source) - len(still)
    notes = f"UV map made by xatlas: {copies} vertices split along its cuts"
    faces = np.searchsorted(used, made.faces).astype(np.int32)
    return VertexUV(made.source[used], faces, made.uv[used], (notes, *_left_out(mesh)))


def _left_out(mesh: MeshSequence) -> tuple[str, ...]:
    loose = len(mesh.still) - len(np.unique(mesh.faces))
    return (f"{loose} vertices without a face left out",) if loose else ()


TOGETHER = 2e-5  # [m] at rest; OBJ files round to a micrometre, the shortest edges of dense meshes are 0.1 mm
SEWN = 1e-3  # [m] in every frame


def seam_pairs(origin: np.ndarray, faces: np.ndarray, rest: np.ndarray, frames: np.ndarray) -> np.ndarray:
    """Pairs of vertices that are sewn together.

    Args:
        origin: Vertices of the same number were one vertex before the UV map was cut, shape (V,).
        faces: Shape (F, 3).
        rest: Rest positions [m], shape (V, 3).
        frames: Positions [m], shape (T, V, 3).

    Returns:
        Shape (S, 2), int32; of vertices that are all the same point each is paired with the first.
    """
    order = np.argsort(origin, kind="stable")
    same = origin[order][1:] == origin[order][:-1]
    cut = np.stack([order[:-1][same], order[1:][same]], axis=1)
    return _stars(np.concatenate([cut, _touching(_border(faces), rest, frames)]), len(rest))


def _border(faces: np.ndarray) -> np.ndarray:
    """Vertices on edges of one face."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    unique, counts = np.unique(edges, axis=0, return_counts=True)
    return np.unique(unique[counts == 1])


def _touching(border: np.ndarray, rest: np.ndarray, frames: np.ndarray) -> np.ndarray:
    """Pairs on the border that coincide at rest and never part."""
    if not len(border):
        return np.zeros((0, 2), np.int64)
    pairs = border[cKDTree(rest[border]).query_pairs(TOGETHER, output_type="ndarray")]
    for frame in frames:
        if not len(pairs):
            break
        gap = np.linalg.norm(frame[pairs[:, 0]] - frame[pairs[:, 1]], axis=1)
        pairs = pairs[gap <= SEWN]
    return pairs


def _stars(pairs: np.ndarray, count: int) -> np.ndarray:
    """Each vertex of a cluster with the cluster's first one."""
    graph = sp.coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), (count, count))
    _, cluster = connected_components(graph, directed=False)
    _, first = np.unique(cluster, return_index=True)
    others = np.setdiff1d(np.arange(count), first)
    return np.stack([first[cluster[others]], others], axis=1).astype(np.int32)
