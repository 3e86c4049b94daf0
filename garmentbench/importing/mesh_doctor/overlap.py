"""Which triangles of a plane overlap, and by how much: a sweep for candidates, then exact tests and areas."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

DEPTH = 1e-6  # of the plane figure's extent: triangles that overlap less deep than this only touch
_CHUNK = 1_000_000  # candidate pairs at a time
_MOST_CANDIDATES = 60_000_000
_MOST_PAIRS = 100_000


@dataclass(frozen=True)
class Overlap:
    """Overlapping triangles.

    Attributes:
        pairs: Triangle pairs, lower index first, shape (K, 2).
        area: Area common to each pair, in the unit of the coordinates squared, shape (K,).
        complete: False where there were so many that the search was ended early.
    """

    pairs: np.ndarray
    area: np.ndarray
    complete: bool


def overlaps(triangles: np.ndarray) -> Overlap:
    """All pairs of triangles that overlap. Neighbours that share an edge or a corner do so only where one is folded.

    Exact up to `DEPTH`; triangles without area overlap nothing. Ends early, saying so, after 60 million candidates or
    100,000 overlapping pairs: a layout with every triangle on every other would ask for them all.

    Args:
        triangles: Shape (N, 3, 2), finite, either way round.
    """
    if not len(triangles):
        return Overlap(np.zeros((0, 2), np.int64), np.zeros(0), True)
    extent = float(np.ptp(triangles.reshape(-1, 2), axis=0).max()) or 1.0
    t = (triangles - triangles.reshape(-1, 2).mean(axis=0)) / extent
    turn = _cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    whole = np.where((turn < 0)[:, None, None], t[:, ::-1], t)  # all anticlockwise
    solid = np.flatnonzero(np.abs(turn) > DEPTH**2)
    solid = solid[np.argsort(whole[solid, :, 0].min(axis=1), kind="stable")]
    t, candidates, room, pairs = whole[solid], _MOST_CANDIDATES, _MOST_PAIRS, [np.zeros((0, 2), np.int64)]
    for a, b in _candidates(t):
        candidates, deep = candidates - len(a), ~(_apart(t[a], t[b]) | _apart(t[b], t[a]))
        pairs.append(np.stack([a[deep], b[deep]], axis=1)[:room])
        room -= int(deep.sum())
        if candidates < 0 or room < 0:
            break
    pair = np.sort(solid[np.concatenate(pairs)], axis=1)
    pair = pair[np.lexsort(pair.T[::-1])]
    area = _common_area(whole[pair[:, 0]], whole[pair[:, 1]]) * extent**2
    return Overlap(pair, area, complete=candidates >= 0 and room >= 0)


def _candidates(t: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Pairs whose boxes overlap, of triangles sorted by their left ends, about `_CHUNK` candidates at a time."""
    low, high = t.min(axis=1), t.max(axis=1)
    after = np.searchsorted(low[:, 0], high[:, 0], side="left") - np.arange(len(t)) - 1
    ends = np.cumsum(np.maximum(after, 0))
    start = 0
    while start < len(t):
        before = ends[start - 1] if start else 0
        stop = max(int(np.searchsorted(ends, before + _CHUNK)), start + 1)
        count = np.maximum(after[start:stop], 0)
        a = np.repeat(np.arange(start, min(stop, len(t))), count)
        b = a + 1 + np.arange(len(a)) - np.repeat(np.cumsum(count) - count, count)
        meet = (low[a, 1] < high[b, 1]) & (low[b, 1] < high[a, 1])
        yield a[meet], b[meet]
        start = stop


def _apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Does a side of a part it from b, both anticlockwise, shape (N, 3, 2)? Then all of b is right of it; shape (N,)."""
    apart = np.zeros(len(a), bool)
    for k in range(3):
        side = a[:, (k + 1) % 3] - a[:, k]
        inside = np.stack([_cross(side, b[:, m] - a[:, k]) for m in range(3)]).max(axis=0)
        apart |= inside <= DEPTH * np.linalg.norm(side, axis=1)
    return apart


def _common_area(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Area common to pairs of triangles, shape (N, 3, 2) each: that of the hull of all corners of one inside the other
    and of all points where sides cross."""
    points = np.concatenate([a, b, *(_crossings(a, b, i, j)[:, None] for i in range(3) for j in range(3))], axis=1)
    points[:, :3][~_inside(a, b)] = np.nan
    points[:, 3:6][~_inside(b, a)] = np.nan
    there = ~np.isnan(points[..., 0])
    middle = np.nansum(points, axis=1) / np.maximum(there.sum(axis=1), 1)[:, None]
    spokes = points - middle[:, None]
    spokes[~there] = 0.0
    angle = np.where(there, np.arctan2(spokes[..., 1], spokes[..., 0]), 9.0)  # those that are not there come last
    order = np.argsort(angle, axis=1)
    ring = np.take_along_axis(spokes, order[..., None], axis=1)
    count = there.sum(axis=1)
    ring = np.where((np.arange(ring.shape[1]) < count[:, None])[..., None], ring, ring[:, :1])  # ... and close the ring
    return np.abs(_cross(ring, np.roll(ring, -1, axis=1)).sum(axis=1)) / 2


def _inside(points: np.ndarray, triangle: np.ndarray) -> np.ndarray:
    """Which points, shape (N, 3, 2), lie in their anticlockwise triangle, shape (N, 3, 2)."""
    inside = np.ones(points.shape[:2], bool)
    for k in range(3):
        side = triangle[:, (k + 1) % 3] - triangle[:, k]
        inside &= _cross(side[:, None], points - triangle[:, None, k]) >= 0
    return inside


def _crossings(a: np.ndarray, b: np.ndarray, i: int, j: int) -> np.ndarray:
    """Where side i of a crosses side j of b, shape (N, 2); NaN where it does not."""
    p, r = a[:, i], a[:, (i + 1) % 3] - a[:, i]
    q, s = b[:, j], b[:, (j + 1) % 3] - b[:, j]
    bend = _cross(r, s)
    safe = np.where(bend == 0, 1.0, bend)
    along_a, along_b = _cross(q - p, s) / safe, _cross(q - p, r) / safe
    met = (bend != 0) & (along_a >= 0) & (along_a <= 1) & (along_b >= 0) & (along_b <= 1)
    return np.where(met[:, None], p + along_a[:, None] * r, np.nan)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
