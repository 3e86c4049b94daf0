"""UV of corners to UV of vertices: into the unit square, vertices split where the UV map is cut, or made anew by xatlas."""

from dataclasses import dataclass

import numpy as np

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
    uv, said = _into_unit_square(where, uv.astype(np.float64))
    origin, faces, of_vertex = split(mesh.faces, uv)
    copies = len(origin) - len(np.unique(mesh.faces))
    cut = (f"{copies} vertices split along the cuts of the UV map",) if copies else ()
    return VertexUV(origin, faces, of_vertex, (*said, *cut, *_left_out(mesh)))


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
    span = " x ".join(f"[{a:.4g}, {b:.4g}]" for a, b in zip(flat.min(axis=0), flat.max(axis=0)))
    said = f"UV map spanned {span}: moved and scaled by 1/{max(tiles, 1):g} into the unit square"
    return np.clip((uv - low) / max(tiles, 1), 0, 1), (said,)


def _made(mesh: MeshSequence) -> VertexUV:
    still = np.asarray(mesh.still, np.float32)
    if not np.isfinite(still).all():
        raise refusal(mesh.where, "has rest positions that are not finite", "export it again")
    made = unwrap(still, mesh.faces)
    used = np.unique(made.faces)
    copies = len(made.source) - len(still)
    said = f"UV map made by xatlas: {copies} vertices split along its cuts"
    faces = np.searchsorted(used, made.faces).astype(np.int32)
    return VertexUV(made.source[used], faces, made.uv[used], (said, *_left_out(mesh)))


def _left_out(mesh: MeshSequence) -> tuple[str, ...]:
    loose = len(mesh.still) - len(np.unique(mesh.faces))
    return (f"{loose} vertices without a face left out",) if loose else ()
