"""From a finely meshed shape to a garment of so many vertices: its panels, sewn, off the skin, with their UV charts."""

import charts
import numpy as np
from lattice import FlatPanel, Panel, flat_panel, mesh, size, whole
from scipy.spatial import cKDTree
from surface import Skin, averaging, border_loop, normals, push_out

from garmentbench.scenes.bodies import load_body

CLEARANCE = 0.006  # [m] of vertices and middles of edges and faces off the skin
THIN = 0.25  # of an edge: the least height of a triangle
ATTEMPTS = 8
GAP = 0.05  # [m] between the flat panels of a pattern
RIGHT = np.array([1.0, 0.0, 0.0])  # of the front


def body_skin() -> Skin:
    """The baked base body's skin."""
    body = load_body("base", "full").body
    return Skin(body.rest.astype(float), body.faces)


class Cloth:
    """A garment's shape, ready to be meshed at any size.

    Args:
        points: Fine points [m], shape (V, 3); faces: shape (F, 3).
        level: Positive on the front panel, negative on the back one, shape (V,).
        spread: What is laid flat in place of `points` (see `lattice.flat_panel`).
    """

    def __init__(self, points: np.ndarray, faces: np.ndarray, level: np.ndarray, spread: np.ndarray | None = None):
        spread = points if spread is None else spread
        self.panels = [flat_panel(points, faces, sign * level, spread, sign * RIGHT) for sign in (1, -1)]
        self.columns, self.patterned = ((0,), (1,)), False

    @classmethod
    def cut(cls, panels: list[FlatPanel], columns: tuple[tuple[int, ...], ...]) -> "Cloth":
        """A garment whose cloth is cut as its flat panels are; `columns` says how their charts are laid out."""
        cloth = cls.__new__(cls)
        cloth.panels, cloth.columns, cloth.patterned = panels, columns, True
        return cloth

    def fit(self, skin: Skin, wanted: int) -> dict[str, np.ndarray]:
        """The arrays of a garment's file, with about so many vertices and without thin triangles; without pins."""
        edge = 1 / np.sqrt(wanted)
        for _ in range(5):
            edge *= np.sqrt(sum(size(panel, edge) for panel in self.panels) / wanted)
        return self.meshed(skin, edge)

    def meshed(self, skin: Skin, edge: float) -> dict[str, np.ndarray]:
        """The same, with edges of about that length [m]."""
        for attempt in range(ATTEMPTS):
            edge *= 1.003 if attempt else 1.0
            panels = [mesh(panel, edge) for panel in self.panels]
            if not all(map(whole, panels)):
                continue
            garment = sewn(panels, self.columns, skin, self.patterned)
            cloth = np.pad(garment["cut"], ((0, 0), (0, 1))) if self.patterned else garment["rest"]
            even = thinnest(cloth, garment["faces"]) / edge
            print(f"edge {edge * 1e3:.1f} mm, thinnest triangle {even:.2f} of that")
            if even > THIN:
                return garment
        raise AssertionError("thin triangles at every edge length that was tried")


def sewn(
    panels: list[Panel], columns: tuple[tuple[int, ...], ...], skin: Skin, patterned: bool = False
) -> dict[str, np.ndarray]:
    """The arrays of a garment's file: the panels joined and moved off the skin.

    `patterned`: they are cut as their patterns say, so that points stay where the patterns have them; else they are
    evened out in space.
    """
    place = joined_points(panels)
    number = np.arange(len(place))
    starts = np.cumsum([0] + [len(panel.points) for panel in panels])
    faces = np.concatenate([panel.faces + start for panel, start in zip(panels, starts[:-1], strict=True)])
    used, shared = np.unique(place[faces], return_inverse=True)
    points, shared = np.concatenate([panel.points for panel in panels])[used], shared.reshape(-1, 3)
    panel_of = np.repeat(np.arange(len(panels)), [len(panel.faces) for panel in panels])
    for _ in range(3):
        points = push_out(points if patterned else relax(points, shared, panel_of), shared, skin, CLEARANCE)
    rest = points[np.searchsorted(used, place)]
    upright = [charts.turn(p.flat, np.column_stack([p.points @ p.right, p.points[:, 2]])) for p in panels]
    order = [i for column in columns for i in column]
    uv, laid = np.empty((len(rest), 2)), charts.in_columns([[upright[i] for i in column] for column in columns])
    for i, chart in zip(order, laid, strict=True):
        uv[starts[i] : starts[i + 1]] = chart
    pairs = np.column_stack([place, number])[place != number]
    arrays = {"rest": rest, "faces": faces, "uv": uv, "seams": pairs, "pins": np.zeros(0, int)}
    return arrays | ({"cut": apart(upright)} if patterned else {})


def apart(flat: list[np.ndarray]) -> np.ndarray:
    """Flat panels [m] in one row with gaps between them, shape (V, 2)."""
    left, row = 0.0, []
    for panel in flat:
        row.append(panel - panel.min(axis=0) + [left, 0])
        left = row[-1][:, 0].max() + GAP
    return np.concatenate(row)


def relax(points: np.ndarray, faces: np.ndarray, panels: np.ndarray, rounds: int = 10) -> np.ndarray:
    """Even out the triangles by moving vertices within the surface; borders and seams stay where they are."""
    mean = averaging(faces, len(points))
    rims = [border_loop(faces[panels == side]) for side in np.unique(panels)]
    free = np.ones((len(points), 1))
    free[np.concatenate(rims)] = 0
    for _ in range(rounds):
        move = mean @ points - points
        facing = normals(points, faces)
        move -= np.einsum("vc,vc->v", move, facing)[:, None] * facing
        points = points + 0.5 * free * move
    return points


def joined_points(panels: list[Panel]) -> np.ndarray:
    """The number of the point, among those of all panels, that each is sewn to: itself, or the first of several rims'
    points in one place."""
    starts = np.cumsum([0] + [len(panel.points) for panel in panels])
    place = np.arange(starts[-1])
    rims = np.concatenate([start + np.arange(panel.rim) for panel, start in zip(panels, starts[:-1], strict=True)])
    points = np.concatenate([panel.points[: panel.rim] for panel in panels])
    for first, second in sorted(cKDTree(points).query_pairs(1e-6)):
        place[rims[second]] = min(place[rims[second]], place[rims[first]])
    return place


def thinnest(points: np.ndarray, faces: np.ndarray) -> float:
    """The smallest height of any triangle [m]; slivers and short edges make it small."""
    a, b, c = points[faces].transpose(1, 0, 2)
    longest = np.max([np.linalg.norm(d, axis=1) for d in (b - a, c - b, a - c)], axis=0)
    return float((np.linalg.norm(np.cross(b - a, c - a), axis=1) / longest).min())
