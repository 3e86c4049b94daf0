"""Pleated cloth round a body: rows of triangle waves, meshed so that every fold is a line of edges."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from tube import grid_faces


@dataclass(frozen=True)
class Grid:
    """How the cloth is meshed.

    Attributes:
        spacing: Of the rows [m], about.
        edge: About as long are edges along a row [m]: from one fold to the next they are 1, 2, 4 or 8.
    """

    spacing: float
    edge: float


def doubled(width: float, edge: float) -> int:
    """Into how many parts, 1, 2, 4 ..., a width [m] is cut so that they are nearest to `edge` [m]."""
    return 2 ** max(0, round(np.log2(width / edge)))


def row_heights(stops: list[float], spacing: float) -> np.ndarray:
    """Heights of rows [m], falling, shape (rows,): one at each of the stops, about `spacing` [m] between them."""
    parts = [np.linspace(a, b, max(1, round((a - b) / spacing)), endpoint=False) for a, b in pairwise(stops)]
    return np.concatenate([*parts, stops[-1:]])


def opened(heights: np.ndarray | float, start: float, stop: float) -> np.ndarray | float:
    """How far pleats have opened, from 0 at the height `start` [m] down to 1 at `stop`, smoothly."""
    share = np.clip((start - heights) / (start - stop), 0, 1)
    return share**2 * (3 - 2 * share)


def pleated_row(ring: np.ndarray, depth: float, pleats: int, columns: int) -> np.ndarray:
    """A ring laid in folds.

    Args:
        ring: Even points [m] along the inner edges of the folds, counterclockwise seen from above, shape (R, 3).
        depth: Of the folds [m].
        pleats: How many; each goes out and back once, and starts inside.
        columns: Of faces on one side of a pleat.

    Returns:
        Vertices [m], shape (2 pleats columns + 1, 3), the last a copy of the first.
    """
    count = 2 * pleats * columns
    at = np.linspace(0, len(ring), count, endpoint=False)
    ring = np.column_stack([np.interp(at, np.arange(len(ring) + 1), np.append(axis, axis[0])) for axis in ring.T])
    step = np.roll(ring, -1, axis=0) - np.roll(ring, 1, axis=0)
    outward = np.column_stack([step[:, 1], -step[:, 0], np.zeros(count)])
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    wave = 1 - np.abs(np.arange(count) % (2 * columns) / columns - 1)  # 0 inside, 1 outside
    ring = ring + depth * wave[:, None] * outward
    return np.concatenate([ring, ring[:1]])


def fold_depth(around: np.ndarray, width: np.ndarray, pleats: int) -> np.ndarray:
    """Depth of the folds [m], shape (rows,), of cloth so wide [m] on rings so long [m] at the inner edges of the folds.

    One side of a pleat, as long as width / 2P, goes out by d and along by (around + pi d) / 2P, the ring's length half
    way out: d^2 + ((around + pi d) / 2P)^2 = (width / 2P)^2.
    """
    sides = 2 * pleats
    a = 1 + (np.pi / sides) ** 2
    b = np.pi * around / sides**2
    c = (around**2 - width**2) / sides**2
    return np.maximum(np.sqrt(np.maximum(b**2 - a * c, 0)) - b, 0) / a


def even_ring(line: np.ndarray, count: int, closed: bool = True) -> np.ndarray:
    """Points at even distances along a polyline [m], shape (R, D): `count` of them from its first point on, round a
    closed one; of an open one, its last point after these."""
    if closed:
        line = np.concatenate([line, line[:1]])
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    at = np.linspace(0, length[-1], count, endpoint=False) if closed else np.linspace(0, length[-1], count + 1)
    return np.column_stack([np.interp(at, length, axis) for axis in line.T])


def strips(shares: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Faces between rows of vertices, numbered row by row from the upper edge down, shape (F, 3); outward where
    columns go counterclockwise seen from above. And the number of each vertex's row, shape (V,).

    Args:
        shares: How far along its row each vertex lies, 0 to 1, rising, shape (C,) of each row. Rows of as many
            vertices are joined like a chequerboard, others as their vertices come.
    """
    counts = np.array([len(share) for share in shares])
    starts = np.cumsum(counts) - counts
    faces = []
    for row, (upper, lower) in enumerate(pairwise(shares)):
        above, below = starts[row] + np.arange(len(upper)), starts[row + 1] + np.arange(len(lower))
        if len(upper) == len(lower):
            faces.append(grid_faces(np.stack([above, below]), row))
        else:
            faces.append(_zipped(upper, lower, above, below))
    return np.concatenate(faces), np.repeat(np.arange(len(shares)), counts)


def _zipped(upper: np.ndarray, lower: np.ndarray, above: np.ndarray, below: np.ndarray) -> np.ndarray:
    """Faces between two rows: on and on, the shorter of the two diagonals."""
    i, j, faces = 0, 0, []
    while i < len(upper) - 1 or j < len(lower) - 1:
        last_above, last_below = i == len(upper) - 1, j == len(lower) - 1
        if last_above or (not last_below and abs(lower[j + 1] - upper[i]) <= abs(upper[i + 1] - lower[j])):
            faces.append((above[i], below[j], below[j + 1]))
            j += 1
        else:
            faces.append((above[i], below[j], above[i + 1]))
            i += 1
    return np.array(faces)


def closed_cloth(rows: list[np.ndarray]) -> dict[str, np.ndarray]:
    """The arrays of a garment's file but for UV and pins, from rows of vertices [m], shape (C + 1, 3), the last one a
    copy of the first, to which it is sewn. Also `share`, how far round each vertex lies, and `row`, its number."""
    shares = [np.linspace(0, 1, len(row)) for row in rows]
    faces, row = strips(shares)
    ends = np.cumsum([len(r) for r in rows])
    seams = np.column_stack([ends - [len(r) for r in rows], ends - 1])
    return {"rest": np.concatenate(rows), "faces": faces, "seams": seams, "share": np.concatenate(shares), "row": row}


def fan_chart(cloth: dict[str, np.ndarray], width: np.ndarray, margin: float) -> np.ndarray:
    """A chart as wide at each row as the cloth is there, shape (rows,), in the unit square, shape (V, 2)."""
    u = 0.5 + (cloth["share"] - 0.5) * (width / width.max())[cloth["row"]]
    steps = np.linalg.norm(np.diff(cloth["rest"][cloth["seams"][:, 0]], axis=0), axis=1)
    down = np.concatenate([[0], np.cumsum(steps)]) / steps.sum()
    return margin + (1 - 2 * margin) * np.column_stack([u, 1 - down[cloth["row"]]])
