"""From a finely meshed shape to a garment of so many vertices: two panels, sewn, off the skin, with their UV charts."""

import charts
import numpy as np
from lattice import Panel, flat_panel, mesh, size
from scipy.spatial import cKDTree
from surface import Skin, averaging, border_loop, normals, push_out

from garmentbench.scenes.bodies import load_body

CLEARANCE = 0.006  # [m] of vertices and middles of edges and faces off the skin
THIN = 0.3  # of an edge: the least height of a triangle
ATTEMPTS = 8


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
        self.front, self.back = flat_panel(points, faces, level, spread), flat_panel(points, faces, -level, spread)

    def fit(self, skin: Skin, wanted: int) -> dict[str, np.ndarray]:
        """The arrays of a garment's file, with about so many vertices and without thin triangles; without pins."""
        edge = 1 / np.sqrt(wanted)
        for _ in range(5):
            edge *= np.sqrt((size(self.front, edge) + size(self.back, edge)) / wanted)
        return self.meshed(skin, edge)

    def meshed(self, skin: Skin, edge: float) -> dict[str, np.ndarray]:
        """The same, with edges of about that length [m]."""
        for _ in range(ATTEMPTS):
            garment = sewn(mesh(self.front, edge), mesh(self.back, edge), skin)
            even = thinnest(garment["rest"], garment["faces"]) / edge
            print(f"edge {edge * 1e3:.1f} mm, thinnest triangle {even:.2f} of that")
            if even > THIN:
                return garment
            edge *= 1.003
        raise AssertionError("thin triangles at every edge length that was tried")


def sewn(front: Panel, back: Panel, skin: Skin) -> dict[str, np.ndarray]:
    """The arrays of a garment's file: the panels joined, evened out in space and moved off the skin."""
    place = joined_points(front, back)
    number = np.arange(len(place))
    faces = np.concatenate([front.faces, back.faces + len(front.points)])
    used, shared = np.unique(place[faces], return_inverse=True)
    points, shared = np.concatenate([front.points, back.points])[used], shared.reshape(-1, 3)
    panel_of = np.repeat([0, 1], [len(front.faces), len(back.faces)])
    for _ in range(3):
        points = push_out(relax(points, shared, panel_of), shared, skin, CLEARANCE)
    rest = points[np.searchsorted(used, place)]
    seams = np.column_stack([place, number])[place != number]
    return {"rest": rest, "faces": faces, "uv": chart(front, back, rest), "seams": seams, "pins": np.zeros(0, int)}


def relax(points: np.ndarray, faces: np.ndarray, panels: np.ndarray, rounds: int = 10) -> np.ndarray:
    """Even out the triangles by moving vertices within the surface; borders and seams stay where they are."""
    mean = averaging(faces, len(points))
    rims = [border_loop(faces[panels == side]) for side in (0, 1)]
    free = np.ones((len(points), 1))
    free[np.concatenate(rims)] = 0
    for _ in range(rounds):
        move = mean @ points - points
        facing = normals(points, faces)
        move -= np.einsum("vc,vc->v", move, facing)[:, None] * facing
        points = points + 0.5 * free * move
    return points


def joined_points(front: Panel, back: Panel) -> np.ndarray:
    """The number of the point, among those of front and back, that each is sewn to: itself, or one of front's rim."""
    place = np.arange(len(front.points) + len(back.points))
    apart, twin = cKDTree(front.points[: front.rim]).query(back.points[: back.rim])
    joined = np.flatnonzero(apart < 1e-6)
    place[len(front.points) + joined] = twin[joined]
    return place


def chart(front: Panel, back: Panel, rest: np.ndarray) -> np.ndarray:
    """UV coordinates: both flat panels upright beside each other, shape (V, 2)."""
    flat = []
    for panel, shape, sign in ((front, rest[: len(front.points)], 1), (back, rest[len(front.points) :], -1)):
        flat.append(charts.turn(panel.flat, np.column_stack([sign * shape[:, 0], shape[:, 2]])))
    return np.concatenate(charts.side_by_side(flat))


def thinnest(points: np.ndarray, faces: np.ndarray) -> float:
    """The smallest height of any triangle [m]; slivers and short edges make it small."""
    a, b, c = points[faces].transpose(1, 0, 2)
    longest = np.max([np.linalg.norm(d, axis=1) for d in (b - a, c - b, a - c)], axis=0)
    return float((np.linalg.norm(np.cross(b - a, c - a), axis=1) / longest).min())
