"""Baking: even meshes in the plane, panels that meet, skirts remade as they lie in datasets/, fewer vertices."""

import sys

import numpy as np
import pytest

from garmentbench.paths import DATASETS, GARMENTS


@pytest.fixture(autouse=True, scope="module")
def bake_folder():
    """datasets/bake on the path: its scripts import each other by name."""
    sys.path.insert(0, str(DATASETS / "bake"))
    yield
    sys.path.remove(str(DATASETS / "bake"))


def circle(count: int, radius: float) -> np.ndarray:
    angle = 2 * np.pi * np.arange(count) / count
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def grid_tube(rows: int, columns: int, radius: float, height: float) -> tuple[np.ndarray, np.ndarray]:
    from tube import grid_faces

    ring = circle(columns, radius)
    points = np.concatenate([np.column_stack([ring, np.full(columns, z)]) for z in np.linspace(height, 0, rows)])
    number = np.arange(rows * columns).reshape(rows, columns)
    return points, grid_faces(np.concatenate([number, number[:, :1]], axis=1))


def angles(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Angles of triangles in degrees, shape (F, 3)."""
    corners = points[faces]
    a, b = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    return np.degrees(np.arccos((a * b).sum(-1) / np.linalg.norm(a, axis=-1) / np.linalg.norm(b, axis=-1)))


def test_grid_faces_point_outwards():
    points, faces = grid_tube(4, 12, 0.2, 0.3)
    a, b, c = points[faces].transpose(1, 0, 2)
    outward = (a + b + c)[:, :2]
    assert (np.einsum("fx,fx->f", np.cross(b - a, c - a)[:, :2], outward) > 0).all()


def test_hull_radius_of_a_tube_is_its_radius_and_never_shrinks_downwards():
    from tube import AXIS, hull_radius

    points, faces = grid_tube(31, 180, 0.2, 0.3)
    points[:, 2] += 1.0
    points[:, :2] *= 0.5 + (points[:, 2:] - 1.0) / 0.6  # a cone that gets narrower downwards
    radius = hull_radius(points + [*AXIS, 0], faces, np.array([1.295, 1.15, 1.005]), np.linspace(0, 6, 7))
    np.testing.assert_allclose(radius[0], 0.2 * (0.5 + 0.295 / 0.6), rtol=1e-3)
    np.testing.assert_array_equal(radius[1:], radius[:1].repeat(2, axis=0))


def test_a_disk_is_meshed_evenly():
    from lattice import evened, triangles

    outline = circle(63, 1.0)  # edges of 0.1
    inner = np.random.default_rng(0).uniform(-1, 1, (400, 2))
    inner = evened(outline, inner[np.linalg.norm(inner, axis=1) < 0.93])
    plane = np.concatenate([outline, inner])
    faces = triangles(plane, len(outline))
    assert angles(plane, faces).min() > 25
    a, b, c = plane[faces].transpose(1, 2, 0)
    area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2
    assert area.min() > 0
    assert area.sum() == pytest.approx(63 / 2 * np.sin(2 * np.pi / 63), rel=1e-9)  # the polygon's, no more and no less


def test_triangles_stay_within_a_notched_outline():
    from lattice import triangles

    outline = np.array([[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1.5, 1], [1, 0.5], [0.5, 1], [0, 2], [0, 1]], float)
    faces = triangles(outline, len(outline))
    a, b, c = outline[faces].transpose(1, 2, 0)
    shoelace = outline[:, 0] @ np.roll(outline[:, 1], -1) - outline[:, 1] @ np.roll(outline[:, 0], -1)
    assert ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).sum() == pytest.approx(shoelace)


def test_panels_of_a_tube_meet_in_the_same_points():
    from fitting import joined_points
    from lattice import flat_panel, mesh, size

    points, faces = grid_tube(16, 60, 0.2, 0.3)
    level = -points[:, 1] - 1e-3
    panels = [flat_panel(points, faces, sign * level, points, np.array([sign, 0, 0])) for sign in (1, -1)]
    front, back = (mesh(panel, 0.03) for panel in panels)
    assert [len(front.points), len(back.points)] == [size(panel, 0.03) for panel in panels]
    place = joined_points([front, back])
    joined = np.flatnonzero(place != np.arange(len(place)))
    assert len(joined) == 2 * (10 + 1)  # two seams of 30 cm
    both = np.concatenate([front.points, back.points])
    np.testing.assert_allclose(both[joined], both[place[joined]], atol=1e-9)
    flat, curved = (
        np.linalg.norm(x[front.faces] - np.roll(x[front.faces], 1, axis=1), axis=2) for x in (front.flat, front.points)
    )
    np.testing.assert_allclose(flat, curved, rtol=0.05)  # half a tube is laid flat without stretching it


@pytest.mark.parametrize("size", ["smoke", "laptop"])
def test_the_pleated_skirt_is_remade(size):
    from bake_pleated_skirt import SIZES, pleated
    from fitting import body_skin

    made = pleated(SIZES[size], body_skin())
    with np.load(GARMENTS / f"pleated_skirt-{size}.npz") as stored:
        np.testing.assert_allclose(made["rest"], stored["rest"], atol=1e-5)
        for key in ("faces", "seams", "pins"):
            np.testing.assert_array_equal(made[key], stored[key])


def test_pleats_are_as_deep_as_the_cloth_allows():
    """Flat cloth of 1.5 m round a circle of 1 m: each side of a pleat keeps its length."""
    from pleats import fold_depth

    around, width, pleats = np.array([1.0]), np.array([1.5]), 18
    depth = fold_depth(around, width, pleats)[0]
    along = (1.0 + np.pi * depth) / (2 * pleats)  # half way out
    assert np.hypot(depth, along) == pytest.approx(1.5 / (2 * pleats))
    assert fold_depth(around, around, pleats)[0] == pytest.approx(0)


def test_a_sleeve_is_opened_below_and_whole_above():
    """A tube along x whose ends are the armhole and the border: one panel, sewn to itself along its lower line."""
    from fitting import joined_points
    from lattice import mesh
    from pattern_pieces import ARMHOLE, BORDER, opened, panel

    upright, faces = grid_tube(16, 60, 0.1, 0.2)
    points = np.column_stack([0.4 - upright[:, 2], upright[:, 1], upright[:, 0]])  # along x, from 0.2 to 0.4
    table = np.zeros((len(points), 11))
    table[:, :6], table[:, 9] = np.tile(points, 2), -points[:, 1] - 1e-3
    table[np.isclose(points[:, 0], 0.2), ARMHOLE] = table[np.isclose(points[:, 0], 0.4), BORDER] = 1
    cloth = panel(*opened(table, faces), [0, 1, 0])
    assert len(cloth.corners) == 5  # two ends of the lower line, twice, and where the upper one meets the armhole
    rim = cloth.flat[cloth.border]
    around = np.linalg.norm(rim - np.roll(rim, 1, axis=0), axis=1).sum()
    assert around == pytest.approx(2 * (0.2 + 2 * np.pi * 0.1), rel=0.01)  # a rectangle
    meshed = mesh(cloth, 0.02)
    place = joined_points([meshed])
    joined = np.flatnonzero(place != np.arange(len(place)))
    assert len(joined) == 11
    assert (meshed.points[joined, 2] < -0.09).all()  # below


@pytest.mark.parametrize("size", ["smoke", "laptop"])
def test_the_over_skirt_is_remade(size):
    from bake_over_skirt import over_skirt

    made = over_skirt(size)
    with np.load(GARMENTS / f"over_skirt-{size}.npz") as stored:
        np.testing.assert_allclose(made["rest"], stored["rest"], atol=1e-5)
        for key in ("faces", "seams", "pins"):
            np.testing.assert_array_equal(made[key], stored[key])


def ball() -> "tuple[np.ndarray, np.ndarray]":
    from trimesh.creation import icosphere

    sphere = icosphere(subdivisions=3)
    return np.asarray(sphere.vertices), np.asarray(sphere.faces)


@pytest.mark.parametrize("by", ["length", "error"])
def test_fewer_vertices_are_still_a_closed_ball(by):
    from decimation import Surface, by_error, by_length
    from trimesh import Trimesh

    points, faces = ball()
    surface = Surface(points, faces)
    cost = by_length if by == "length" else by_error
    surface.collapse(np.ones(len(points), bool), 160, cost(np.ones(len(points))))
    fewer = Trimesh(*surface.result(), process=False)
    assert len(fewer.vertices) == 160 and fewer.is_watertight and fewer.euler_number == 2
    assert fewer.volume > 0.9 * 4 / 3 * np.pi
    assert np.degrees(fewer.face_angles.min()) > 10  # rounding decides which of a ball's like edges goes: 11.7 and more


def test_what_is_left_out_stays_and_a_flat_side_goes_before_a_curved_one():
    from decimation import Surface, by_error

    points, faces = ball()
    cut = np.column_stack([points[:, :2], np.minimum(points[:, 2], 0.5)])  # a flat top
    kept = points[:, 2] < -0.5
    surface = Surface(cut, faces)
    surface.collapse(~kept, 300, by_error(np.ones(len(cut))))
    left, _ = surface.result()
    assert (left[:, 2] < -0.5).sum() == kept.sum()
    top, side = (
        [part(points[:, 2]).sum() for points in (left, cut)]
        for part in (lambda z: z > 0.499, lambda z: np.abs(z) < 0.499)
    )
    assert top[0] / top[1] < 0.3 and side[0] / side[1] > 0.7


def test_little_of_the_sky_is_seen_from_a_pit():
    from sight import sky

    points, faces = ball()
    pit = points[:, 2] > 0.9
    dented = np.where(pit[:, None], [0.3, 0.3, -0.6], [1.0, 1.0, 1.0]) * points
    assert sky(dented, faces)[pit].max() < 0.2
    assert sky(points, faces).min() > 0.98
