"""A picture of a garment with everything marked in red that the doctor found."""

from pathlib import Path

import numpy as np

from garmentbench.errors import UserError
from garmentbench.geometry.mesh import normalised
from garmentbench.importing.mesh_doctor import shape, uv
from garmentbench.importing.mesh_doctor.finding import Finding
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.sequence import Body
from garmentbench.storage.atomic import written_whole
from garmentbench.viewing.render import CLOTH, RenderMesh, bounds, render

RED = (0.86, 0.08, 0.10)
_VIEWS = "three-quarter", "back"
_SIZE = 450, 600  # of a view [pixels]
_DOT, _LINE = 0.006, 0.002  # radius over the garment's size
_MOST = 2_000  # marks of a kind that are drawn
_OCTAHEDRON = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])


def picture(mesh: Mesh, findings: list[Finding], png: Path, body: Body | None = None) -> None:
    """Draw a garment from two sides, on the body that it was checked against, and its UV map beside it, into a PNG
    file.

    Raises `UserError` for positions that are not finite, or where the file can't be written.
    """
    from matplotlib.figure import Figure

    if shape.not_finite(mesh):
        raise UserError(f"{mesh.name}: a mesh with NaN positions can't be drawn; export it again")
    figure = Figure(figsize=(13.5, 6), dpi=100, layout="constrained")
    axes = figure.subplots(1, 3)
    drawn = _drawn(mesh, findings)
    focus = bounds(mesh.vertices[mesh.faces], margin=0.03 * mesh.size)
    if body is not None:
        drawn.append(RenderMesh(body.rest, body.faces))
        if (focus[0] > body.rest.max(axis=0)).any() or (focus[1] < body.rest.min(axis=0)).any():  # beside it
            focus = bounds(focus, body.rest)
    for ax, view in zip(axes, _VIEWS, strict=False):
        ax.imshow(render(drawn, view, _SIZE, focus))
        ax.set_axis_off()
    _draw_uv(axes[2], mesh, findings)
    with written_whole(png) as partial:
        figure.savefig(partial, format="png")


def _drawn(mesh: Mesh, findings: list[Finding]) -> list[RenderMesh]:
    """The garment, marked faces red, and dots and lines where vertices and edges are marked."""
    marked = np.zeros(len(mesh.faces), bool)
    for finding in findings:
        if not finding.in_uv:
            marked[finding.faces] = True
    edges = np.concatenate([f.edges for f in findings] or [np.zeros((0, 2), np.int64)])[:_MOST]
    dots = np.concatenate([f.vertices for f in findings] or [np.zeros(0, np.int64)])[:_MOST]
    parts = [(mesh.faces[~marked], CLOTH), (mesh.faces[marked], RED)]
    drawn = [RenderMesh(mesh.vertices, faces, colour, cloth=True) for faces, colour in parts if len(faces)]
    if len(dots):
        drawn.append(_dots(mesh.vertices[dots], _DOT * mesh.size))
    if len(edges):
        start, end = mesh.vertices[edges].transpose(1, 0, 2)
        drawn.append(_lines(start, end, _LINE * mesh.size))
    return drawn


def _dots(centres: np.ndarray, radius: float) -> RenderMesh:
    """Octahedra round centres, shape (N, 3)."""
    axes = np.repeat(np.eye(3), 2, axis=0) * np.array([1, -1] * 3)[:, None] * radius
    return _copies(centres[:, None] + axes)


def _lines(start: np.ndarray, end: np.ndarray, radius: float) -> RenderMesh:
    """Long octahedra from start to end, shape (N, 3) each, as thick as 2 `radius` in the middle."""
    along = normalised(end - start)
    aside = normalised(np.cross(along, np.eye(3)[np.abs(along).argmin(axis=1)]))
    other = np.cross(along, aside)
    middle, tip = (start + end) / 2, radius * along
    sides = [middle + radius * way for way in (aside, -aside, other, -other)]
    return _copies(np.stack([*sides, end + tip, start - tip], axis=1))


def _copies(corners: np.ndarray) -> RenderMesh:
    """An octahedron of each six corners, shape (N, 6, 3)."""
    faces = (_OCTAHEDRON + 6 * np.arange(len(corners))[:, None, None]).reshape(-1, 3)
    return RenderMesh(corners.reshape(-1, 3), faces, RED)


def _draw_uv(ax, mesh: Mesh, findings: list[Finding]) -> None:
    from matplotlib.collections import PolyCollection

    ax.set_title("UV", fontsize=9)
    ax.set_aspect("equal")
    if uv.missing(mesh):
        ax.text(0.5, 0.5, "none", ha="center", va="center")
        return
    triangles = mesh.required_uv[mesh.faces]
    ax.add_collection(PolyCollection(list(triangles), facecolors="0.92", edgecolors=CLOTH, linewidths=0.2))
    marked = np.unique(np.concatenate([f.faces for f in findings if f.in_uv] or [np.zeros(0, np.int64)]))
    if len(marked):
        ax.add_collection(
            PolyCollection(list(triangles[marked]), facecolors=(*RED, 0.35), edgecolors=RED, linewidths=0.4)
        )
    low, high = np.minimum(triangles.min(axis=(0, 1)), 0), np.maximum(triangles.max(axis=(0, 1)), 1)
    ax.set(xlim=(low[0] - 0.02, high[0] + 0.02), ylim=(low[1] - 0.02, high[1] + 0.02))
    ax.tick_params(labelsize=7)
    ax.plot([0, 1, 1, 0, 0], [0, 0, 1, 1, 0], color="0.4", linewidth=0.6)
