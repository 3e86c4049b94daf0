"""Normals for shading: smooth over a gentle bend and over a seam, apart over a crease."""

import numpy as np
import pytest

from garmentbench.geometry.mesh import face_normals
from garmentbench.viewing.shading import SMOOTH, corner_normals


def bent(degrees: float) -> tuple[np.ndarray, np.ndarray]:
    """Two triangles with the edge from (0, 0, 0) to (0, 1, 0) in common, bent there."""
    a = np.radians(degrees)
    points = np.array([[0, 0, 0], [0, 1, 0], [-1, 0.5, 0], [np.cos(a), 0.5, -np.sin(a)]])
    return points, np.array([[0, 1, 2], [1, 0, 3]])


@pytest.mark.parametrize(("degrees", "crease", "apart"), [(20, 40, False), (80, 40, True), (80, SMOOTH, False)])
def test_faces_share_a_normal_unless_the_bend_is_a_crease(degrees, crease, apart):
    points, faces = bent(degrees)
    own = face_normals(points, faces)
    normals = corner_normals(points, faces, crease)
    mean = own.sum(axis=0) / np.linalg.norm(own.sum(axis=0))
    np.testing.assert_allclose(normals[0, 2], own[0], atol=1e-12)
    np.testing.assert_allclose(normals[0, :2], np.tile(own[0] if apart else mean, (2, 1)), atol=1e-12)
    np.testing.assert_allclose(normals[1, :2], np.tile(own[1] if apart else mean, (2, 1)), atol=1e-12)


def test_both_copies_of_a_seam_s_point_are_shaded_alike():
    points, faces = bent(20)
    split, split_faces = np.concatenate([points, points[:2]]), np.array([[0, 1, 2], [5, 4, 3]])
    np.testing.assert_array_equal(corner_normals(split, split_faces), corner_normals(points, faces))
