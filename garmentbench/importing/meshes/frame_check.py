"""Do a mesh's frames belong to its rest shape, and to each other? Equal numbers of vertices don't say so."""

import numpy as np

from garmentbench.geometry.mesh import unique_edges
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal

_OFF = 0.25  # median of how much longer or shorter edges are, as a logarithm: worn cloth and moving skin have 0.05
_MIRRORED = 0.1  # squared misfit of the mirror image over that of the shape itself, below which it is one
_EDGES = 2_000  # edges that are looked at in every frame
_TELLS = 0.3  # correlation of how edges bend, at rest and in a frame, from which on it tells
_ENOUGH = 30  # edges
_OPTION = "give --other-template if it is meant to differ (a flat pattern)"


def check_frames(mesh: MeshSequence, other_template: bool = False) -> None:
    """Raises `UserError` where a rest shape of its own has other proportions than frame 0, is its mirror image or in
    another unit, or where a later frame has other proportions than frame 0; names the likely cause.

    `other_template`: a rest shape is allowed to differ.
    """
    edges = unique_edges(mesh.faces)
    edges = edges[np.unique(np.linspace(0, len(edges) - 1, _EDGES).astype(int))]
    first = np.asarray(mesh.frames[0], np.float64)
    if not np.isfinite(first).all():
        return  # said elsewhere, with its place
    if mesh.rest is not None and not other_template:
        _check_rest(mesh, edges, first)
    length = _lengths(first, edges)
    for t in range(1, len(mesh.frames)):
        with np.errstate(all="ignore"):
            off = _off(_lengths(np.asarray(mesh.frames[t], np.float64), edges) / length)
        if off > _OFF:
            found = f"frame {t} has other proportions than frame 0 (edges {_percent(off)} off, median)"
            do = "export all frames from one mesh, its vertices in one order"
            raise refusal(mesh.where, f"{found}: another order of vertices?", do)


def _check_rest(mesh: MeshSequence, edges: np.ndarray, first: np.ndarray) -> None:
    rest = np.asarray(mesh.rest, np.float64)
    template = mesh.files[1].name if len(mesh.files) > 1 and mesh.files[0] != mesh.files[1] else "its rest shape"
    with np.errstate(all="ignore"):
        ratio = _lengths(first, edges) / _lengths(rest, edges)
    ratio = ratio[np.isfinite(ratio) & (ratio > 0)]
    if not len(ratio):
        return
    off, scale = _off(ratio), float(np.exp(np.median(np.log(ratio))))
    if off <= _OFF:
        if _is_mirror_image(rest, first, mesh.faces):
            found = f"{template} is the mirror image of frame 0"
            do = "export both with the same axes (one of them is left-handed, or has y and z swapped)"
            raise refusal(mesh.where, found, do)
        return
    if _off(ratio / scale) <= _OFF:
        found = f"{template} is {1 / scale:.3g} times as large as frame 0: another unit?"
        raise refusal(mesh.where, found, "export both in the same unit")
    found = (
        f"{template} has other proportions than frame 0 (edges {_percent(off)} off, median): another order of vertices?"
    )
    raise refusal(mesh.where, found, f"export both from one mesh, its vertices in one order; {_OPTION}")


def _lengths(positions: np.ndarray, edges: np.ndarray) -> np.ndarray:
    return np.linalg.norm(positions[edges[:, 0]] - positions[edges[:, 1]], axis=1)


def _off(ratio: np.ndarray) -> float:
    """Median deviation of lengths, as a logarithm; 0 where none can be compared."""
    ratio = ratio[np.isfinite(ratio) & (ratio > 0)]
    return float(np.median(np.abs(np.log(ratio)))) if len(ratio) else 0.0


def _percent(off: float) -> str:
    return f"{100 * np.expm1(off):.0f} %"


def _is_mirror_image(rest: np.ndarray, frame: np.ndarray, faces: np.ndarray) -> bool:
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
