"""The body that a garment is checked against: where the garment is inside it, and how it is pushed out."""

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from garmentbench.errors import Problem
from garmentbench.geometry.mesh import vertex_normals
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.importing.mesh_doctor.finding import Finding
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.topology import sides
from garmentbench.importing.text import counted
from garmentbench.scenes.bodies import body_names, load_body
from garmentbench.sequence import Body
from garmentbench.sequence_file.array_checks import INSIDE_PERCENT


@dataclass(frozen=True)
class Wearer:
    """A body, and what each of its vertices is called.

    Attributes:
        body: Its rest positions [m] and faces are used.
        parts: Name of the part of each vertex, e.g. "upper_arm.L", shape (B,); None where there are none.
        assumed: What was taken for its unit and axes, for the user.
    """

    body: Body
    parts: np.ndarray | None
    assumed: tuple[str, ...] = ()


def baked(name: str) -> Wearer:
    """A baked body at full size; a vertex is called after the bone that moves it most. Raises as `load_body`."""
    found = load_body(name, "full")
    return Wearer(found.body, np.array(found.joint_names)[found.weights.argmax(axis=1)])


def of_body(body: Body) -> Wearer:
    """A sequence's body."""
    return Wearer(body, None if body.labels is None else np.array(body.part_names)[body.labels])


def is_baked(name: str) -> bool:
    """Is that the name of a baked body?"""
    return name in body_names()


DEEP = 0.02  # [m] deeper than this nothing is pushed: the garment is worn wrongly, or by another body
_WORST = 3  # places named by their coordinates


def depths(points: np.ndarray, wearer: Wearer) -> np.ndarray:
    """How deep points [m], shape (P, 3), lie inside the body [m], shape (P,), negative outside."""
    from garmentbench.geometry.signed_distance import signed_distances

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
