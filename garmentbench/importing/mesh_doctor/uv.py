"""The UV map of a garment: is there one, in the unit square, every triangle once and the same way round in its
chart?"""

import numpy as np

from garmentbench.errors import Problem
from garmentbench.importing.mesh_doctor.finding import Finding, listed
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.overlap import overlaps
from garmentbench.importing.mesh_doctor.topology import components, repeats_a_corner, winding
from garmentbench.importing.text import counted

NO_AREA = 1e-12  # of the UV map's extent squared: a triangle that no texel sees
MUCH = 1e-3  # overlap over covered area above which a method learns the wrong thing


def missing(mesh: Mesh) -> list[Finding]:
    """No UV at all, the same for all, or none for some faces."""
    do = "unwrap the garment (--fix OUT --make-uv does, by xatlas)"
    if mesh.uv is None:
        return [Finding(Problem("uv", "the mesh has no UV map", "unwrap the garment (--fix OUT does, by xatlas)"))]
    bare = np.flatnonzero(~np.isfinite(mesh.uv[mesh.faces]).all(axis=(1, 2)))
    if len(bare):
        what = f"{counted(len(bare), 'face')} without UV coordinates, at face {listed(bare)}"
        return [Finding(Problem("uv", what, do), faces=bare)]
    if np.ptp(mesh.uv[mesh.faces].reshape(-1, 2), axis=0).min() == 0:
        return [Finding(Problem("uv", "the UV map has no area: all its coordinates lie on a line or point", do))]
    return []


def outside(mesh: Mesh) -> list[Finding]:
    """UV coordinates beyond the unit square."""
    used = np.unique(mesh.faces)
    bad = used[((mesh.required_uv[used] < 0) | (mesh.required_uv[used] > 1)).any(axis=1)]
    if not len(bad):
        return []
    low, high = mesh.required_uv[used].min(axis=0), mesh.required_uv[used].max(axis=0)
    what = (
        f"{counted(len(bad), 'vertex', 'vertices')} outside [0, 1] (UV reach from {_pair(low)} to {_pair(high)}), "
        f"at vertex {listed(mesh.numbers[bad])}"
    )
    faces = np.flatnonzero(np.isin(mesh.faces, bad).any(axis=1))
    return [Finding(Problem("uv", what, "scale the UV map into the unit square (--fix does)"), faces=faces, in_uv=True)]


def charts(mesh: Mesh) -> np.ndarray:
    """Chart of each face, shape (F,): faces that share vertices share a chart."""
    pairs = np.concatenate([mesh.faces[:, :2], mesh.faces[:, 1:]])
    return components(len(mesh.vertices), pairs)[mesh.faces[:, 0]]


def uv_areas(mesh: Mesh) -> np.ndarray:
    """Area of each face in UV, negative where it runs clockwise once neighbours agree in 3D, shape (F,)."""
    a, b, c = mesh.required_uv[mesh.faces].transpose(1, 2, 0)
    area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2
    return np.where(winding(mesh.sides).turned, -area, area)


def folds(mesh: Mesh) -> list[Finding]:
    """Triangles without area in UV, and such as run against the rest of their chart."""
    area, chart, found = uv_areas(mesh), charts(mesh), []
    extent = np.ptp(mesh.required_uv[mesh.faces].reshape(-1, 2), axis=0).max()
    whole = ~repeats_a_corner(mesh.corners)
    empty = whole & (np.abs(area) <= NO_AREA * extent**2)
    if empty.any():
        faces = np.flatnonzero(empty)
        what = f"{counted(len(faces), 'face')} without area in UV, at face {listed(faces)}"
        found.append(Finding(Problem("uv", what, "unwrap there again", warning=True), faces=faces))
    _, chart = np.unique(chart, return_inverse=True)
    mirrored = np.bincount(chart.ravel(), np.sign(area)) < 0
    wrong = np.flatnonzero(whole & ~empty & ((area < 0) != mirrored[chart.ravel()]))
    if len(wrong):
        what = f"{counted(len(wrong), 'face')} flipped in UV against the rest of the chart, at face {listed(wrong)}"
        problem = Problem("uv", what, "unwrap there again, or --fix OUT --make-uv", warning=True)
        found.append(Finding(problem, faces=wrong, in_uv=True))
    return found


def overlapping(mesh: Mesh) -> list[Finding]:
    """Faces that share room in UV: a map drawn through them holds one and forgets the other."""
    found = overlaps(mesh.required_uv[mesh.faces])
    if not len(found.pairs):
        return []
    faces, chart = np.unique(found.pairs), charts(mesh)
    share = found.area.sum() / np.abs(uv_areas(mesh)).sum()
    worst = found.pairs[np.argmax(found.area)]
    between = np.unique(np.sort(chart[found.pairs], axis=1), axis=0)
    within = int((between[:, 0] == between[:, 1]).sum())
    kinds = (f"{counted(len(between) - within, 'pair')} of charts", f"within {counted(within, 'chart')}")
    where = " and ".join(kind for kind, there in zip(kinds, (len(between) > within, within), strict=True) if there)
    at_least = "" if found.complete else "at least "
    middle = mesh.required_uv[mesh.faces[worst[0]]].mean(axis=0)
    what = (
        f"{at_least}{counted(len(faces), 'face')} overlap in UV ({where}), by {at_least}{100 * share:.3g} % of the "
        f"map, most of all faces {worst[0]} and {worst[1]} near UV {_pair(middle)}, at face {listed(faces)}"
    )
    problem = Problem("uv", what, "lay the charts side by side, or --fix OUT --make-uv", warning=bool(share < MUCH))
    return [Finding(problem, faces=faces, in_uv=True)]


def _pair(uv: np.ndarray) -> str:
    return f"({uv[0]:.3g}, {uv[1]:.3g})"
