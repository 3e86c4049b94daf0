"""What a garment's mesh costs in a simulation: the substeps that it asks for, and the place that asks for most."""

from dataclasses import dataclass, replace

import numpy as np

from garmentbench.errors import Problem
from garmentbench.importing.mesh_doctor.finding import Finding, listed
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.shape import POINT, SHORT, without_area
from garmentbench.importing.text import counted
from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import Garment
from garmentbench.simulation.assembly import assemble
from garmentbench.simulation.time_step import substeps

FPS = 30.0
UNEVEN = 1.85  # times the substeps of an even mesh; the simulator softens what would ask for much more


@dataclass(frozen=True)
class Cost:
    """What one frame costs with the default material.

    Attributes:
        substeps: Substeps a frame at 30 frames a second.
        even: About as many as it would be if all of the mesh were like its median particle.
        vertex: A vertex at the stiffest place.
    """

    substeps: int
    even: int
    vertex: int


def cost(mesh: Mesh) -> Cost | None:
    """What a garment [m] costs; faces without area and what no face uses are left out. None where nothing is left."""
    together = replace(mesh, vertices=mesh.points[mesh.point], numbers=np.arange(len(mesh.vertices)))  # seams closed
    solid = replace(together, faces=mesh.faces[~without_area(together)]).compact()
    if not len(solid.faces):
        return None
    uv = np.zeros((len(solid.vertices), 2), np.float32)
    material, settings = Material(), Settings()
    fabric = assemble(Garment(mesh.name, solid.vertices, solid.faces, uv, solid.seams, solid.pins), material, settings)
    count = substeps(fabric, material, settings, 1 / FPS)
    spring = np.bincount(fabric.edges.ravel(), np.repeat(fabric.stiffness, 2), len(fabric.mass))
    bending = np.asarray(abs(fabric.bending_of(fabric.bend_stiffness)).sum(axis=1)).ravel()
    step = _bounds(2 * spring / fabric.mass, bending / fabric.mass, material)
    stiffest = np.argmin(step)
    even = max(round(count * float(step[stiffest] / np.median(step))), settings.queries)
    return Cost(count, even, int(solid.numbers[np.flatnonzero(fabric.particle == stiffest)[0]]))


def _bounds(stretch: np.ndarray, bending: np.ndarray, material: Material) -> np.ndarray:
    """Stable time step [s] of each particle alone, by `simulation.time_step`'s formula, of squared frequencies
    [1/s^2]."""
    square = stretch + bending
    damping = material.stretch_damping * stretch
    return (np.sqrt(damping**2 + 4 * square) - damping) / square


def costly(mesh: Mesh, found: Cost | None) -> list[Finding]:
    """Edges so short that they set the time step, or are softened lest they do; a few places that cost all others.

    Args:
        mesh: The garment.
        found: What it costs, where its unit is known.
    """
    findings = _short_edges(mesh)
    if found is not None and found.substeps > UNEVEN * found.even:
        at = ", ".join(f"{x:.3f}" for x in mesh.vertices[found.vertex])
        what = (
            f"a frame takes {found.substeps} substeps with the default material, for the sake of vertex "
            f"{mesh.numbers[found.vertex]} at ({at}) and its like; about {found.even} if all were like the median "
            "vertex"
        )
        do = "even out the triangles there; --fix leaves them"
        findings.append(Finding(Problem("substeps", what, do, warning=True), vertices=np.array([found.vertex])))
    return findings


def _short_edges(mesh: Mesh) -> list[Finding]:
    a, b = mesh.sides.edges.T
    length = np.linalg.norm(mesh.points[a] - mesh.points[b], axis=1)
    length, edges = length[length > POINT * mesh.size], mesh.sides.edges[length > POINT * mesh.size]
    median = np.median(length) if len(length) else 0.0
    short = np.flatnonzero(length < SHORT * median)
    if not len(short):
        return []
    short = short[np.argsort(length[short], kind="stable")]
    at = mesh.vertex[edges[short]]
    what = (
        f"{counted(len(short), 'edge')} shorter than a tenth of the median, the shortest {1e3 * length[short[0]]:.2g} "
        f"mm of {1e3 * median:.3g} mm, at {listed(mesh.numbers[at])}"
    )
    do = "remesh there: the simulator softens what would set its time step; --fix leaves them"
    return [Finding(Problem("edges", what, do, warning=True), edges=at)]
