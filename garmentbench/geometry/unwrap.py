"""UV coordinates a vertex: of a mesh that has them at its corners, or has none (by xatlas)."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from garmentbench.errors import UserError

_TEXELS = 1024  # a side of the map that charts are packed for
SAME_UV = 1e-6  # UV coordinates this near are the same
_PADDING = 4  # texels between two charts: a 128 x 128 map keeps them half a texel apart


@dataclass(frozen=True)
class Unwrapped:
    """A mesh cut open into charts. Vertices keep their numbers; copies at the cuts come after them.

    Attributes:
        source: The vertex of the mesh as it was that each vertex stands for, shape (V2,), int64; 0 .. V-1 at first.
        faces: Triangles in the order they were, shape (F, 3), int32.
        uv: UV coordinates in [0, 1], shape (V2, 2), float32; (0, 0) for a vertex without a face.
        seams: Pairs of vertices that are the same point, shape (S, 2), int32: each copy and its original.
    """

    source: Int[np.ndarray, " vertices"]
    faces: Int[np.ndarray, "faces 3"]
    uv: Float[np.ndarray, "vertices 2"]
    seams: Int[np.ndarray, "seams 2"]


def unwrap(positions: Float[np.ndarray, "vertices 3"], faces: Int[np.ndarray, "faces 3"]) -> Unwrapped:
    """Cut a mesh into charts that lie side by side in the unit square without overlap.

    Weld the mesh first: xatlas cuts it wherever two faces do not share their vertices.

    Args:
        positions: Vertices, in any unit, shape (V, 3), finite.
        faces: Triangles, shape (F, 3).

    Raises `UserError` where xatlas is not installed, or can't unwrap the mesh.
    """
    try:
        import xatlas
    except ModuleNotFoundError:
        raise UserError("UV maps are made by the package xatlas, which is not installed; pip install xatlas") from None
    size = np.ptp(positions, axis=0).max()  # xatlas has limits of its own, in the mesh's unit
    atlas, packing = xatlas.Atlas(), xatlas.PackOptions()
    packing.padding, packing.resolution = _PADDING, _TEXELS
    try:
        atlas.add_mesh((positions / (size or 1.0)).astype(np.float32), faces.astype(np.uint32))
        atlas.generate(xatlas.ChartOptions(), packing)
        source, corners, uv = atlas[0]
    except (RuntimeError, ValueError) as e:
        raise UserError(
            f"xatlas can't unwrap the mesh ({e}); repair it first: garmentbench check FILE --fix OUT"
        ) from e
    uv = np.clip(uv, 0.0, 1.0)  # rounding may leave the square by a hair
    return in_order(len(positions), source.astype(np.int64), corners.astype(np.int64), uv)


def in_order(
    count: int, source: Int[np.ndarray, " cut"], corners: Int[np.ndarray, "faces 3"], uv: Float[np.ndarray, "cut 2"]
) -> Unwrapped:
    """Number the vertices of a mesh that was cut open so that the first copy of each keeps its vertex's own number.

    Args:
        count: Vertices of the mesh as it was, V.
        source: The vertex that each vertex stands for, shape (V2,).
        corners: Triangles, shape (F, 3).
        uv: UV coordinates, shape (V2, 2).
    """
    used, first = np.unique(source, return_index=True)
    number = np.full(len(source), -1)
    number[first] = used
    copies = np.flatnonzero(number < 0)
    number[copies] = count + np.arange(len(copies))
    placed = np.zeros((count + len(copies), 2), np.float32)
    placed[number] = uv
    sources = np.concatenate([np.arange(count), source[copies]])
    seams = np.stack([source[copies], number[copies]], axis=1)
    return Unwrapped(sources, number[corners].astype(np.int32), placed, seams.astype(np.int32))


def split_corners(
    faces: Int[np.ndarray, "faces 3"], corner_uv: Float[np.ndarray, "faces 3 2"]
) -> tuple[Int[np.ndarray, " cut"], Int[np.ndarray, "faces 3"], Float[np.ndarray, "cut 2"]]:
    """Vertices with one UV coordinate each.

    Args:
        faces: Shape (F, 3).
        corner_uv: Shape (F, 3, 2).

    Returns:
        The old vertex of each new one, shape (W,), in the old order; faces of the new ones, shape (F, 3), int32; their
        UV, shape (W, 2), float32.
    """
    vertex, uv = faces.ravel().astype(np.int64), corner_uv.reshape(-1, 2)
    grid = np.round(uv / SAME_UV).astype(np.int64)
    order = np.lexsort((grid[:, 1], grid[:, 0], vertex))
    sorted_keys = np.column_stack([vertex, grid])[order]
    new = np.concatenate([[True], (np.diff(sorted_keys, axis=0) != 0).any(axis=1)])
    number = np.empty(len(order), np.int64)
    number[order] = np.cumsum(new) - 1
    first = order[new]
    return vertex[first], number.reshape(-1, 3).astype(np.int32), uv[first].astype(np.float32)
