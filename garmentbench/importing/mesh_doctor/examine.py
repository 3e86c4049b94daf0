"""All checks of a garment, in one go."""

import numpy as np

from garmentbench.importing.mesh_doctor import body, coincident, connections, shape, substeps, unworn, uv
from garmentbench.importing.mesh_doctor.body import Wearer
from garmentbench.importing.mesh_doctor.finding import Finding
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.topology import borders, components
from garmentbench.importing.text import counted


def examine(mesh: Mesh, wearer: Wearer | None = None) -> list[Finding]:
    """Everything that is wrong with a garment, errors and warnings; an empty list for a good one.

    What is said of lengths is in metres: where the mesh is plainly in cm or mm, as if it had been converted.
    `wearer` is the body that it is worn by, where there is one.
    """
    broken = shape.not_finite(mesh)
    if broken:
        return broken
    found, known = shape.scale(mesh), shape.unit(mesh.size)
    metric = mesh.scaled(known[1] if known else 1.0)
    beside = unworn.not_worn(metric, wearer, known[0]) if known and wearer is not None else []
    in_metres = wearer if known and not beside else None
    if known is None and wearer is not None:
        found = unworn.unit_worn(mesh, wearer) or found
    found += beside or shape.up_axis(metric)
    found += shape.degenerate(metric) + connections.unused(metric)
    found += connections.repeated_faces(metric)
    metric = connections.without_doubles(metric)
    found += connections.non_manifold(metric) + connections.flipped(
        metric, None if in_metres is None else in_metres.body
    )
    found += connections.pieces(metric) + connections.holes(metric) + coincident.coincident_findings(metric)
    found += substeps.costly(metric, substeps.cost(metric) if known else None)
    bare = uv.missing(metric)
    found += bare or uv.outside(metric) + uv.folds(metric) + uv.overlapping(metric)
    if in_metres is not None:
        found += body.open_body(in_metres) + body.penetration(metric, in_metres)
    return found


def examine_template(mesh: Mesh, worn_first: Mesh, wearer: Wearer | None) -> list[Finding]:
    """What is wrong with a sequence's garment besides what `sequence_checks` finds.

    Args:
        mesh: The garment at rest.
        worn_first: The garment as it is in frame 0.
        wearer: Its body in that frame, if it is worn there; it tells which side is outside.
    """
    found = connections.repeated_faces(mesh)
    mesh, worn_first = connections.without_doubles(mesh), connections.without_doubles(worn_first)
    found += connections.flipped(worn_first, None if wearer is None else wearer.body) + connections.pieces(mesh)
    found += connections.holes(mesh) + coincident.coincident_findings(mesh) + substeps.costly(mesh, substeps.cost(mesh))
    return found + (uv.missing(mesh) or uv.folds(mesh) + uv.overlapping(mesh))


def summary(mesh: Mesh) -> str:
    """What the garment is, in one line: counts, size, openings, charts, substeps."""
    if shape.not_finite(mesh):
        return f"{counted(len(mesh.vertices), 'vertex', 'vertices')}, {counted(len(mesh.faces), 'face')}"
    _, loop = borders(mesh.sides, len(mesh.vertex))
    whole = components(len(mesh.vertex), mesh.sides.edges)[mesh.corners[:, 0]]
    low, high = mesh.vertices[mesh.faces].min(axis=(0, 1)), mesh.vertices[mesh.faces].max(axis=(0, 1))
    parts = [
        counted(len(mesh.vertices), "vertex", "vertices"),
        counted(len(mesh.faces), "face"),
        counted(len(np.unique(whole)), "piece"),
        counted(int(loop.max(initial=-1)) + 1, "opening"),
        " x ".join(f"{x:.3g}" for x in high - low),
    ]
    if not uv.missing(mesh):
        parts.append(counted(len(np.unique(uv.charts(mesh))), "UV chart"))
    found = substeps.cost(mesh) if shape.unit(mesh.size) == ("m", 1.0) else None
    if found is not None:
        parts.append(f"{found.substeps} substeps a frame with the default material")
    return ", ".join(parts)
