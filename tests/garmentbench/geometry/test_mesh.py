import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from garmentbench.geometry.mesh import (
    border_vertices,
    edge_lengths,
    face_normals,
    laplacian,
    tangent_frames,
    unique_edges,
    vertex_normals,
)

# A roof: two triangles that meet at a right angle along the y axis.
ROOF = np.array([[0, 0, 1], [0, 1, 1], [1, 0, 0], [-1, 0, 0]], float)
FACES = np.array([[0, 2, 1], [0, 1, 3]])


def test_normals_of_a_roof():
    half = np.sqrt(0.5)
    np.testing.assert_allclose(face_normals(ROOF, FACES), [[half, 0, half], [-half, 0, half]], atol=1e-12)
    expected = [[0, 0, 1], [0, 0, 1], [half, 0, half], [-half, 0, half]]
    np.testing.assert_allclose(vertex_normals(ROOF, FACES), expected, atol=1e-7)


def test_vertex_normals_average_faces_uniformly_whatever_their_size():
    tall = ROOF.copy()
    tall[2] = [5, 0, -4]  # five times as long a slope, the same direction
    np.testing.assert_allclose(vertex_normals(tall, FACES)[0], [0, 0, 1], atol=1e-7)


def test_vertex_normals_of_many_frames_at_once_turn_with_the_mesh():
    turns = Rotation.random(5, rng=0).as_matrix()
    frames = np.einsum("tij,vj->tvi", turns, ROOF)
    expected = np.einsum("tij,vj->tvi", turns, vertex_normals(ROOF, FACES))
    np.testing.assert_allclose(vertex_normals(frames, FACES), expected, atol=1e-7)


def test_edges_and_their_lengths():
    edges = unique_edges(FACES)
    assert edges.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3]]
    np.testing.assert_allclose(edge_lengths(ROOF, edges), [1, 2**0.5, 2**0.5, 3**0.5, 3**0.5])


def test_laplacian_is_the_offset_from_the_neighbours_mean():
    lap = laplacian(FACES, 5)  # vertex 4 has no edges
    np.testing.assert_allclose((lap @ np.append(ROOF[:, 0], 7.0)), [0, 0, 1, -1, 0], atol=1e-12)


@pytest.mark.parametrize("flip", [1.0, -1.0])
def test_tangent_frames_follow_u(flip):
    uv = np.stack([flip * ROOF[:, 0], ROOF[:, 1]], axis=1) * 0.4 + 0.5
    frames = tangent_frames(ROOF, FACES, uv)
    np.testing.assert_allclose(frames @ frames.transpose(0, 2, 1), np.tile(np.eye(3), (4, 1, 1)), atol=1e-7)
    np.testing.assert_allclose(np.linalg.det(frames), 1, atol=1e-7)
    np.testing.assert_allclose(frames[0], [[flip, 0, 0], [0, flip, 0], [0, 0, 1]], atol=1e-7)


def test_tangent_frames_where_the_uv_is_degenerate_are_still_frames():
    frames = tangent_frames(ROOF, FACES, np.full((4, 2), 0.5))
    np.testing.assert_allclose(np.linalg.det(frames), 1, atol=1e-7)


def test_border_vertices():
    faces = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])  # a square with its middle
    assert border_vertices(faces).tolist() == [0, 1, 2, 3]
    assert border_vertices(np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])).tolist() == []
