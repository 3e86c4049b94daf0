"""What must hold of a sequence's arrays, and what should. Each check looks at everything and says where it is wrong."""

from garmentbench.errors import Problem, errors
from garmentbench.sequence import GARMENT, HUMAN, OBJECT
from garmentbench.sequence_file.array_checks import (
    Check,
    closed,
    finite,
    frame_scale,
    indices,
    mesh,
    not_empty,
    pattern,
    runs_finite,
    scale,
    seams,
    starts_inside,
    uv,
)
from garmentbench.sequence_file.layout import ARRAYS, COUNTED, OPTIONAL, REMAKE, Contents


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
            for letter, size in zip(shape, array.shape, strict=True):
                expected, there = counts.setdefault(letter, (size, name))
                if size != expected:
                    what = f"{size} {COUNTED[letter]}, but {there} has {expected}"
                    problems.append(Problem(name, what, "bring both to the same number and order"))
    return problems


def _fits(shape: tuple[int, ...], wanted: tuple[str | int, ...]) -> bool:
    return len(shape) == len(wanted) and all(isinstance(w, str) or w == s for w, s in zip(wanted, shape, strict=True))


def value_problems(contents: Contents, unusable: frozenset[str] = frozenset()) -> list[Problem]:
    """What is wrong with the values.

    A check is passed over where an array that it needs is missing, `unusable`, or has failed an earlier check.
    """
    problems = _rate_and_kind(contents)
    good = {n: a for n, a in contents.arrays.items() if n not in unusable}
    for name in ("garment/rest", "garment/uv", "garment/cut", "garment/frames", "body/rest", "body/frames"):
        if name in contents.arrays:  # even where its shape is odd
            problems += finite(name, contents.arrays[name])
    for check, needed in _CHECKS:
        bad = {p.where for p in errors(problems)}
        if all(name in good and name not in bad for name in needed):
            problems += check(good)
    if contents.names.kind in (HUMAN, GARMENT) and not errors(problems) and not unusable:
        problems += (closed(good) if contents.names.kind == HUMAN else []) + starts_inside(good)
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
    if contents.has_body and contents.names.kind not in (HUMAN, OBJECT, GARMENT):
        what = f"'{contents.names.kind}', wanted '{HUMAN}', '{OBJECT}' or '{GARMENT}'"
        problems.append(Problem("body attribute kind", what, REMAKE))
    return problems


_CHECKS: tuple[tuple[Check, tuple[str, ...]], ...] = (
    *((not_empty(n), (n,)) for n in ARRAYS if n.endswith(("/rest", "/faces", "/frames", "/runs"))),
    (runs_finite, ("garment/runs",)),
    (scale("garment/rest"), ("garment/rest",)),
    (scale("body/rest"), ("body/rest",)),
    (indices("garment/faces", "garment/rest"), ("garment/faces", "garment/rest")),
    (indices("garment/seams", "garment/rest"), ("garment/seams", "garment/rest")),
    (indices("garment/pins", "garment/rest"), ("garment/pins", "garment/rest")),
    (indices("body/faces", "body/rest"), ("body/faces", "body/rest")),
    (uv, ("garment/uv",)),
    (pattern, ("garment/cut", "garment/faces", "garment/rest")),
    (mesh("garment"), ("garment/faces", "garment/rest")),
    (mesh("body"), ("body/faces", "body/rest")),
    (frame_scale("garment"), ("garment/faces", "garment/rest", "garment/frames")),
    (frame_scale("body"), ("body/faces", "body/rest", "body/frames")),
    (seams, ("garment/seams", "garment/rest", "garment/frames")),
)
