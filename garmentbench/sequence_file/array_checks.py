"""Single checks of a sequence's arrays. Each gives the problems that it finds, an empty list if there are none.

Those that are made for one array ("garment/rest") or mesh ("garment", "body") are functions that return the check.
"""

from collections.abc import Callable

import numpy as np

from garmentbench.errors import Problem
from garmentbench.geometry.mesh import edge_lengths, unique_edges
from garmentbench.sequence_file.layout import REMAKE

FIRST_FRAME = "frame 0"  # where first-frame penetration is reported
SMALLEST, LARGEST = 0.05, 8.0  # diagonal of a rest shape's bounding box [m]
SEAM_GAP = 1e-4  # [m] at rest
SEAM_SPLIT = 0.01  # [m] while moving
INSIDE_PERCENT = 1.0  # of the garment's vertices in frame 0
CROSSING_PERCENT = 0.1  # of the garment's faces, mean over frames
_REPAIR = "repair the mesh where it was made, then make the file again"

Arrays = dict[str, np.ndarray]
Check = Callable[[Arrays], list[Problem]]


def finite(name: str, array: np.ndarray) -> list[Problem]:
    """Numbers that are not finite."""
    if array.dtype.kind != "f" or np.isfinite(array).all():
        return []
    bad = np.argwhere(~np.isfinite(array))
    axes = ("frame", "vertex", "coordinate")[-array.ndim :] if array.ndim > 1 else ("index",)
    place = ", ".join(f"{axis} {i}" for axis, i in zip(axes[: max(array.ndim - 1, 1)], bad[0], strict=False))
    what = f"NaN or infinite at {place} ({len(bad)} numbers in all)"
    return [Problem(name, what, "simulate with smaller steps, or cut the recording before that frame")]


def runs_finite(a: Arrays) -> list[Problem]:
    """Further runs that broke. They stay in the file, and what is measured against the ensemble leaves them out."""
    problems = []
    for k, run in enumerate(a["garment/runs"], start=1):
        good = np.isfinite(run).all(axis=(1, 2))
        if not good.all():
            what = f"further run {k} is not finite from frame {int(np.argmin(good))} on; errors leave it out"
            do = "simulate with smaller steps (step_margin under [simulation]), or bear it in mind"
            problems.append(Problem("garment/runs", what, do, warning=True))
    return problems


def not_empty(name: str) -> Check:
    """Has an array any rows?"""

    def check(a: Arrays) -> list[Problem]:
        return [] if len(a[name]) else [Problem(name, "empty", REMAKE)]

    return check


def scale(name: str) -> Check:
    """Is a rest shape of a size that a garment or a body has in metres?"""

    def check(a: Arrays) -> list[Problem]:
        size = float(np.linalg.norm(np.ptp(a[name].astype(np.float64), axis=0)))
        if SMALLEST <= size <= LARGEST:
            return []
        unit, factor = ("millimetres", 0.001) if size > 100 * LARGEST else ("centimetres", 0.01)
        guess = f": in {unit}?" if size > LARGEST else ": in another unit?"
        do = f"multiply all positions by {factor:g}" if size > LARGEST else "convert all positions to metres"
        return [Problem(name, f"measures {size:.3g} m across, wanted {SMALLEST:g} to {LARGEST:g} m{guess}", do)]

    return check


def indices(name: str, into: str) -> Check:
    """Do all indices of an array point `into` another?"""

    def check(a: Arrays) -> list[Problem]:
        indices, count = a[name], len(a[into])
        bad = np.argwhere((indices < 0) | (indices >= count))
        if not len(bad):
            return []
        what = f"row {bad[0][0]} names vertex {indices[tuple(bad[0])]}, there are {count} ({len(bad)} such in all)"
        return [Problem(name, what, _REPAIR)]

    return check


def uv(a: Arrays) -> list[Problem]:
    """Is there a UV map, and does it lie in the unit square?"""
    uv = a["garment/uv"]
    if np.ptp(uv, axis=0).min() == 0:
        return [Problem("garment/uv", "the mesh has no UV map: all its coordinates are the same", "unwrap the garment")]
    outside = np.flatnonzero(((uv < 0) | (uv > 1)).any(axis=1))
    if len(outside):
        what = f"vertex {outside[0]} is at {uv[outside[0]].tolist()}, wanted [0, 1] ({len(outside)} such in all)"
        return [Problem("garment/uv", what, "scale the UV map into the unit square")]
    return []


def pattern(a: Arrays) -> list[Problem]:
    """Is the flat pattern in the unit of the rest shape, and has each of its triangles an area?"""
    cut, faces = a["garment/cut"].astype(np.float64), a["garment/faces"]
    (x1, y1), (x2, y2) = (cut[faces[:, 1]] - cut[faces[:, 0]]).T, (cut[faces[:, 2]] - cut[faces[:, 0]]).T
    flat = np.flatnonzero(np.abs(x1 * y2 - x2 * y1) <= 1e-12)
    if len(flat):
        return [Problem("garment/cut", f"face {flat[0]} has no area ({len(flat)} such in all)", _REPAIR)]
    edges = unique_edges(faces)
    worn, laid = (float(np.median(edge_lengths(x, edges))) for x in (a["garment/rest"], cut))
    if 0.5 * worn <= laid <= 2 * worn:
        return []
    what = f"edges are {laid:.3g} m long in the pattern, {worn:.3g} m as it is put on"
    return [Problem("garment/cut", what, "bring pattern and rest shape to metres")]


def frame_scale(name: str) -> Check:
    """Are a mesh's frames in the unit of its rest shape?"""

    def check(a: Arrays) -> list[Problem]:
        edges = unique_edges(a[f"{name}/faces"])
        rest, moving = (np.median(edge_lengths(x, edges)) for x in (a[f"{name}/rest"], a[f"{name}/frames"][0]))
        if 0.2 * rest <= moving <= 5 * rest:
            return []
        what = f"edges are {moving:.3g} m long in frame 0, {rest:.3g} m at rest"
        return [Problem(f"{name}/frames", what, "bring positions and rest shape to metres")]

    return check


def mesh(name: str) -> Check:
    """Degenerate faces, edges of more than two faces, vertices of none."""

    def check(a: Arrays) -> list[Problem]:
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
        place = f"{name}/faces"
        return [Problem(place, f"{len(i)} {what} {i[0]}", _REPAIR, warning=True) for i, what in found if len(i)]

    return check


def _edge_counts(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    pairs = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    return np.unique(np.sort(pairs, axis=1), axis=0, return_counts=True)


def seams(a: Arrays) -> list[Problem]:
    """Seam pairs that are apart, at rest or in any frame."""
    i, j = a["garment/seams"].T
    problems = []
    if not len(i):
        return problems
    for name, limit in (("garment/rest", SEAM_GAP), ("garment/frames", SEAM_SPLIT)):
        positions = a[name]
        gap = np.linalg.norm(positions[..., i, :] - positions[..., j, :], axis=-1)
        gap = gap.reshape(-1, len(i)).max(axis=0, initial=0)
        apart = np.flatnonzero(gap > limit)
        if len(apart):
            what = f"pair {apart[0]} is {1e3 * gap[apart[0]]:.3g} mm apart in {name} ({len(apart)} such in all)"
            problems.append(Problem("garment/seams", what, "sew the pair, or leave it out of the seams", warning=True))
    return problems


def closed(a: Arrays) -> list[Problem]:
    """Is the body closed?"""
    _, counts = _edge_counts(a["body/faces"])
    if (counts == 2).all():
        return []
    count = int((counts != 2).sum())
    what = f"{count} edges don't have two faces: the body is not closed, and inside is not defined there"
    return [Problem("body/faces", what, "fill the holes of the body's mesh", warning=True)]


def starts_inside(a: Arrays) -> list[Problem]:
    """How much of the garment begins inside the body?"""
    from garmentbench.metrics.interpenetration import inside_vertices, interpenetration

    percent = interpenetration(inside_vertices(a["garment/frames"][:1], a["body/frames"][:1], a["body/faces"]))
    if percent <= INSIDE_PERCENT:
        return []
    what = f"{percent:.1f} % of the garment's vertices lie inside the body, wanted at most {INSIDE_PERCENT:g} %"
    return [Problem(FIRST_FRAME, what, "let the garment settle on the body before recording", warning=True)]


def through_itself(a: Arrays) -> list[Problem]:
    """How much of the garment passes through itself? Looks at every frame: for `check`, not for every reading."""
    from garmentbench.geometry.crossing import crossing_faces
    from garmentbench.metrics.self_intersection import self_intersection

    crossing = crossing_faces(a["garment/frames"], a["garment/faces"], a["garment/seams"])
    percent, frame = self_intersection(crossing), int(crossing.sum(axis=1).argmax())
    if percent <= CROSSING_PERCENT:
        return []
    what = f"{percent:.2g} % of the faces cross others, most of them ({crossing[frame].sum()}) in frame {frame}"
    do = "look at it (garmentbench view): is its scene's self_contact off, or is cloth pressed where there is no room "
    do += "for it, as under arms held close (import-motion --arm-space)?"
    return [Problem("garment/frames", what, do, warning=True)]
