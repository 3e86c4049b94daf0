"""Pushing a garment's vertices out of the body, their neighbours along with them."""

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from garmentbench.geometry.mesh import vertex_normals
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.importing.mesh_doctor.finding import counted
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.penetration import DEEP, depths
from garmentbench.importing.mesh_doctor.wearer import Wearer

MARGIN = 1e-3  # [m] outside the skin
_CLEAR = 1e-5  # [m] nearer than this to the skin may be inside once written with 6 decimals
_ROUNDS = 20
_SPREADS = 3


def push_out(mesh: Mesh, wearer: Wearer) -> tuple[Mesh, list[str]]:
    """Push what is inside the body out, along the skin's normals; all of it or nothing.

    Args:
        mesh: In metres.
        wearer: The body.

    Returns:
        The mesh, and a line on what was done or why it was not. Nothing deeper than `DEEP` is pushed.
    """
    depth = depths(mesh.points, wearer)
    inside = int((depth > 0).sum())
    if not inside:
        return mesh, []
    what = f"{counted(inside, 'point')} inside '{wearer.body.name}'"
    if depth.max() >= DEEP:
        return mesh, [f"left {what}: {1e3 * depth.max():.0f} mm deep, only less than {1e3 * DEEP:g} mm is pushed"]
    normals = vertex_normals(wearer.body.rest.astype(np.float64), wearer.body.faces)
    mean, points = _mean(mesh), mesh.points
    for _ in range(_ROUNDS):
        points = points + _spread(_push(points, depth, normals, wearer), mean)
        depth = depths(points, wearer)
        if depth.max() <= -_CLEAR:
            moved = np.linalg.norm(points - mesh.points, axis=1).max()
            return replace(mesh, vertices=points[mesh.point]), [f"pushed {what} out, by at most {1e3 * moved:.1f} mm"]
    return mesh, [f"left {what}: pushing did not free it (pinched between limbs?)"]


def _push(points: np.ndarray, depth: np.ndarray, normals: np.ndarray, wearer: Wearer) -> np.ndarray:
    """For points at or inside the skin the way out [m], for others 0, shape (P, 3)."""
    push = np.zeros_like(points)
    at = np.flatnonzero(depth > -_CLEAR)
    _, nearest = nearest_vertices(points[at], wearer.body.rest)
    push[at] = normals[nearest] * (depth[at] + MARGIN)[:, None]
    return push


def _spread(push: np.ndarray, mean: sp.csr_matrix) -> np.ndarray:
    """Points that are not pushed go half the mean way of their neighbours, and so on outwards."""
    pushed = (push != 0).any(axis=1)
    field = push
    for _ in range(_SPREADS):
        field = np.where(pushed[:, None], push, 0.5 * (mean @ field))
    return field


def _mean(mesh: Mesh) -> sp.csr_matrix:
    """The matrix that takes values of points to the means over their neighbours, shape (P, P)."""
    a, b = mesh.sides.edges.T
    adjacency = sp.coo_matrix((np.ones(2 * len(a)), (np.r_[a, b], np.r_[b, a])), shape=(len(mesh.vertex),) * 2).tocsr()
    degree = np.asarray(adjacency.sum(axis=1)).ravel()
    return sp.diags(1 / np.maximum(degree, 1)) @ adjacency
