"""Where a garment starts inside the body."""

import numpy as np

from garmentbench.errors import Problem
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.importing.mesh_doctor.finding import Finding, counted
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.topology import sides
from garmentbench.importing.mesh_doctor.wearer import Wearer
from garmentbench.sequence_file.array_checks import INSIDE_PERCENT

DEEP = 0.02  # [m] deeper than this nothing is pushed: the garment is worn wrongly, or by another body
_WORST = 3  # places named by their coordinates


def depths(points: np.ndarray, wearer: Wearer) -> np.ndarray:
    """How deep points [m], shape (P, 3), lie inside the body [m], shape (P,), negative outside."""
    from garmentbench.metrics.interpenetration_strict import signed_distances

    points, rest = points[None].astype(np.float32), wearer.body.rest[None].astype(np.float32)
    return -signed_distances(points, rest, wearer.body.faces.astype(np.int32))[0].astype(np.float64)


def open_body(wearer: Wearer) -> list[Finding]:
    """A body with holes, which has no inside there."""
    count = int(sides(wearer.body.faces).border.sum())
    if not count:
        return []
    what = f"'{wearer.body.name}' is not closed ({counted(count, 'border edge')}): inside is not defined at its holes"
    return [Finding(Problem("body", what, "fill the holes of the body's mesh", warning=True))]


def penetration(mesh: Mesh, wearer: Wearer) -> list[Finding]:
    """How many of a garment's vertices [m] are inside the body, how deep, and where."""
    used, depth = np.unique(mesh.faces), depths(mesh.vertices, wearer)
    inside = used[depth[used] > 0]
    inside = inside[np.argsort(-depth[inside], kind="stable")]
    if not len(inside):
        return []
    percent, deepest = 100 * len(inside) / len(used), depth[inside[0]]
    places = [(mesh.numbers[i], *mesh.vertices[i]) for i in inside[:_WORST]]
    worst = ", ".join(f"vertex {number} at ({x:.3f}, {y:.3f}, {z:.3f})" for number, x, y, z in places)
    what = (
        f"{counted(len(inside), 'vertex', 'vertices')} ({percent:.1f} %) inside '{wearer.body.name}', "
        f"{1e3 * deepest:.1f} mm deep{_parts(mesh.vertices[inside], wearer)}, worst {worst}"
    )
    shallow = bool(deepest < DEEP)
    too_deep = f"deeper than {1e3 * DEEP:g} mm: fit the garment to this body; --fix leaves it"
    do = "push them out (--fix does)" if shallow else too_deep
    return [Finding(Problem("body", what, do, warning=shallow and percent <= INSIDE_PERCENT), vertices=inside)]


def _parts(points: np.ndarray, wearer: Wearer) -> str:
    """Names of the body parts nearest to points inside, those with most points first."""
    if wearer.parts is None:
        return ""
    _, nearest = nearest_vertices(points, wearer.body.rest)
    names, counts = np.unique(wearer.parts[nearest], return_counts=True)
    order = np.argsort(-counts, kind="stable")
    return ", near " + ", ".join(f"{names[k]} ({counts[k]})" for k in order)
