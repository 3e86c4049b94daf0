"""Polygons: cut into triangles once for a mesh, so that all frames share the cut.

Moving ones, as USD and Alembic hold them.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from garmentbench.importing.meshes.even_times import evenly_timed
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, checked_faces, refusal
from garmentbench.importing.text import counted

MOST_CORNERS = 100  # of one face; ear clipping is cubic


def triangulate(counts: np.ndarray, corners: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Triangles that fill polygons, with the polygons' orientation.

    A quad is cut along its first diagonal unless that lies outside it; polygons of more corners lose one ear after
    another in their mean plane.

    Args:
        counts: Corners of each polygon, at least 3, shape (P,).
        corners: Vertex of each corner, polygon after polygon, shape (C,).
        positions: Shape (V, 3).

    Returns:
        Indices into `corners`, shape (F, 3), polygon after polygon, so that what belongs to corners (UV) can follow.

    Raises:
        ValueError: A polygon has fewer than 3 or more than `MOST_CORNERS` corners.
    """
    odd = np.flatnonzero((counts < 3) | (counts > MOST_CORNERS))
    if len(odd):
        raise ValueError(f"face {odd[0]} has {counts[odd[0]]} corners, wanted 3 to {MOST_CORNERS}")
    first = np.concatenate([[0], np.cumsum(counts[:-1])]).astype(np.int64)
    out = np.empty((int((counts - 2).sum()), 3), np.int64)
    place = np.concatenate([[0], np.cumsum(counts - 2)])[:-1].astype(np.int64)
    threes, fours = counts == 3, counts == 4
    out[place[threes]] = first[threes, None] + [0, 1, 2]
    _cut_quads(out, place[fours], first[fours], positions[corners[first[fours, None] + np.arange(4)]])
    for k in np.flatnonzero(counts > 4):
        polygon = positions[corners[first[k] : first[k] + counts[k]]].astype(np.float64)
        out[place[k] : place[k] + counts[k] - 2] = first[k] + _ears(polygon)
    return out


def _cut_quads(out: np.ndarray, place: np.ndarray, first: np.ndarray, quads: np.ndarray) -> None:
    """Write both triangles of quads, positions of shape (Q, 4, 3), to rows `place` and `place + 1`."""
    a, b, c, d = np.moveaxis(quads.astype(np.float64), 1, 0)
    halves = np.cross(b - a, c - a), np.cross(c - a, d - a)
    folded = np.sum(halves[0] * halves[1], axis=1) < 0  # the diagonal lies outside
    cuts = np.where(folded[:, None, None], [[0, 1, 3], [1, 2, 3]], [[0, 1, 2], [0, 2, 3]])
    out[place], out[place + 1] = first[:, None] + cuts[:, 0], first[:, None] + cuts[:, 1]


def _ears(polygon: np.ndarray) -> np.ndarray:
    """Ear clipping of one polygon, shape (n, 3): triangles as indices of its corners, shape (n - 2, 3)."""
    flat = _flattened(polygon)
    left, triangles = list(range(len(flat))), []
    while len(left) > 3:
        ear = next((i for i in range(len(left)) if _is_ear(flat, left, i)), 0)  # 0: it crosses itself, a fan is as good
        triangles.append((left[ear - 1], left[ear], left[(ear + 1) % len(left)]))
        del left[ear]
    return np.array([*triangles, left])


def _flattened(polygon: np.ndarray) -> np.ndarray:
    """The polygon in its mean plane, anticlockwise, shape (n, 2)."""
    x = polygon - polygon.mean(axis=0)
    normal = np.cross(x, np.roll(x, -1, axis=0)).sum(axis=0)
    axis = np.eye(3)[np.argmin(np.abs(normal))]
    u = np.cross(axis, normal)
    v = np.cross(normal, u)
    return np.stack([x @ u, x @ v * np.linalg.norm(u) / (np.linalg.norm(v) or 1.0)], axis=1)


def _is_ear(flat: np.ndarray, left: list[int], i: int) -> bool:
    a, b, c = flat[left[i - 1]], flat[left[i]], flat[left[(i + 1) % len(left)]]
    if _turn(a, b, c) <= 0:
        return False
    corner = {left[i - 1], left[i], left[(i + 1) % len(left)]}
    others = flat[[k for k in left if k not in corner]]
    inside = (_turn(a, b, others) >= 0) & (_turn(b, c, others) >= 0) & (_turn(c, a, others) >= 0)
    return not inside.any()


def _turn(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Twice the area of a, b, p: positive where p lies to the left of a to b."""
    return (b[0] - a[0]) * (p[..., 1] - a[1]) - (b[1] - a[1]) * (p[..., 0] - a[0])


def what_was_cut(counts: np.ndarray) -> tuple[str, ...]:
    """In words, for the notes; nothing where all were triangles."""
    quads, more = int((counts == 4).sum()), int((counts > 4).sum())
    said = [counted(quads, "quad")] if quads else []
    said += [counted(more, "face of more than 4 corners", "faces of more than 4 corners")] if more else []
    return (" and ".join(said) + " cut into triangles",) if said else ()


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
        notes: What was found and done while reading, for the user.
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
    notes: tuple[str, ...] = ()


def from_polygons(mesh: PolygonFrames, times: np.ndarray | None, unit: float | None, up: str | None) -> MeshSequence:
    """All of it in memory, at even times [s].

    Raises `UserError`, one line, where counts don't fit, a frame has other vertices, or times have a wide gap.
    """
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
    frames, times, fps, uneven = evenly_timed(mesh.path, frames, times)
    notes = (*mesh.notes, *uneven, *what_was_cut(mesh.counts))
    return MeshSequence(mesh.name, frames, faces, uv, rest, fps, unit, up, times, notes=notes)
