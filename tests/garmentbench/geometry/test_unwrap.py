"""Unwrapping keeps vertices and faces where they were, and makes charts without overlap or stretch."""

import sys

import numpy as np
import pytest

from garmentbench.errors import UserError
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.geometry.unwrap import unwrap
from garmentbench.geometry.uvmap import chart

BODY = tiny_sequence(1).template.body  # closed, so it has to be cut


def test_without_xatlas_it_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "xatlas", None)
    with pytest.raises(UserError, match="pip install xatlas"):
        unwrap(BODY.rest, BODY.faces)


@pytest.fixture(scope="module")
def made():
    pytest.importorskip("xatlas", reason="xatlas is an extra")
    return unwrap(BODY.rest, BODY.faces)


def test_vertices_and_faces_keep_their_numbers(made):
    count = len(BODY.rest)
    assert made.source[:count].tolist() == list(range(count)) and len(made.source) > count
    np.testing.assert_array_equal(made.source[made.faces], BODY.faces)


def test_seams_join_each_copy_with_its_original(made):
    copies = np.arange(len(BODY.rest), len(made.source))
    np.testing.assert_array_equal(made.seams[:, 1], copies)
    np.testing.assert_array_equal(made.source[made.seams[:, 0]], made.source[made.seams[:, 1]])


def test_charts_fill_the_square_once(made):
    assert made.uv.min() >= 0 and made.uv.max() <= 1
    a, b, c = made.uv[made.faces].astype(np.float64).transpose(1, 2, 0)
    area = np.abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).sum() / 2
    assert area > 0.4
    assert len(chart(made.uv, made.faces, 512).pixels) / 512**2 == pytest.approx(area, abs=0.01)  # no overlap


def test_units_do_not_matter(made):
    again = unwrap(1024 * BODY.rest, BODY.faces)  # a power of two: the same digits
    np.testing.assert_array_equal(again.uv, made.uv)


def test_a_vertex_without_a_face_is_kept(made):
    more = unwrap(np.concatenate([BODY.rest, [[0, 0, 9.0]]]), BODY.faces)
    assert more.uv[len(BODY.rest)].tolist() == [0, 0]
    np.testing.assert_array_equal(more.source[more.faces], BODY.faces)
