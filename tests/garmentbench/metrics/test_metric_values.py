"""Each metric against values computed by hand."""

import numpy as np
import pytest

from garmentbench.geometry.mesh import edge_lengths, unique_edges
from garmentbench.geometry.signed_distance import signed_distances
from garmentbench.metrics.interpenetration import inside_vertices, interpenetration
from garmentbench.metrics.interpenetration_strict import depth_p95, interpenetration_strict
from garmentbench.metrics.jitter import jitter
from garmentbench.metrics.l2 import frame_l2, l2
from garmentbench.metrics.liveliness import liveliness, near_displacements, vertex_areas
from garmentbench.metrics.metric import Motion, scores
from garmentbench.metrics.ms_per_frame import TIMES, under_load
from garmentbench.metrics.skill import skill
from garmentbench.metrics.stable_frames import stable_frames
from garmentbench.metrics.strain import strain_mean, strain_p95, strain_p99_max

# A tetrahedron with corners 0, x, y, z; its slanted face is the plane x + y + z = 1. Outward orientation.
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], np.int32)


def test_l2_is_the_mean_distance_in_cm():
    reference = np.zeros((2, 2, 3), np.float32)
    predicted = reference.copy()
    predicted[0, 0] = [0.03, 0.04, 0]  # 5 cm
    predicted[1, 1] = [0, 0, 0.01]  # 1 cm
    np.testing.assert_allclose(frame_l2(predicted, reference), [2.5, 0.5], rtol=1e-6)
    assert l2(predicted, reference) == pytest.approx(1.5)
    predicted[1, 0, 0] = np.nan
    assert np.isnan(frame_l2(predicted, reference)).tolist() == [False, True]


def test_interpenetration_counts_what_is_behind_the_nearest_vertex_tangent_plane():
    # At corner x = (1, 0, 0) meet the faces with normals -z, -y and (1, 1, 1) / sqrt 3: their mean points along
    # (1, 1 - sqrt 3, 1 - sqrt 3). Half a step from the corner to the origin is behind it, half a step outwards is not.
    normal = np.array([1, 1 - 3**0.5, 1 - 3**0.5]) / np.linalg.norm([1, 1 - 3**0.5, 1 - 3**0.5])
    garment = np.array([[[0.9, 0, 0], [1.1, 0, 0], CORNERS[1] + 0.01 * normal, CORNERS[1] - 0.01 * normal]], np.float32)
    body = CORNERS[None]
    assert inside_vertices(garment, body, FACES).tolist() == [[True, False, False, True]]
    assert interpenetration(inside_vertices(garment, body, FACES)) == 50.0


def test_interpenetration_is_the_mean_over_frames():
    garment = np.array([[[0.9, 0, 0]], [[1.1, 0, 0]], [[1.2, 0, 0]], [[1.3, 0, 0]]], np.float32)
    assert interpenetration(inside_vertices(garment, np.repeat(CORNERS[None], 4, axis=0), FACES)) == 25.0


def test_surface_and_tangent_plane_differ_at_a_sharp_corner():
    """What the notes say: just outside the slanted face, but behind the tangent plane of its nearest corner x."""
    outside, inside = np.array([[[0.81, 0.11, 0.11]]], np.float32), np.array([[[0.79, 0.09, 0.09]]], np.float32)
    assert inside_vertices(outside, CORNERS[None], FACES)[0, 0]
    assert signed_distances(outside, CORNERS[None], FACES)[0, 0] == pytest.approx(0.03 / 3**0.5, abs=1e-6)
    assert signed_distances(inside, CORNERS[None], FACES)[0, 0] == pytest.approx(-0.03 / 3**0.5, abs=1e-6)


@pytest.mark.parametrize(
    ("point", "distance"),
    [
        ((0.2, 0.2, -0.1), 0.1),  # below the floor
        ((0.2, 0.2, 0.05), -0.05),  # above it
        ((-0.3, -0.4, 0.2), 0.5),  # beside the edge along z
        ((0, 0, 3), 2.0),  # above the corner z
        ((-1, -2, -2), 3.0),  # from the corner at the origin
    ],
)
def test_signed_distance_to_faces_edges_and_corners(point, distance):
    garment = np.array([[point]], np.float32)
    assert signed_distances(garment, CORNERS[None], FACES)[0, 0] == pytest.approx(distance, abs=1e-6)


def test_signed_distance_follows_the_body():
    body = np.stack([CORNERS, CORNERS + 10, 2 * CORNERS])
    garment = np.repeat(np.array([[[0.2, 0.2, -0.1], [10.2, 10.2, 10.05]]], np.float32), 3, axis=0)
    distances = signed_distances(garment, body, FACES)
    assert distances[0, 0] == pytest.approx(0.1, abs=1e-6)
    assert distances[1, 1] == pytest.approx(-0.05, abs=1e-5)
    assert distances[2, 0] == pytest.approx(0.1, abs=1e-6)


def test_share_and_depth_of_what_is_inside():
    distances = np.array([[-0.001, 0.5, -0.003], [0.1, 0.0, 0.2]], np.float32)
    assert interpenetration_strict(distances) == pytest.approx(100 * 2 / 6)
    assert depth_p95(distances) == pytest.approx(1 + 0.95 * 2)  # between 1 and 3 mm
    assert depth_p95(np.abs(distances)) == 0.0


def test_strain_is_the_mean_over_frames_of_the_95th_percentile():
    rest = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
    faces = np.array([[0, 1, 2]], np.int32)
    stretched = np.array([1.2, 1, 1], np.float32) * rest  # edges: 20 %, 0 % and sqrt(1.44 + 1) / sqrt 2 - 1
    diagonal = 100 * ((2.44 / 2) ** 0.5 - 1)
    p95 = diagonal + 0.9 * (20 - diagonal)
    edges = unique_edges(faces)
    lengths = edge_lengths(rest, edges)
    assert strain_p95(np.stack([rest, stretched]), edges, lengths) == pytest.approx(p95 / 2, rel=1e-5)
    assert strain_p95((0.9 * rest)[None], edges, lengths) == pytest.approx(10, rel=1e-5)


def test_strain_leaves_edges_of_no_length_out():
    rest = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 0]], np.float32)
    edges = np.array([[0, 1], [0, 2], [1, 2]])
    assert strain_p95(2 * rest[None], edges, edge_lengths(rest, edges)) == pytest.approx(100)


def test_jitter_is_acceleration_that_the_reference_lacks():
    t = np.arange(5)[:, None, None] / 30
    still = np.zeros((5, 2, 3))
    falling = still + 0.5 * np.array([0, 0, -9.81]) * t**2
    assert jitter(falling, still, 30.0) == pytest.approx(9.81)
    assert jitter(still, falling, 30.0) == 0.0
    assert jitter(falling, falling, 30.0) == 0.0
    one = still.copy()
    one[:, 0] = 2 * falling[:, 0]
    assert jitter(one, falling, 30.0) == pytest.approx(9.81 / 2)  # one of two vertices, 9.81 too much
    assert np.isnan(jitter(still[:2], still[:2], 30.0))


def test_vertex_areas_sum_to_the_area():
    rest = np.array([[0, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0]], np.float32)
    areas = vertex_areas(rest, np.array([[0, 1, 2], [1, 3, 2]]))
    np.testing.assert_allclose(areas, [1 / 3, 2 / 3, 2 / 3, 1 / 3])


def test_liveliness_is_the_ratio_of_energies_relative_to_the_body():
    rest = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
    faces = np.array([[0, 1, 2]])
    t = np.arange(4, dtype=np.float32)[:, None, None]
    walk, sway = t * np.float32([1, 0, 0]), t * np.float32([0, 0, 0.1])
    body, mass = rest + walk, vertex_areas(rest, faces)

    def lively(predicted, reference, body=body):
        return liveliness(predicted, reference, None if body is None else near_displacements(reference, body), mass)

    assert lively(rest + walk + sway, rest + walk + sway) == pytest.approx(1.0)
    assert lively(rest + walk + 0.5 * sway, rest + walk + sway) == pytest.approx(0.25, rel=1e-4)
    assert lively(rest + walk, rest + walk + sway) == 0.0
    assert lively(rest + 2 * sway, rest + sway, body=None) == pytest.approx(4.0, rel=1e-4)
    assert np.isnan(lively(rest + walk, rest + walk))


def test_near_displacements_are_those_of_the_nearest_vertex():
    body = np.array([[[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [1, 0, 2]]], np.float32)
    garment = np.array([[[0.1, 0, 0], [0.9, 0, 0]], [[0.1, 0, 0], [0.9, 0, 2]]], np.float32)
    np.testing.assert_array_equal(near_displacements(garment, body), [[[0, 0, 0], [0, 0, 2]]])


def test_skill():
    assert skill(1.0, 4.0) == 0.75
    assert skill(4.0, 4.0) == 0.0
    assert skill(8.0, 4.0) == -1.0
    assert np.isnan(skill(1.0, 0.0))


def test_stable_frames():
    error = np.ones(200)
    assert stable_frames(error) == 200
    error[120] = 4.0
    assert stable_frames(error) == 200  # not passed
    error[130] = 4.1
    assert stable_frames(error) == 130
    error[90:] = np.nan
    assert stable_frames(error) == 90
    assert stable_frames(np.full(10, np.nan)) == 0
    short = np.array([1.0, 1.0, 9.0])
    assert stable_frames(short) == 2


def test_stable_frames_goes_by_the_first_50_only():
    error = np.concatenate([np.ones(50), np.full(500, 5.0)])
    assert stable_frames(error) == 50


def times(ms, processor_ms=None):
    """All times of a roll-out, and those that were taken under load."""
    positions = np.zeros((len(ms), 1, 3), np.float32)
    motion = Motion(positions, positions, None, None, ms=ms, processor_ms=processor_ms)
    return scores(motion, *TIMES), {m.name for m in TIMES if under_load(motion, m)}


def test_time_per_frame():
    ms = np.array([[np.nan] * 3, [1, 10, 0], [2, 20, 0], [3, 30, 6]])
    values, _ = times(ms)
    assert (values["ms_prepare"], values["ms_predict"], values["ms_collide"]) == (2, 20, 0)
    assert values["ms_per_frame"] == 22 and values["ms_per_frame_p95"] == pytest.approx(22 + 0.9 * 17)
    assert all(np.isnan(v) for v in times(ms[:1])[0].values())
    assert "ms_processor" not in values
    assert times(ms, np.array([np.nan, 10.0, 21, 30]))[0]["ms_processor"] == 21


@pytest.mark.parametrize(
    ("wall", "processor", "marked"),
    [
        (13.0, 12.0, set()),
        (141.0, 13.0, {"ms_per_frame", "ms_per_frame_p95", "ms_prepare", "ms_predict", "ms_collide"}),
        (0.06, 0.02, set()),  # within the clocks' own noise
        (13.0, 30.0, set()),  # several threads
        (13.0, np.nan, set()),
    ],
)
def test_wall_time_far_above_processor_time_is_marked(wall, processor, marked):
    ms = np.zeros((20, 3))
    ms[:, 1] = wall
    assert times(ms, np.full(20, processor))[1] == marked


def test_a_few_slow_frames_spoil_the_95th_percentile_only():
    ms = np.zeros((20, 3))
    ms[:, 1] = [10.0] * 17 + [90.0] * 3
    assert times(ms, np.full(20, 10.0))[1] == {"ms_per_frame_p95"}
    assert times(ms, np.full(20, 10.0))[0]["ms_per_frame"] == 10


def test_strain_of_a_simulation():
    assert strain_mean(np.array([0.01, 0.03, np.nan])) == pytest.approx(2.0)
    assert strain_p99_max(np.array([0.1, 0.3, np.nan])) == pytest.approx(30.0)
