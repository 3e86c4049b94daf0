"""What must hold of a sequence's arrays, and what should. Each check looks at everything and says where it is wrong."""

from collections.abc import Callable

import numpy as np

from garmentbench.geometry.mesh import edge_lengths, unique_edges
from garmentbench.problem import Problem, errors
from garmentbench.sequence import HUMAN, OBJECT
from garmentbench.sequence_layout import ARRAYS, COUNTED, OPTIONAL, REMAKE, Contents

FIRST_FRAME = "frame 0"  # where first-frame penetration is reported
SMALLEST, LARGEST = 0.05, 8.0  # diagonal of a rest shape's bounding box [m]
SEAM_GAP = 1e-4  # [m] at rest
SEAM_SPLIT = 0.01  # [m] while moving
INSIDE_PERCENT = 1.0  # of the garment's vertices in frame 0
_REPAIR = "repair the mesh where it was made, then make the file again"
_Arrays = dict[str, np.ndarray]


def shape_problems(contents: Contents) -> list[Problem]:
    """Arrays that are missing, or not of the type and shape of `ARRAYS`."""
    problems = []
    counts: dict[str, tuple[int, str]] = {}
    for name, (dtype, shape) in ARRAYS.items():
        array = contents.arrays.get(name)
        if array is None:
            if name not in OPTIONAL and (contents.has_body or not name.startswith("body/")):
                what = "missing: the mesh has no UV coordinates" if name == "garment/uv" else "missing"
                problems.append(Problem(name, what, REMAKE))
        elif array.dtype != dtype or not _fits(array.shape, shape):
            wanted = f"{dtype} of shape ({', '.join(map(str, shape))})"
            problems.append(Problem(name, f"{array.dtype} of shape {array.shape}, wanted {wanted}", REMAKE))
        else:
            for letter, size in zip(shape, array.shape):
                expected, there = counts.setdefault(letter, (size, name))
                if size != expected:
                    what = f"{size} {COUNTED[letter]}, but {there} has {expected}"
                    problems.append(Problem(name, what, "bring both to the same number and order"))
    return problems


def _fits(shape: tuple[int, ...], wanted: tuple[str | int, ...]) -> bool:
    return len(shape) == len(wanted) and all(isinstance(w, str) or w == s for w, s in zip(wanted, shape))


def value_problems(contents: Contents, unusable: frozenset[str] = frozenset()) -> list[Problem]:
    """What is wrong with the values.

    A check is passed over where an array that it needs is missing, `unusable`, or has failed an earlier check.
    """
    problems = _rate_and_kind(contents)
    good = {n: a for n, a in contents.arrays.items() if n not in unusable}
    for name in ("garment/rest", "garment/uv", "garment/frames", "body/rest", "body/frames"):
        if name in contents.arrays:  # even where its shape is odd
            problems += _finite(name, contents.arrays[name])
    for check, needed in _CHECKS:
        bad = {p.where for p in errors(problems)}
        if all(name in good and name not in bad for name in needed):
            problems += check(good)
    if contents.names.kind == HUMAN and not errors(problems) and not unusable:
        problems += _closed(good) + _starts_inside(good)
    return problems


def hash_problems(contents: Contents) -> list[Problem]:
    """Is it still what was written?"""
    if contents.hash() == contents.noted_hash:
        return []
    return [Problem("attribute content_hash", "does not fit the arrays: they were changed after writing", REMAKE)]


def _rate_and_kind(contents: Contents) -> list[Problem]:
    problems = []
    if not 0 < contents.fps < 1e4:
        problems.append(Problem("attribute fps", f"{contents.fps:g}, wanted frames a second", REMAKE))
    if contents.has_body and contents.names.kind not in (HUMAN, OBJECT):
        what = f"'{contents.names.kind}', wanted '{HUMAN}' or '{OBJECT}'"
        problems.append(Problem("body attribute kind", what, REMAKE))
    return problems


def _finite(name: str, array: np.ndarray) -> list[Problem]:
    if array.dtype.kind != "f" or np.isfinite(array).all():
        return []
    bad = np.argwhere(~np.isfinite(array))
    axes = ("frame", "vertex", "coordinate")[-array.ndim :] if array.ndim > 1 else ("index",)
    place = ", ".join(f"{axis} {i}" for axis, i in zip(axes[: max(array.ndim - 1, 1)], bad[0]))
    what = f"NaN or infinite at {place} ({len(bad)} numbers in all)"
    return [Problem(name, what, "simulate with smaller steps, or cut the recording before that frame")]


def _not_empty(name: str) -> Callable[[_Arrays], list[Problem]]:
    def check(a: _Arrays) -> list[Problem]:
        return [] if len(a[name]) else [Problem(name, "empty", REMAKE)]

    return check


def _scale(name: str) -> Callable[[_Arrays], list[Problem]]:
    def check(a: _Arrays) -> list[Problem]:
        size = float(np.linalg.norm(np.ptp(a[name].astype(np.float64), axis=0)))
        if SMALLEST <= size <= LARGEST:
            return []
        unit, factor = ("millimetres", 0.001) if size > 100 * LARGEST else ("centimetres", 0.01)
        guess = f": in {unit}?" if size > LARGEST else ": in another unit?"
        do = f"multiply all positions by {factor:g}" if size > LARGEST else "convert all positions to metres"
        return [Problem(name, f"measures {size:.3g} m across, wanted {SMALLEST:g} to {LARGEST:g} m{guess}", do)]

    return check


def _indices(name: str, into: str) -> Callable[[_Arrays], list[Problem]]:
    def check(a: _Arrays) -> list[Problem]:
        indices, count = a[name], len(a[into])
        bad = np.argwhere((indices < 0) | (indices >= count))
        if not len(bad):
            return []
        what = f"row {bad[0][0]} names vertex {indices[tuple(bad[0])]}, there are {count} ({len(bad)} such in all)"
        return [Problem(name, what, _REPAIR)]

    return check


def _uv(a: _Arrays) -> list[Problem]:
    uv = a["garment/uv"]
    if np.ptp(uv, axis=0).min() == 0:
        return [Problem("garment/uv", "the mesh has no UV map: all its coordinates are the same", "unwrap the garment")]
    outside = np.flatnonzero(((uv < 0) | (uv > 1)).any(axis=1))
    if len(outside):
        what = f"vertex {outside[0]} is at {uv[outside[0]].tolist()}, wanted [0, 1] ({len(outside)} such in all)"
        return [Problem("garment/uv", what, "scale the UV map into the unit square")]
    return []


def _frame_scale(name: str) -> Callable[[_Arrays], list[Problem]]:
    def check(a: _Arrays) -> list[Problem]:
        edges = unique_edges(a[f"{name}/faces"])
        rest, moving = (np.median(edge_lengths(x, edges)) for x in (a[f"{name}/rest"], a[f"{name}/frames"][0]))
        if 0.2 * rest <= moving <= 5 * rest:
            return []
        what = f"edges are {moving:.3g} m long in frame 0, {rest:.3g} m at rest"
        return [Problem(f"{name}/frames", what, "bring positions and rest shape to metres")]

    return check


def _mesh(name: str) -> Callable[[_Arrays], list[Problem]]:
    def check(a: _Arrays) -> list[Problem]:
        faces, rest = a[f"{name}/faces"], a[f"{name}/rest"].astype(np.float64)
        p, q, r = (rest[faces[:, k]] for k in range(3))
        flat = np.flatnonzero(np.linalg.norm(np.cross(q - p, r - p), axis=1) <= 1e-12)
        _, counts = _edge_counts(faces)
        unused = np.setdiff1d(np.arange(len(rest)), faces)
        found = (
            (flat, "degenerate faces (no area), the first is face"),
            (np.flatnonzero(counts > 2), "edges with more than two faces (not manifold), the first is edge"),
            (unused, "vertices without a face, the first is vertex"),
        )
        return [Problem(f"{name}/faces", f"{len(i)} {what} {i[0]}", _REPAIR, warning=True) for i, what in found if len(i)]

    return check


def _edge_counts(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    pairs = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    return np.unique(np.sort(pairs, axis=1), axis=0, return_counts=True)


def _seams(a: _Arrays) -> list[Problem]:
    i, j = a["garment/seams"].T
    problems = []
    if not len(i):
        return problems
    for name, limit in (("garment/rest", SEAM_GAP), ("garment/frames", SEAM_SPLIT)):
        positions = a[name]
        gap = np.linalg.norm(positions[..., i, :] - positions[..., j, :], axis=-1).reshape(-1, len(i)).max(axis=0, initial=0)
        apart = np.flatnonzero(gap > limit)
        if len(apart):
            what = f"pair {apart[0]} is {1e3 * gap[apart[0]]:.3g} mm apart in {name} ({len(apart)} such in all)"
            problems.append(Problem("garment/seams", what, "sew the pair, or leave it out of the seams", warning=True))
    return problems


def _closed(a: _Arrays) -> list[Problem]:
    _, counts = _edge_counts(a["body/faces"])
    if (counts == 2).all():
        return []
    what = f"{int((counts != 2).sum())} edges don't have two faces: the body is not closed, and inside is not defined there"
    return [Problem("body/faces", what, "fill the holes of the body's mesh", warning=True)]


def _starts_inside(a: _Arrays) -> list[Problem]:
    from garmentbench.metrics.interpenetration import interpenetration

    percent = interpenetration(a["garment/frames"][:1], a["body/frames"][:1], a["body/faces"])
    if percent <= INSIDE_PERCENT:
        return []
    what = f"{percent:.1f} % of the garment's vertices lie inside the body, wanted at most {INSIDE_PERCENT:g} %"
    return [Problem(FIRST_FRAME, what, "let the garment settle on the body before recording", warning=True)]


_CHECKS: tuple[tuple[Callable[[_Arrays], list[Problem]], tuple[str, ...]], ...] = (
    *((_not_empty(n), (n,)) for n in ARRAYS if n.endswith(("/rest", "/faces", "/frames"))),
    (_scale("garment/rest"), ("garment/rest",)),
    (_scale("body/rest"), ("body/rest",)),
    (_indices("garment/faces", "garment/rest"), ("garment/faces", "garment/rest")),
    (_indices("garment/seams", "garment/rest"), ("garment/seams", "garment/rest")),
    (_indices("garment/pins", "garment/rest"), ("garment/pins", "garment/rest")),
    (_indices("body/faces", "body/rest"), ("body/faces", "body/rest")),
    (_uv, ("garment/uv",)),
    (_mesh("garment"), ("garment/faces", "garment/rest")),
    (_mesh("body"), ("body/faces", "body/rest")),
    (_frame_scale("garment"), ("garment/faces", "garment/rest", "garment/frames")),
    (_frame_scale("body"), ("body/faces", "body/rest", "body/frames")),
    (_seams, ("garment/seams", "garment/rest", "garment/frames")),
)
