"""Which triangles of a plane overlap, and by how much."""

from dataclasses import dataclass

import numpy as np

DEPTH = 1e-6  # of the plane figure's extent: triangles that overlap less deep than this only touch
_CHUNK = 64  # triangles that are looked up at a time
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

    Shapely's STRtree finds the candidates. Exact up to `DEPTH`, which no predicate of shapely's allows for; triangles
    without area overlap nothing. Ends early, saying so, after 60 million candidates or 100,000 overlapping pairs: a
    layout with every triangle on every other would ask for them all.

    Args:
        triangles: Shape (N, 3, 2), finite, either way round.
    """
    import shapely

    if not len(triangles):
        return Overlap(np.zeros((0, 2), np.int64), np.zeros(0), True)
    extent = float(np.ptp(triangles.reshape(-1, 2), axis=0).max()) or 1.0
    t = (triangles - triangles.reshape(-1, 2).mean(axis=0)) / extent
    turn = _cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    solid = np.flatnonzero(np.abs(turn) > DEPTH**2)
    t = np.where((turn < 0)[:, None, None], t[:, ::-1], t)[solid]  # all anticlockwise
    polygons = shapely.polygons(t)
    tree = shapely.STRtree(polygons)
    candidates, room, pairs = _MOST_CANDIDATES, _MOST_PAIRS, [np.zeros((0, 2), np.int64)]
    for start in range(0, len(t), _CHUNK):
        a, b = tree.query(polygons[start : start + _CHUNK])
        a, b = a[a + start < b] + start, b[a + start < b]
        deep = ~(_apart(t[a], t[b]) | _apart(t[b], t[a]))
        pairs.append(np.stack([a[deep], b[deep]], axis=1)[:room])
        candidates, room = candidates - len(a), room - int(deep.sum())
        if candidates < 0 or room < 0:
            break
    pair = np.concatenate(pairs)
    pair = pair[np.lexsort(pair.T[::-1])]
    area = shapely.area(shapely.intersection(polygons[pair[:, 0]], polygons[pair[:, 1]])) * extent**2
    return Overlap(solid[pair], area, complete=candidates >= 0 and room >= 0)


def _apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Does a side of a part it from b, both anticlockwise, shape (N, 3, 2)? Then all of b is right of it.

    Shape (N,).
    """
    apart = np.zeros(len(a), bool)
    for k in range(3):
        side = a[:, (k + 1) % 3] - a[:, k]
        inside = np.stack([_cross(side, b[:, m] - a[:, k]) for m in range(3)]).max(axis=0)
        apart |= inside <= DEPTH * np.linalg.norm(side, axis=1)
    return apart


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
