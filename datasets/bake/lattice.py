"""A panel meshed in its flat pattern: rows of equilateral triangles, evened out, then laid on the surface again.

Even triangles are what the simulator wants: its time step follows the smallest ones.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from charts import flatten
from matplotlib.path import Path
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import Delaunay, cKDTree
from surface import border_loop, clip

ROUNDS = 60
NEAREST_TO_RIM = 0.7  # edge lengths: a point of the lattice that would lie nearer is left out


@dataclass(frozen=True)
class FlatPanel:
    """A piece of a garment as a fine surface and flat.

    Attributes:
        points: [m], shape (V, 3).
        even: The shape along whose border the mesh's points are even [m], shape (V, 3).
        flat: The panel laid flat [m], shape (V, 2).
        border: Vertices in the faces' direction, from the first corner on, shape (B,).
        corners: Where in the border the seams end, shape (C,).
        right: What lies to the right for who looks at its outside [1], shape (3,).
    """

    points: np.ndarray
    even: np.ndarray
    flat: np.ndarray
    border: np.ndarray
    corners: np.ndarray
    right: np.ndarray


@dataclass(frozen=True)
class Panel:
    """A meshed pattern: points [m], shape (V, 3), the same laid flat [m], shape (V, 2), and faces; rim first.

    `right` is as in `FlatPanel`.
    """

    points: np.ndarray
    flat: np.ndarray
    faces: np.ndarray
    rim: int
    right: np.ndarray


def flat_panel(
    points: np.ndarray, faces: np.ndarray, level: np.ndarray, spread: np.ndarray, right: np.ndarray
) -> FlatPanel:
    """The part of a fine garment where `level`, shape (V,), is positive, laid flat. It must be a disk.

    What is laid flat is the shape `spread`, shape (V, 3), of the same cloth: a panel with two legs would overlap itself
    where they meet, unless they are spread.
    """
    table, faces, on_seam = clip(np.column_stack([points, spread]), faces, level)
    border = border_loop(faces)
    seam, corner = on_seam[border], np.zeros(len(table), bool)
    corner[border] = seam & ~(np.roll(seam, 1) & np.roll(seam, -1))  # seam points next to the garment's border
    return laid_flat(table[:, :3], faces, corner, table[:, 3:], right, table[:, :3])


def laid_flat(
    points: np.ndarray, faces: np.ndarray, corner: np.ndarray, spread: np.ndarray, right: np.ndarray, even: np.ndarray
) -> FlatPanel:
    """A disk laid flat as in `flat_panel`; seams end where `corner`, shape (V,), bool, is true on its border."""
    border = border_loop(faces)
    corners = np.flatnonzero(corner[border])
    border = np.roll(border, -corners[0])
    return FlatPanel(points, even, flatten(spread, faces), border, corners - corners[0], right)


def size(cloth: FlatPanel, edge: float) -> int:
    """How many vertices `mesh` makes."""
    return sum(map(len, starting_points(cloth, edge)[1:]))


def mesh(cloth: FlatPanel, edge: float) -> Panel:
    """A panel with edges of about that length [m]. Two panels that share a seam get the same points along it."""
    rim, outline, inner = starting_points(cloth, edge)
    inner = evened(outline, inner)
    flat = np.concatenate([outline, inner])
    # Delaunay's triangles of the fine points are near enough to their own faces, and don't mind one that folds over.
    lifted = LinearNDInterpolator(cloth.flat, cloth.points)(inner)
    return Panel(np.concatenate([rim, lifted]), flat, triangles(flat, len(outline)), len(rim), cloth.right)


def whole(panel: Panel) -> bool:
    """Are all sides of the rim sides of its triangles? Where a pattern is narrow, too long an edge loses some."""
    sides = set(map(tuple, np.sort(panel.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1).tolist()))
    return all((k, k + 1) in sides for k in range(panel.rim - 1)) and (0, panel.rim - 1) in sides


def starting_points(cloth: FlatPanel, edge: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The rim's points [m], shape (R, 3), the same on the flat pattern, shape (R, 2), and those of a triangular lattice
    inside, shape (I, 2)."""
    even = cloth.even[cloth.border]
    angle = even_rim(even, cloth.corners, edge)
    steps = np.linalg.norm(np.roll(even, -1, axis=0) - even, axis=1)
    along = 2 * np.pi * np.concatenate([[0], np.cumsum(steps)]) / steps.sum()
    closed = np.column_stack([cloth.points, cloth.flat])[np.append(cloth.border, cloth.border[0])]
    rim, outline = np.split(np.column_stack([np.interp(angle, along, axis) for axis in closed.T]), [3], axis=1)
    low, high = outline.min(axis=0), outline.max(axis=0)
    x, y = np.meshgrid(np.arange(low[0] - edge, high[0], edge), np.arange(low[1], high[1], edge * np.sqrt(3) / 2))
    x += edge / 2 * (np.arange(len(x)) % 2)[:, None]
    inner = np.column_stack([x.ravel(), y.ravel()])
    inner = inner[Path(outline).contains_points(inner)]
    return rim, outline, inner[cKDTree(outline).query(inner)[0] > NEAREST_TO_RIM * edge]


def even_rim(border: np.ndarray, corners: np.ndarray, edge: float) -> np.ndarray:
    """Points at even distances along a closed polyline that starts at a corner, as angles on a circle, shape (R,)."""
    closed = np.concatenate([border, border[:1]])
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    stops = np.append(length[corners], length[-1])
    at = np.concatenate([np.linspace(a, b, max(2, round((b - a) / edge)), endpoint=False) for a, b in pairwise(stops)])
    return 2 * np.pi * at / length[-1]


def evened(outline: np.ndarray, inner: np.ndarray) -> np.ndarray:
    """Inner points, shape (I, 2), moved again and again to the centre of the triangles round them."""
    for _ in range(ROUNDS):
        plane = np.concatenate([outline, inner])
        faces = triangles(plane, len(outline))
        a, b, c = plane[faces].transpose(1, 2, 0)
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        moments = np.column_stack([area * (a + b + c)[0] / 3, area * (a + b + c)[1] / 3, area])
        sums = np.zeros((len(plane), 3))
        for corner in faces.T:
            np.add.at(sums, corner, moments)
        inner = (sums[:, :2] / sums[:, 2:])[len(outline) :]
    return inner


def triangles(plane: np.ndarray, rim: int) -> np.ndarray:
    """Delaunay's triangles, shape (F, 3), counterclockwise, of points, shape (V, 2).

    Only those within the outline that the first `rim` points make.
    """
    faces = Delaunay(plane).simplices
    across = (faces < rim).all(axis=1)  # only these can lie outside
    inside = np.ones(len(faces), bool)
    inside[across] = Path(plane[:rim]).contains_points(plane[faces[across]].mean(axis=1))
    faces = faces[inside]
    a, b, c = plane[faces].transpose(1, 2, 0)
    clockwise = (b[0] - a[0]) * (c[1] - a[1]) < (b[1] - a[1]) * (c[0] - a[0])
    faces[clockwise] = faces[clockwise][:, ::-1]
    return faces
