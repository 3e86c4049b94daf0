"""Repairing what is safe to repair, in the order in which one repair helps the next."""

from dataclasses import replace

import numpy as np

from garmentbench.errors import UserError
from garmentbench.geometry.unwrap import unwrap
from garmentbench.importing.mesh_doctor import shape, uv
from garmentbench.importing.mesh_doctor.body import Wearer, push_out
from garmentbench.importing.mesh_doctor.coincident import gaps, same_flat
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.orientation import inward_patches
from garmentbench.importing.mesh_doctor.shape import FLAT, POINT, heights
from garmentbench.importing.mesh_doctor.topology import components, doubles, repeats_a_corner, sides, winding
from garmentbench.importing.mesh_doctor.worn import is_worn
from garmentbench.importing.meshes.conventions import UNITS, converter
from garmentbench.importing.text import counted

_NO_CUT, _AT_REST = "left out the flat pattern (cut)", "the cloth is at rest as it is put on"


def mend(
    mesh: Mesh,
    wearer: Wearer | None = None,
    units: str | None = None,
    up: str = "z",
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0),
    make_uv: bool = False,
    tolerance: float | None = None,
) -> tuple[Mesh, list[str]]:
    """Repair a garment. What is mended stays as it is when mended again.

    Args:
        mesh: The garment.
        wearer: The body that it is pushed out of and turned away from, if any.
        units: The mesh's unit, a key of `UNITS`; None: scaled only where its size tells.
        up: The axis of the file that points up, a key of `AXES`; it is turned to z.
        shift: By which it is moved then [m].
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
    if mesh.cut is not None and not np.isfinite(mesh.cut).all():
        mesh = replace(mesh, cut=None)
        lines.append(f"{_NO_CUT}, which is not finite: {_AT_REST}")
    if up != "z" or any(shift):
        mesh = replace(mesh, vertices=mesh.vertices @ converter(1.0, up).T + np.array(shift))
        moved = f"moved by ({', '.join(f'{x:g}' for x in shift)}) m" if any(shift) else ""
        lines.append(" and ".join(filter(None, (f"turned from {up} up to z up" if up != "z" else "", moved))))
    for repair in (drop_unused, merge_points, drop_doubles, drop_flat):
        mesh, notes = repair(mesh)
        lines += notes
        if not len(mesh.faces):
            raise UserError(
                f"{mesh.name}: all faces are without area, nothing is left to repair; export the mesh again"
            )
    mesh, notes = weld_gaps(mesh, tolerance)
    lines += notes
    mesh, notes = drop_doubles(mesh)
    lines += notes
    metric = shape.unit(mesh.size) == ("m", 1.0)
    if wearer is not None and metric and not is_worn(mesh, wearer):
        lines.append(f"left as it lies: '{wearer.body.name}' is not in it, so that nothing is pushed")
        wearer = None
    mesh, notes = turn_faces(mesh, wearer if metric else None)
    lines += notes
    mesh = mesh.compact()
    if wearer is not None and metric:
        mesh, notes = push_out(mesh, wearer)
        lines += notes
    mesh, notes = _new_uv(mesh) if make_uv else fit_uv(mesh)
    return mesh, lines + notes


def _to_metres(mesh: Mesh, units: str | None) -> tuple[Mesh, list[str]]:
    known = (units, UNITS[units]) if units else shape.unit(mesh.size)
    if known is None or known[1] == 1.0:
        return mesh, []
    why = "as --units says" if units else f"it measured {mesh.size:.4g} across"
    return mesh.scaled(known[1]), [f"scaled from {known[0]} to m, by {known[1]:g} ({why})"]


def _new_uv(mesh: Mesh) -> tuple[Mesh, list[str]]:
    """A UV map by xatlas where the present one is missing or bad beyond scaling."""
    if not uv.missing(mesh):
        mesh, notes = fit_uv(mesh)
        if not uv.folds(mesh) and not uv.overlapping(mesh):
            return mesh, notes
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
        cut=None,
    )
    charts = len(np.unique(uv.charts(new)))
    lines = [
        f"made a UV map by xatlas: {counted(charts, 'chart')}, {counted(len(made.seams), 'vertex', 'vertices')} split"
    ]
    if mesh.cut is not None:
        lines.append(f"{_NO_CUT}, whose panels are parted elsewhere: {_AT_REST}")
    return new, lines


Done = tuple[Mesh, list[str]]
_TRIES = 5


def drop_unused(mesh: Mesh) -> Done:
    """Without the vertices that no face uses."""
    used = np.unique(mesh.faces)
    count = len(mesh.vertices) - len(used)
    return (mesh.compact(), [f"removed {counted(count, 'vertex', 'vertices')} without a face"]) if count else (mesh, [])


def merge_points(mesh: Mesh) -> Done:
    """Both ends of edges without length are one vertex; the faces that vanish with them are removed."""
    a, b = mesh.faces, np.roll(mesh.faces, -1, axis=1)
    near = (np.linalg.norm(mesh.vertices[a] - mesh.vertices[b], axis=2) <= POINT * mesh.size) & (a != b)
    pairs = np.stack([a[near], b[near]], axis=1)
    merged = _merged(mesh, pairs)
    whole = ~repeats_a_corner(merged.corners)
    lost, lines = int((~whole).sum()), []
    if len(pairs):
        lines.append(
            f"merged the ends of {counted(len(np.unique(np.sort(pairs, axis=1), axis=0)), 'edge')} without length"
        )
    if lost:
        lines.append(f"removed {counted(lost, 'face')} that named a point twice")
        merged = replace(merged, faces=merged.faces[whole])
    return (merged, lines) if lines else (mesh, [])


def drop_doubles(mesh: Mesh) -> Done:
    """Keep only the first of faces with the same corners."""
    again = doubles(mesh.corners)
    if not len(again):
        return mesh, []
    once = replace(mesh, faces=np.delete(mesh.faces, again, axis=0))
    return once, [f"removed {counted(len(again), 'face')} that lay on another"]


def drop_flat(mesh: Mesh) -> Done:
    """Without the faces without area whose removal opens no slit: those on a border, by their longest side."""
    before = len(mesh.faces)
    for _ in range(before):
        flat = np.flatnonzero((heights(mesh)[0] <= FLAT) & _on_border(mesh))
        if not len(flat):
            break
        mesh = replace(mesh, faces=np.delete(mesh.faces, flat, axis=0))
    lost = before - len(mesh.faces)
    return mesh, [f"removed {counted(lost, 'face')} without area from the borders"] if lost else []


def _on_border(mesh: Mesh) -> np.ndarray:
    """Faces that can go without a slit.

    Two or three sides on a border, or the longest and the corner opposite inside.
    """
    corners, open_ = mesh.points[mesh.corners], mesh.sides.border
    longest = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).argmax(axis=1)
    rows = np.arange(len(longest))
    on_border = np.zeros(len(mesh.points), bool)
    on_border[mesh.sides.edges[mesh.sides.count == 1]] = True
    inner = ~on_border[mesh.corners[rows, (longest + 2) % 3]]
    return (open_.sum(axis=1) >= 2) | (open_[rows, longest] & inner)


def weld_gaps(mesh: Mesh, tolerance: float | None = None) -> Done:
    """Borders that coincide edge by edge joined: vertices of the same UV become one, others are noted as a seam."""
    found = gaps(mesh, tolerance)
    joins = _without_new_fins(mesh, found.joins)
    if not len(joins):
        return mesh, []
    same = same_flat(mesh, *joins.T)
    sewn = replace(mesh, seams=np.concatenate([mesh.seams, joins[~same]]))
    mended = _merged(sewn, joins[same])
    joined = np.isin(mended.point, mended.point[joins])[:, None]
    mended = replace(mended, vertices=np.where(joined, mended.points[mended.point], mended.vertices))
    return mended, [
        f"joined {counted(len(joins), 'pair')} of vertices along coinciding borders "
        f"({int(same.sum())} welded, {int((~same).sum())} sewn across UV seams)"
    ]


def _without_new_fins(mesh: Mesh, joins: np.ndarray) -> np.ndarray:
    """Those joins that make no edge of more than two faces."""
    for _ in range(_TRIES):
        point = components(len(mesh.vertex), mesh.point[joins])
        met = sides(point[mesh.corners])
        fins = met.edges[met.count > 2]
        was = {tuple(e) for e in np.sort(point[mesh.sides.edges[mesh.sides.count > 2]], axis=1).tolist()}
        new = [e for e in fins.tolist() if tuple(e) not in was]
        if not new:
            return joins
        joins = joins[~np.isin(point[mesh.point[joins[:, 0]]], np.unique(new))]
    return joins[:0]


def turn_faces(mesh: Mesh, wearer: Wearer | None) -> Done:
    """Neighbours wound alike, and outwards."""
    way, lines = winding(mesh.sides), []
    inward = np.isin(way.patch, inward_patches(mesh, way, None if wearer is None else wearer.body))
    if way.turned.any():
        lines.append(f"turned {counted(int(way.turned.sum()), 'face')} that ran against the neighbours")
    if inward.any():
        lines.append(f"turned {counted(int(inward.sum()), 'face')} that faced inwards")
    turn = way.turned != inward
    return (
        (replace(mesh, faces=np.where(turn[:, None], mesh.faces[:, ::-1], mesh.faces)), lines) if lines else (mesh, [])
    )


def fit_uv(mesh: Mesh) -> Done:
    """UV moved by whole tiles and scaled, the same in u and v, into the unit square."""
    if mesh.uv is None or not np.isfinite(mesh.uv[mesh.faces]).all():
        return mesh, []
    used = mesh.uv[mesh.faces].reshape(-1, 2)
    if used.min() >= 0 and used.max() <= 1:
        return mesh, []
    low = np.floor(used.min(axis=0))
    tiles = max(float(np.ceil(used.max(axis=0) - low).max()), 1.0)
    moved = f"moved the UV map by ({0 - low[0]:g}, {0 - low[1]:g})" + (
        f" and scaled it by 1/{tiles:g}" if tiles > 1 else ""
    )
    return replace(mesh, uv=np.clip((mesh.uv - low) / tiles, 0.0, 1.0)), [f"{moved} into the unit square"]


def _merged(mesh: Mesh, pairs: np.ndarray) -> Mesh:
    """Joined vertices become the first of them; the others stay behind unused."""
    label = components(len(mesh.vertices), pairs)
    into = np.unique(label, return_index=True)[1][label]
    seams, pins = into[mesh.seams], into[mesh.pins]
    seams = seams[seams[:, 0] != seams[:, 1]]
    once = np.sort(np.unique(np.sort(seams, axis=1), axis=0, return_index=True)[1])
    return replace(
        mesh, faces=into[mesh.faces], seams=seams[once], pins=pins[np.sort(np.unique(pins, return_index=True)[1])]
    )
