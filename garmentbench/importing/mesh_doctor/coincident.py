"""Points that lie on each other without being one: cracks, UV seams that nothing sews, and mere touching."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from garmentbench.errors import Problem
from garmentbench.importing.mesh_doctor.finding import Finding, listed
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.topology import components
from garmentbench.importing.text import counted
from garmentbench.sequence_file.array_checks import SEAM_GAP

TOLERANCE = 1e-5  # of the mesh's diagonal, within which points coincide: 0.01 mm on a T-shirt
SAME_UV = 1e-6  # of the UV map's extent
_NEIGHBOURS = 12


@dataclass(frozen=True)
class Gaps:
    """Border edges that coincide two by two, so that the cloth is open where it looks closed.

    Attributes:
        cracks: Vertex pairs of edges whose sides have the same UV (or none), shape (C, 2): one side of each gap.
        uv_seams: The same where their UV differ, shape (U, 2).
        joins: Vertex pairs to be joined to close them all, shape (N, 2).
        touching: Other vertices that lie on another point, shape (T,).
    """

    cracks: np.ndarray
    uv_seams: np.ndarray
    joins: np.ndarray
    touching: np.ndarray


def coincident(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Place of each point, shape (P,): points within `tolerance` of each other, by way of others too, share one."""
    _, exact = np.unique(points, axis=0, return_inverse=True)  # first: a pile of thousands would be all pairs of them
    exact = exact.ravel()
    first = np.unique(exact, return_index=True)[1]
    distance, near = KDTree(points[first]).query(points[first], _NEIGHBOURS, distance_upper_bound=tolerance)
    pairs = np.stack([np.repeat(np.arange(len(first)), _NEIGHBOURS), near.ravel()], axis=1)
    return components(len(first), pairs[np.isfinite(distance).ravel()])[exact]


def gaps(mesh: Mesh, tolerance: float | None = None) -> Gaps:
    """Where the cloth is open and should not be. `tolerance` is in the mesh's unit; None: `TOLERANCE` of its size."""
    place = coincident(mesh.points, TOLERANCE * mesh.size if tolerance is None else tolerance)
    first, second = _matching_sides(mesh, place)
    a, b, c, d = (mesh.faces.ravel()[side] for side in (first, _after(first), second, _after(second)))
    swapped = place[mesh.point[a]] != place[mesh.point[c]]
    c, d = np.where(swapped, d, c), np.where(swapped, c, d)
    same = same_flat(mesh, a, c) & same_flat(mesh, b, d)
    joins = np.concatenate([np.stack([a, c], axis=1), np.stack([b, d], axis=1)])
    joins = np.unique(joins[mesh.point[joins[:, 0]] != mesh.point[joins[:, 1]]], axis=0)
    closed = components(len(mesh.vertex), mesh.point[joins])
    edges = np.stack([a, b], axis=1)
    return Gaps(edges[same], edges[~same], joins, mesh.vertex[_still_doubled(mesh, place, closed)])


def _matching_sides(mesh: Mesh, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of border sides (3 * face + k) that lie on each other, exactly two at a place, shape (N,) each."""
    border, corner = np.flatnonzero(mesh.sides.border), mesh.corners.ravel()
    ends = np.sort(np.stack([place[corner[border]], place[corner[_after(border)]]], axis=1), axis=1)
    border, ends = border[ends[:, 0] != ends[:, 1]], ends[ends[:, 0] != ends[:, 1]]
    _, index, count = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    order = border[np.argsort(index.ravel(), kind="stable")]
    start = (np.cumsum(count) - count)[count == 2]
    return order[start], order[start + 1]


def _after(side: np.ndarray) -> np.ndarray:
    """The side after each in its face."""
    return np.where(side % 3 == 2, side - 2, side + 1)


def same_flat(mesh: Mesh, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Do vertices a and b, shape (N,), have the same UV, or none, and the same place in the pattern? Shape (N,)."""
    same = np.ones(len(a), bool)
    for flat in (mesh.uv, mesh.cut):
        if flat is not None:
            known = flat[np.isfinite(flat)]
            extent = known.max(initial=0.0) - known.min(initial=0.0)
            same &= ~(np.abs(flat[a] - flat[b]).max(axis=1) > SAME_UV * extent)
    return same


def _still_doubled(mesh: Mesh, place: np.ndarray, closed: np.ndarray) -> np.ndarray:
    """Points that share a place with a point which neither joins nor an edge without length make one with them."""
    edges = mesh.sides.edges
    collapsed = edges[place[edges[:, 0]] == place[edges[:, 1]]]
    pairs = np.concatenate(
        [collapsed, np.stack([np.arange(len(place)), np.unique(closed, return_index=True)[1][closed]], 1)]
    )
    known = components(len(place), pairs)
    used = np.zeros(len(place), bool)
    used[mesh.corners] = True
    firsts = np.unique(np.stack([place[used], known[used]], axis=1), axis=0)[:, 0]
    return np.flatnonzero(used & np.isin(place, np.flatnonzero(np.bincount(firsts) > 1)))


def coincident_findings(mesh: Mesh) -> list[Finding]:
    """Cracks, unsewn UV seams, vertices that lie on each other."""
    open_, found = gaps(mesh), []
    if len(open_.cracks):
        at = _edges(mesh, open_.cracks)
        what = f"{counted(len(open_.cracks), 'edge')} where borders coincide and are not joined (cracks), at {at}"
        found.append(
            Finding(Problem("cracks", what, "weld them (--fix does), or the cloth falls open"), edges=open_.cracks)
        )
    if len(open_.uv_seams):
        missing = (
            "that the file's seams leave out" if mesh.says_seams else "whose two sides are joined by position only"
        )
        what = f"{counted(len(open_.uv_seams), 'edge')} of UV seams {missing}, at {_edges(mesh, open_.uv_seams)}"
        problem = Problem("seams", what, "sew them (--fix does)", warning=not mesh.says_seams)
        found.append(Finding(problem, edges=open_.uv_seams))
    if len(open_.touching):
        what = (
            f"{counted(len(open_.touching), 'vertex', 'vertices')} on top of another, along no common border, "
            f"at vertex {listed(mesh.numbers[open_.touching])}"
        )
        do = "move layers apart, or join them along whole edges; --fix leaves them"
        found.append(Finding(Problem("vertices", what, do, warning=True), vertices=open_.touching))
    return found + _apart(mesh)


def _apart(mesh: Mesh) -> list[Finding]:
    """Seam pairs that are not in one place."""
    a, b = mesh.seams.T
    gap = np.linalg.norm(mesh.vertices[a] - mesh.vertices[b], axis=1)
    apart = np.flatnonzero(gap > SEAM_GAP)
    if not len(apart):
        return []
    pairs = mesh.seams[apart]
    what = (
        f"{counted(len(apart), 'seam pair')} apart at rest, by up to {1e3 * gap.max():.3g} mm, at {_edges(mesh, pairs)}"
    )
    return [
        Finding(Problem("seams", what, "bring both to one place, or leave the pair out", warning=True), edges=pairs)
    ]


def _edges(mesh: Mesh, edges: np.ndarray) -> str:
    return listed(mesh.numbers[edges])
