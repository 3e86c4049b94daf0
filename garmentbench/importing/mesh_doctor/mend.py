"""Repairing what is safe to repair, in the order in which one repair helps the next."""

from dataclasses import replace

import numpy as np

from garmentbench.errors import UserError
from garmentbench.geometry.unwrap import unwrap
from garmentbench.importing.mesh_doctor import flat, repairs, shape
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.push_out import push_out
from garmentbench.importing.mesh_doctor.wearer import Wearer

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}


def mend(
    mesh: Mesh,
    wearer: Wearer | None = None,
    units: str | None = None,
    make_uv: bool = False,
    tolerance: float | None = None,
) -> tuple[Mesh, list[str]]:
    """Repair a garment. What is mended stays as it is when mended again.

    Args:
        mesh: The garment.
        wearer: The body that it is pushed out of and turned away from, if any.
        units: The mesh's unit, a key of `UNITS`; None: scaled only where it can be told.
        make_uv: Make a new UV map by xatlas where there is none or it overlaps or folds.
        tolerance: Borders this near are welded [m]; None: `coincident.TOLERANCE` of the garment's size.

    Returns:
        The mended mesh, and a line on each thing done.

    Raises `UserError` where positions are not finite, or nothing is left of the mesh.
    """
    broken = shape.not_finite(mesh)
    if broken:
        raise UserError(f"{mesh.name}: {broken[0].problem}")
    mesh, lines = _to_metres(mesh, units)
    for repair in (repairs.drop_unused, repairs.merge_points, repairs.drop_doubles, repairs.drop_flat):
        mesh, said = repair(mesh)
        lines += said
        if not len(mesh.faces):
            raise UserError(
                f"{mesh.name}: all faces are without area, nothing is left to repair; export the mesh again"
            )
    mesh, said = repairs.weld_gaps(mesh, tolerance)
    lines += said
    mesh, said = repairs.drop_doubles(mesh)
    lines += said
    metric = shape.unit(mesh.size) == ("m", 1.0)
    mesh, said = repairs.turn_faces(mesh, wearer if metric else None)
    lines += said
    mesh = mesh.compact()
    if wearer is not None and metric:
        mesh, said = push_out(mesh, wearer)
        lines += said
    mesh, said = _new_uv(mesh) if make_uv else repairs.fit_uv(mesh)
    return mesh, lines + said


def _to_metres(mesh: Mesh, units: str | None) -> tuple[Mesh, list[str]]:
    known = (units, UNITS[units]) if units else shape.unit(mesh.size)
    if known is None or known[1] == 1.0:
        return mesh, []
    why = "as --units says" if units else f"it measured {mesh.size:.4g} across"
    return mesh.scaled(known[1]), [f"scaled from {known[0]} to m, by {known[1]:g} ({why})"]


def _new_uv(mesh: Mesh) -> tuple[Mesh, list[str]]:
    """A UV map by xatlas where the present one is missing or bad beyond scaling."""
    if not flat.missing(mesh):
        mesh, said = repairs.fit_uv(mesh)
        if not flat.folds(mesh) and not flat.overlapping(mesh):
            return mesh, said
    made = unwrap(mesh.points, mesh.corners)
    pinned = np.isin(made.source, mesh.point[mesh.pins])
    new = replace(
        mesh,
        vertices=mesh.points[made.source],
        faces=made.faces.astype(np.int64),
        uv=made.uv.astype(np.float64),
        numbers=mesh.numbers[mesh.vertex][made.source],
        seams=made.seams.astype(np.int64),
        pins=np.flatnonzero(pinned),
    )
    charts = len(np.unique(flat.charts(new)))
    return new, [f"made a UV map by xatlas: {charts} charts, {len(made.seams)} vertices split along its cuts"]
