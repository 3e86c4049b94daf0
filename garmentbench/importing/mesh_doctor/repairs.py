"""Repairs of a garment's mesh, each safe by itself: a mesh in, the mended mesh and a line on what was done out.

A repair that has nothing to do gives the very mesh that it was given, and no line.
"""

from dataclasses import replace

import numpy as np

from garmentbench.importing.mesh_doctor.coincident import gaps, same_uv
from garmentbench.importing.mesh_doctor.finding import counted
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.orientation import inward_patches
from garmentbench.importing.mesh_doctor.shape import FLAT, POINT, heights
from garmentbench.importing.mesh_doctor.topology import components, doubles, repeats_a_corner, sides, winding
from garmentbench.importing.mesh_doctor.wearer import Wearer

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
    """Of faces with the same corners only the first."""
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
    """Faces that can go without a slit: two or three sides on a border, or the longest and the corner opposite inside."""
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
    same = same_uv(mesh, *joins.T)
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
