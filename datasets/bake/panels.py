"""From a fine surface to an evenly meshed garment: two panels that meet in the same seam points."""

import gpytoolbox
import numpy as np
from charts import disk_map
from lattice import even_rim
from scipy.spatial import Delaunay, cKDTree
from surface import border_loop, clip


def sew(
    points: np.ndarray, faces: np.ndarray, level: np.ndarray, edge: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mesh the garment evenly, with a seam along the zero of `level`.

    Args:
        points: The fine garment [m], shape (V, 3); faces: shape (F, 3).
        level: Positive on the front panel, negative on the back one, shape (V,).
        edge: Wanted edge length [m].

    Returns:
        Points [m], faces, and each face's panel (0 front, 1 back). Seam points are shared, not yet split.
    """
    front, front_faces = panel(points, faces, level, edge)
    back, back_faces = panel(points, faces, -level, edge)
    front_rim, back_rim = border_loop(front_faces), border_loop(back_faces)
    apart, twin = cKDTree(front[front_rim]).query(back[back_rim])
    number = len(front) + np.arange(len(back))
    number[back_rim[apart < 1e-6]] = front_rim[twin[apart < 1e-6]]
    merged = np.concatenate([front_faces, number[back_faces]])
    used, merged = np.unique(merged, return_inverse=True)
    panels = np.repeat([0, 1], [len(front_faces), len(back_faces)])
    return np.concatenate([front, back])[used], merged.reshape(-1, 3), panels


def panel(points: np.ndarray, faces: np.ndarray, level: np.ndarray, edge: float) -> tuple[np.ndarray, np.ndarray]:
    """The part where `level` is positive, remeshed; its border is spaced evenly between its corners and then kept."""
    points, faces, on_seam = clip(points, faces, level)
    border = border_loop(faces)
    # Corners: seam points next to the garment's own border.
    seam = on_seam[border]
    corners = np.flatnonzero(seam & ~(np.roll(seam, 1) & np.roll(seam, -1)))
    border, corners = np.roll(border, -corners[0]), corners - corners[0]
    rim, angle = even_rim(points[border], corners, edge)
    flat = disk_map(points, faces, border)
    inner = np.setdiff1d(np.arange(len(points)), border)
    inner = inner[cKDTree(rim).query(points[inner])[0] > 0.7 * edge]
    # In the disk all of the rim is on the convex hull, so that Delaunay's triangles fill the panel and no more.
    plane = np.concatenate([np.column_stack([np.cos(angle), np.sin(angle)]), flat[inner]])
    start = Delaunay(plane).simplices
    a, b, c = plane[start].transpose(1, 0, 2)
    clockwise = np.linalg.det(np.stack([b - a, c - a], axis=1)) < 0
    start[clockwise] = start[clockwise][:, ::-1]
    # The library never moves a border.
    return gpytoolbox.remesh_botsch(np.concatenate([rim, points[inner]]), start.astype(np.int32), 20, edge, True)


def split_seam(points: np.ndarray, faces: np.ndarray, panels: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Give each panel its own copy of the seam's points. Returns points, faces and pairs of copies, shape (S, 2)."""
    front, back = np.unique(faces[panels == 0]), np.unique(faces[panels == 1])
    shared = np.intersect1d(front, back)
    copy = np.arange(len(points))
    copy[shared] = len(points) + np.arange(len(shared))
    faces = faces.copy()
    faces[panels == 1] = copy[faces[panels == 1]]
    return np.concatenate([points, points[shared]]), faces, np.column_stack([shared, copy[shared]])
