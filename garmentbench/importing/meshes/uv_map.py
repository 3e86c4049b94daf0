"""UV of corners to UV of vertices: into the unit square, split where the map is cut, or made anew.

And the pairs to sew again.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from garmentbench.geometry.unwrap import SAME_UV, split_corners, unwrap
from garmentbench.geometry.weld import TOGETHER, sewing_pairs, touching_borders
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal
from garmentbench.importing.text import counted

MOST_TILES = 100  # a UV map that spans more is damaged


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
        bare = len(np.unique(np.argwhere(~np.isfinite(uv))[:, 0]))
        found = f"has no UV, or none that is finite, for {bare} of its {len(uv)} triangles"
        raise refusal(where, found, "unwrap the garment again and export UV, or give --make-uv")
    uv, notes = _into_unit_square(where, uv.astype(np.float64))
    origin, faces, of_vertex = split_corners(mesh.faces, uv)
    copies = len(origin) - len(np.unique(mesh.faces))
    cut = (f"{counted(copies, 'vertex', 'vertices')} split along the cuts of the UV map",) if copies else ()
    return VertexUV(origin, faces, of_vertex, (*notes, *cut))


def _into_unit_square(where: Path | str, uv: np.ndarray) -> tuple[np.ndarray, tuple[str, ...]]:
    flat = uv.reshape(-1, 2)
    low, high = np.floor(flat.min(axis=0) + SAME_UV), np.ceil(flat.max(axis=0) - SAME_UV)
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
    notes = f"UV map made by xatlas: {counted(copies, 'vertex', 'vertices')} split along its cuts"
    faces = np.searchsorted(used, made.faces).astype(np.int32)
    return VertexUV(made.source[used], faces, made.uv[used], (notes,))


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
    touching = touching_borders(rest, faces, TOGETHER)
    for frame in frames:
        if not len(touching):
            break
        gap = np.linalg.norm(frame[touching[:, 0]] - frame[touching[:, 1]], axis=1)
        touching = touching[gap <= SEWN]
    return sewing_pairs(np.concatenate([cut, touching]), len(rest))
