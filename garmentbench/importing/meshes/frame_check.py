"""Do a mesh's frames belong to its rest shape, and to each other? Equal numbers of vertices don't say so."""

import numpy as np

from garmentbench.geometry.mesh import unique_edges
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal
from garmentbench.importing.meshes.mirror_image import is_mirror_image
from garmentbench.importing.meshes.vertex_order import CLOTH, SKIN, Order

_OFF = 0.25  # median of how much longer or shorter edges are, as a logarithm: worn cloth and moving skin have 0.05
_EXACT = 0.004  # 90th percentile of what edges differ by from a stretched shape's: nothing but the stretch differs
_SCALED = 0.04  # stretch along an axis, as a logarithm
_SEEN = 0.1  # mean squared cosine between edges and an axis: a flat shape has no third one
_MUCH = 0.18  # 90th percentile of edges: cloth has 0.11 at most
_OPTION = "give --other-template if it is meant to differ (a flat pattern)"
_ALONG = 0.95  # cosine between an axis and the one that it is called by
_LISTED = 3  # vertices


def check_rest(mesh: MeshSequence, skin: bool = False) -> list[str]:
    """Warnings where a rest shape of its own is odd beside frame 0; `skin`: of a human body, which stretches more.

    Raises `UserError`, naming the likely cause, where it has other proportions, another unit or another order of
    some vertices, or is its mirror image.
    """
    first = np.asarray(mesh.frames[0], np.float64)
    if mesh.rest is None or not np.isfinite(first).all():
        return []  # what is not finite is said elsewhere, with its place
    rest = np.asarray(mesh.rest, np.float64)
    template = mesh.files[-1].name if len(mesh.files) > 1 else "its rest shape"
    edges = unique_edges(mesh.faces)
    with np.errstate(all="ignore"):
        ratio = _lengths(first, edges) / _lengths(rest, edges)
    kept = np.isfinite(ratio) & (ratio > 0)
    edges, ratio = edges[kept], ratio[kept]
    if not len(ratio):
        return []
    off, scale = _off(ratio), float(np.exp(np.median(np.log(ratio))))
    if off > _OFF and _off(ratio / scale) <= _OFF:
        found = f"{template} is {1 / scale:.3g} times as large as frame 0: another unit?"
        raise refusal(mesh.where, found, "export both in the same unit")
    if off > _OFF:
        found = f"{template} has other proportions than frame 0 (edges {_percent(off)} off, median)"
        do = f"export both from one mesh, its vertices in one order; {_OPTION}"
        raise refusal(mesh.where, f"{found}: another order of vertices?", do)
    limit = SKIN if skin else CLOTH
    misplaced = Order(first, mesh.faces, limit).misplaced(rest * scale)
    if not len(misplaced):
        misplaced = Order(rest * scale, mesh.faces, limit).misplaced(first)
    if len(misplaced):
        found = f"{_vertices(mesh, misplaced)} of {template} are elsewhere in frame 0: another order of some vertices?"
        do = f"export both from one mesh, its vertices in one order; {_OPTION}"
        raise refusal(mesh.where, found, do)
    if is_mirror_image(rest, first, mesh.faces):
        found = f"{template} is the mirror image of frame 0"
        do = "export both with the same axes (one of them is left-handed, or has y and z swapped)"
        raise refusal(mesh.where, found, do)
    return _check_stretch(mesh, template, rest, edges, ratio, skin)


def check_frames(mesh: MeshSequence, count: int, skin: bool = False) -> None:
    """Raises `UserError` where one of the first `count` frames has other proportions than frame 0, or another order of
    some vertices; `skin` as of `check_rest`."""
    first = np.asarray(mesh.frames[0], np.float64)
    if not np.isfinite(first).all():
        return
    order = Order(first, mesh.faces, SKIN if skin else CLOTH)
    for t in range(1, min(count, len(mesh.frames))):
        frame = np.asarray(mesh.frames[t], np.float64)
        off, misplaced = order.off(frame), order.misplaced(frame)
        if off <= _OFF and not len(misplaced):
            continue
        found = f"frame {t} has other proportions than frame 0 (edges {_percent(off)} off, median)"
        if off <= _OFF:
            found = f"{_vertices(mesh, misplaced)} of frame 0 are elsewhere in frame {t}"
        do = f"export all frames from one mesh, or cut it there (--frames {t})"
        raise refusal(mesh.where, f"{found}: another order of vertices, or a simulation that went wrong?", do)


def _check_stretch(
    mesh: MeshSequence, template: str, rest: np.ndarray, edges: np.ndarray, ratio: np.ndarray, skin: bool
) -> list[str]:
    """A warning where edges are off as cloth never is. Raises `UserError` where frame 0 is a stretched rest shape and
    nothing else, which no cloth is."""
    scales, along, left = _stretch(rest, edges, ratio)
    said = _scaling(scales, along)
    if left <= _EXACT and said:
        found = f"frame 0 is {template} scaled by {said} and nothing else"
        raise refusal(mesh.where, f"{found}: a scale that one of the files lacks?", f"export both alike; {_OPTION}")
    most = float(np.percentile(np.abs(np.log(ratio)), 90))
    if skin or most <= _MUCH:
        return []
    likely = f", as if scaled by {said}" if said and left < 0.5 * most else ""
    return [
        f"warning: a tenth of the edges of {template} is off those of frame 0 by {_percent(most)} or more{likely}: "
        "cloth stretches by 10 to 20 %; is it this garment's, in this size?"
    ]


def _stretch(rest: np.ndarray, edges: np.ndarray, ratio: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """The scaling along three axes of a shape's that explains the ratios of its edges' lengths best: by how much,
    shape (3,), the axes, shape (3, 3), and the 90th percentile of what is left, as a logarithm.

    A linear map M makes d to a length of sqrt(d^T M^T M d).
    """
    d = rest[edges[:, 0]] - rest[edges[:, 1]]
    d = d / np.maximum(np.linalg.norm(d, axis=1, keepdims=True), 1e-30)
    x, y, z = d.T
    table = np.stack([x * x, y * y, z * z, 2 * x * y, 2 * x * z, 2 * y * z], axis=1)
    a, b, c, e, f, g = np.linalg.lstsq(table, ratio**2, rcond=None)[0]
    values, vectors = np.linalg.eigh(np.array([[a, e, f], [e, b, g], [f, g, c]]))
    left = np.log(np.sqrt(np.maximum(table @ [a, b, c, e, f, g], 1e-12)) / ratio)
    seen = ((d @ vectors) ** 2).mean(axis=0) > _SEEN
    scales = np.where(seen, np.sqrt(np.maximum(values, 1e-12)), 1.0)
    return scales, np.abs(vectors.T), float(np.percentile(np.abs(left), 90))


def _scaling(scales: np.ndarray, along: np.ndarray) -> str:
    """Scales along axes in words; "" for none."""
    off = [(s, axis) for s, axis in zip(scales, along, strict=True) if abs(np.log(s)) > _SCALED]
    if len(off) == 3 and np.ptp(np.log(scales)) < _SCALED:
        return f"{scales.mean():.3g}"
    return " and ".join(
        f"{s:.3g} along {'xyz'[axis.argmax()] if axis.max() > _ALONG else 'an axis between x, y and z'}"
        for s, axis in off
    )


def _lengths(positions: np.ndarray, edges: np.ndarray) -> np.ndarray:
    return np.linalg.norm(positions[edges[:, 0]] - positions[edges[:, 1]], axis=1)


def _off(ratio: np.ndarray) -> float:
    """Median deviation of lengths, as a logarithm."""
    return float(np.median(np.abs(np.log(ratio))))


def _percent(off: float) -> str:
    return f"{100 * np.expm1(off):.0f} %"


def _vertices(mesh: MeshSequence, which: np.ndarray) -> str:
    """The first few vertices by their numbers in the file, from 0 on, and how many there are."""
    numbers = which if mesh.numbers is None else mesh.numbers[which]
    listed = ", ".join(map(str, numbers[:_LISTED])) + (" ..." if len(which) > _LISTED else "")
    return f"vertices {listed} ({len(which)} with those beside them)"
