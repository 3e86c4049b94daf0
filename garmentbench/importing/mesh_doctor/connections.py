"""How a garment hangs together: edges, winding, pieces, holes, vertices that nothing uses."""

from dataclasses import replace

import numpy as np

from garmentbench.errors import Problem
from garmentbench.importing.mesh_doctor.finding import Finding, listed
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.orientation import inward_patches
from garmentbench.importing.mesh_doctor.topology import (
    borders,
    components,
    doubles,
    repeats_a_corner,
    torn_points,
    winding,
)
from garmentbench.importing.text import counted
from garmentbench.sequence import Body

SMALL_HOLE = 0.1  # way round a hole over the diagonal of its piece of cloth, below which it is no opening for a limb
SMALL_PIECE = 0.01  # of the faces; a piece below that is called a scrap


def non_manifold(mesh: Mesh) -> list[Finding]:
    """Edges of more than two faces; points where faces meet that share no edge there."""
    found = []
    edges = mesh.vertex[mesh.sides.edges[mesh.sides.count > 2]]
    if len(edges):
        what = (
            f"{counted(len(edges), 'edge')} with more than two faces (not manifold), at {listed(mesh.numbers[edges])}"
        )
        do = "take the sheets of cloth apart there; which one to part is for you to say, --fix leaves it"
        found.append(Finding(Problem("edges", what, do), edges=edges))
    torn = mesh.vertex[torn_points(mesh.corners, mesh.sides, len(mesh.vertex))]
    if len(torn):
        at = listed(mesh.numbers[torn])
        what = f"{counted(len(torn), 'point')} where pieces touch and share no edge, at vertex {at}"
        do = "split the vertex, or join the pieces along an edge; --fix leaves it"
        found.append(Finding(Problem("edges", what, do, warning=True), vertices=torn))
    return found


def repeated_faces(mesh: Mesh) -> list[Finding]:
    """Faces that lie on another with the same corners."""
    again = doubles(mesh.corners)
    again = again[~repeats_a_corner(mesh.corners[again])]
    if not len(again):
        return []
    what = f"{counted(len(again), 'face')} with the same corners as another, at face {listed(again)}"
    return [Finding(Problem("faces", what, "delete them (--fix does)"), faces=again)]


def without_doubles(mesh: Mesh) -> Mesh:
    """The same mesh, faces that lie on another shrunk to their first corner, so that no later check meets them
    again."""
    again = doubles(mesh.corners)
    faces = mesh.faces.copy()
    faces[again] = faces[again, :1]
    return replace(mesh, faces=faces) if len(again) else mesh


def flipped(mesh: Mesh, body: Body | None) -> list[Finding]:
    """Neighbours that run opposite ways; one-sided surfaces; pieces inside out."""
    found, way = [], winding(mesh.sides)
    wrong = np.flatnonzero(way.turned)
    if len(wrong):
        what = f"{counted(len(wrong), 'flipped face')} (run against their neighbours), at face {listed(wrong)}"
        found.append(Finding(Problem("winding", what, "turn them over (--fix does)"), faces=wrong))
    if len(way.one_sided):
        faces = np.flatnonzero(np.isin(way.patch, way.one_sided))
        what = f"{counted(len(way.one_sided), 'piece')} with only one side (a Moebius strip), at face {listed(faces)}"
        do = "cut the piece and sew it without the twist; --fix leaves it"
        found.append(Finding(Problem("winding", what, do), faces=faces))
    inward = np.flatnonzero(np.isin(way.patch, inward_patches(mesh, way, body)))
    if len(inward):
        patches = len(np.unique(way.patch[inward]))
        whole = (
            "the whole garment"
            if len(inward) == len(mesh.faces)
            else f"{counted(patches, 'patch', 'patches')} of the garment"
        )
        towards = "the inside of the volume that it encloses" if body is None else f"'{body.name}'"
        what = (
            f"{whole} ({counted(len(inward), 'face')}) inside out: its normals point towards {towards}, "
            f"at face {listed(inward)}"
        )
        problem = Problem("winding", what, "turn all of its faces over (--fix does)", warning=True)
        found.append(Finding(problem, faces=inward))
    return found


def pieces(mesh: Mesh) -> list[Finding]:
    """More than one piece of cloth."""
    label = components(len(mesh.vertex), mesh.sides.edges)[mesh.corners[:, 0]]
    names, sizes = np.unique(label, return_counts=True)
    if len(names) < 2:
        return []
    order = np.argsort(-sizes, kind="stable")
    first = [int(np.flatnonzero(label == names[k])[0]) for k in order[:6]]
    scraps = np.flatnonzero(np.isin(label, names[sizes < SMALL_PIECE * len(label)]))
    what = f"{len(names)} pieces that nothing joins, of {listed(sizes[order])} faces, the first faces {listed(first)}"
    do = "delete what is no cloth (buttons, scraps), sew what belongs together, or simulate layers one by one"
    return [Finding(Problem("pieces", what, do, warning=True), faces=scraps)]


def unused(mesh: Mesh) -> list[Finding]:
    """Vertices without a face: in a simulation they fall for ever."""
    alone = np.setdiff1d(np.arange(len(mesh.vertices)), mesh.faces)
    if not len(alone):
        return []
    what = f"{counted(len(alone), 'vertex', 'vertices')} without a face, at vertex {listed(mesh.numbers[alone])}"
    return [Finding(Problem("vertices", what, "delete them (--fix does)"), vertices=alone)]


def holes(mesh: Mesh) -> list[Finding]:
    """Openings so small that nobody puts a limb through, and cloth without any opening."""
    edges, loop = borders(mesh.sides, len(mesh.vertex))
    if not len(edges):
        what = "no opening at all: a closed surface, as cloth with a thickness has"
        do = "keep one sheet of it, the simulator gives it its thickness"
        return [Finding(Problem("openings", what, do, warning=True))]
    a, b = mesh.points[edges].transpose(1, 0, 2)
    around = np.bincount(loop, np.linalg.norm(a - b, axis=1))
    first = np.unique(loop, return_index=True)[1]
    ends = np.bincount(edges.ravel(), minlength=len(mesh.vertex))[edges] != 2
    closed = np.bincount(loop, ends.any(axis=1)) == 0  # the border of a fin runs into the cloth
    small = np.flatnonzero(closed & (around < SMALL_HOLE * _piece_sizes(mesh)[edges[first, 0]]))
    if not len(small):
        return []
    at = listed(mesh.numbers[mesh.vertex[edges[first[small], 0]]])
    what = (
        f"{counted(len(small), 'hole')} of less than a tenth of the cloth's size around "
        f"({counted(len(around), 'opening')} in all), at vertex {at}"
    )
    problem = Problem("openings", what, "fill them unless they are meant; --fix leaves them", warning=True)
    return [Finding(problem, edges=mesh.vertex[edges[np.isin(loop, small)]])]


def _piece_sizes(mesh: Mesh) -> np.ndarray:
    """Diagonal of the piece that each point belongs to, shape (P,)."""
    piece = components(len(mesh.vertex), mesh.sides.edges)
    low, high = np.full((piece.max() + 1, 3), np.inf), np.full((piece.max() + 1, 3), -np.inf)
    np.minimum.at(low, piece, mesh.points)
    np.maximum.at(high, piece, mesh.points)
    return np.linalg.norm(high - low, axis=1)[piece]
