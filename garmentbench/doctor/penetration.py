"""Where a garment starts inside the body."""

import numpy as np

from garmentbench.array_checks import INSIDE_PERCENT
from garmentbench.doctor.finding import Finding, counted
from garmentbench.doctor.mesh import Mesh
from garmentbench.doctor.wearer import Wearer
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.problem import Problem

DEEP = 0.02  # [m] deeper than this nothing is pushed: the garment is worn wrongly, or by another body
_WORST = 3  # places named by their coordinates


def depths(points: np.ndarray, wearer: Wearer) -> np.ndarray:
    """How deep points [m], shape (P, 3), lie inside the body [m], shape (P,), negative outside."""
    from garmentbench.metrics.interpenetration_strict import signed_distances

    points, rest = points[None].astype(np.float32), wearer.body.rest[None].astype(np.float32)
    return -signed_distances(points, rest, wearer.body.faces.astype(np.int32))[0].astype(np.float64)


def penetration(mesh: Mesh, wearer: Wearer) -> list[Finding]:
    """How many of a garment's vertices [m] are inside the body, how deep, and where."""
    used, depth = np.unique(mesh.faces), depths(mesh.vertices, wearer)
    inside = used[depth[used] > 0]
    inside = inside[np.argsort(-depth[inside], kind="stable")]
    if not len(inside):
        return []
    percent, deepest = 100 * len(inside) / len(used), depth[inside[0]]
    worst = ", ".join(f"vertex {mesh.numbers[i]} at ({', '.join(f'{x:.3f}' for x in mesh.vertices[i])})" for i in inside[:_WORST])
    what = (f"{counted(len(inside), 'vertex', 'vertices')} ({percent:.1f} %) inside '{wearer.body.name}', {1e3 * deepest:.1f} mm deep"
            f"{_parts(mesh.vertices[inside], wearer)}, worst {worst}")
    shallow = bool(deepest < DEEP)
    do = "push them out (--fix does)" if shallow else f"deeper than {1e3 * DEEP:g} mm: fit the garment to this body; --fix leaves it"
    return [Finding(Problem("body", what, do, warning=shallow and percent <= INSIDE_PERCENT), vertices=inside)]


def _parts(points: np.ndarray, wearer: Wearer) -> str:
    """Names of the body parts nearest to points inside, those with most points first."""
    if wearer.parts is None:
        return ""
    _, nearest = nearest_vertices(points, wearer.body.rest)
    names, counts = np.unique(wearer.parts[nearest], return_counts=True)
    order = np.argsort(-counts, kind="stable")
    return ", near " + ", ".join(f"{names[k]} ({counts[k]})" for k in order)
