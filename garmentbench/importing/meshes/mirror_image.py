"""Is one shape the mirror image of another, in whatever pose?"""

import numpy as np

_MIRRORED = 0.1  # squared misfit of the mirror image over that of the shape itself, below which it is one
_TELLS = 0.3  # correlation of how edges bend, at rest and in a frame, from which on it tells
_ENOUGH = 30  # edges


def is_mirror_image(rest: np.ndarray, frame: np.ndarray, faces: np.ndarray) -> bool:
    """Is a frame the mirror image of a shape?

    Edges bend the other way in a mirror image, in whatever pose; where that doesn't tell (a flat shape, fine wrinkles),
    it is one where the mirror image fits the frame far better than any turn of the shape.
    """
    hinges = _hinges(faces)
    bends = [_bends(positions, hinges) for positions in (rest, frame)]
    size = float(np.sqrt(np.prod([(b**2).sum() for b in bends])))
    alike = float(bends[0] @ bends[1]) / size if size > 0 else 0.0
    if len(hinges) >= _ENOUGH and abs(alike) > _TELLS:
        return alike < 0
    p, q = rest - rest.mean(axis=0), frame - frame.mean(axis=0)
    values = np.linalg.svd(p.T @ q, compute_uv=False)
    sign = np.sign(np.linalg.det(p.T @ q))
    total = (p**2).sum() + (q**2).sum()
    with_turn = total - 2 * (values[0] + values[1] + sign * values[2])
    with_mirror = total - 2 * (values[0] + values[1] - sign * values[2])
    return bool(with_mirror < _MIRRORED * with_turn)


def _hinges(faces: np.ndarray) -> np.ndarray:
    """Edges of two faces: their ends, then the corners opposite, shape (H, 4)."""
    ends = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    opposite = faces[:, [2, 0, 1]].ravel()
    edge, count = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True, return_counts=True)[1:]
    sides = np.argsort(edge.ravel(), kind="stable")
    first = np.concatenate([[0], np.cumsum(count)[:-1]])[count == 2]
    one, other = sides[first], sides[first + 1]
    return np.column_stack([ends[one], opposite[one], opposite[other]])


def _bends(positions: np.ndarray, hinges: np.ndarray) -> np.ndarray:
    """How far and which way each hinge is bent, times its length, shape (H,): the sine of its angle."""
    a, b, c, d = (positions[hinges[:, k]] for k in range(4))
    along, one, other = b - a, np.cross(b - a, c - a), np.cross(b - a, d - a)
    areas = np.linalg.norm(one, axis=1) * np.linalg.norm(other, axis=1)
    return np.sum(np.cross(one, other) * along, axis=1) / np.maximum(areas, 1e-30)
