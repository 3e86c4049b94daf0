"""From polygons as USD and Alembic hold them to a `MeshSequence`: checked, cut into triangles, frames read one by one."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from garmentbench.importing.meshes.mesh_sequence import MeshSequence, checked_faces, refusal
from garmentbench.importing.meshes.polygons import triangulate, what_was_cut

_AGAIN = "export it again"


@dataclass(frozen=True)
class PolygonFrames:
    """A moving polygon mesh whose frames are not yet read.

    Attributes:
        path: Its file.
        name: Its name there.
        counts: Corners of each polygon, shape (P,).
        corners: Vertex of each corner, shape (C,).
        length: Number of frames.
        points: Positions of a frame, shape (V, 3), float32.
        corner_uv: UV of each corner, shape (C, 2); None where there is none.
        clockwise: The polygons are listed clockwise, seen from outside.
        rest: Rest positions, shape (V, 3), or None.
    """

    path: Path
    name: str
    counts: np.ndarray
    corners: np.ndarray
    length: int
    points: Callable[[int], np.ndarray]
    corner_uv: np.ndarray | None
    clockwise: bool = False
    rest: np.ndarray | None = None


def from_polygons(mesh: PolygonFrames, fps: float | None, unit: float | None, up: str | None) -> MeshSequence:
    """All of it in memory. Raises `UserError`, one line, where counts don't fit, or a frame has other vertices."""
    first = mesh.points(0)
    if not len(first) or not np.isfinite(first).all():
        found = "has no points" if not len(first) else "has points that are not finite in its first frame"
        raise refusal(mesh.path, f"{mesh.name} {found}", _AGAIN)
    if len(mesh.corners) != mesh.counts.sum():
        found = f"{mesh.name} has faces of {mesh.counts.sum()} corners in all, but lists {len(mesh.corners)}"
        raise refusal(mesh.path, found, _AGAIN)
    checked_faces(f"{mesh.path}: {mesh.name}", mesh.corners[:, None], len(first))
    try:
        cut = triangulate(mesh.counts, mesh.corners, first)
    except ValueError as e:
        raise refusal(mesh.path, f"{mesh.name}: {e}", "cut the mesh into triangles or quads") from e
    cut = cut[:, ::-1] if mesh.clockwise else cut
    frames = np.empty((mesh.length, *first.shape), np.float32)
    for t in range(mesh.length):
        positions = mesh.points(t)
        if positions.shape != first.shape:
            found = f"{mesh.name} has {len(positions)} points in frame {t}, {len(first)} in the first, wanted the same"
            raise refusal(mesh.path, found, "export the mesh without remeshing")
        frames[t] = positions
    rest = mesh.rest if mesh.rest is not None and mesh.rest.shape == first.shape else None
    uv = None if mesh.corner_uv is None else mesh.corner_uv[cut].astype(np.float32)
    faces = mesh.corners[cut].astype(np.int32)
    return MeshSequence(mesh.name, frames, faces, uv, rest, fps, unit, up, notes=what_was_cut(mesh.counts))
