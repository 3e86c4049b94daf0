"""Overlapping triangles of a plane: areas by hand, and the fast way against a plain one."""

import numpy as np
import pytest

from garmentbench.importing.mesh_doctor import overlap
from garmentbench.importing.mesh_doctor.overlap import overlaps

HALF = np.array([[0, 0], [1, 0], [0, 1.0]])  # half of the unit square


def test_areas_by_hand():
    star = np.array([[[0, 0], [3, 0], [1.5, 3]], [[0, 2], [1.5, -1], [3, 2.0]]])  # a six-pointed star
    found = overlaps(star)
    assert found.pairs.tolist() == [[0, 1]] and found.complete
    assert found.area[0] == pytest.approx(4.5 - 3 * 0.5)  # less three points of base 1 and height 1
    half_over = overlaps(np.stack([HALF, HALF + [0.5, 0]]))
    assert half_over.area.tolist() == pytest.approx([0.125])
    within = overlaps(np.stack([HALF, HALF * 0.2 + 0.1]))
    assert within.area.tolist() == pytest.approx([0.02])
    same = overlaps(np.stack([HALF, HALF, HALF[::-1]]))
    assert same.pairs.tolist() == [[0, 1], [0, 2], [1, 2]] and same.area.tolist() == pytest.approx([0.5] * 3)


def test_what_only_touches_does_not_overlap():
    neighbours = [HALF, [[1, 0], [1, 1], [0, 1]], HALF + [1, 0], HALF - [0, 1], [[0, 1], [-1, 1], [0, 0]]]
    flat = [[[0, 0], [1, 1], [0.5, 0.5]], [[0.2, 0.2]] * 3]
    assert len(overlaps(np.array([*neighbours, *flat], float)).pairs) == 0
    assert len(overlaps(np.zeros((0, 3, 2))).pairs) == 0


def test_a_fold_along_a_common_edge_overlaps():
    folded = np.stack([HALF, [[1, 0], [0.2, 0.2], [0, 1]]])
    assert overlaps(folded).area[0] == pytest.approx(0.5 * 0.6)


def plain(a: np.ndarray, b: np.ndarray) -> float:
    """Area common to two triangles, by clipping one with the sides of the other (Sutherland and Hodgman)."""
    cross = lambda u, v: u[0] * v[1] - u[1] * v[0]  # noqa: E731
    a, b = (t if cross(t[1] - t[0], t[2] - t[0]) > 0 else t[::-1] for t in (a, b))
    polygon = list(a)
    for start, end in zip(b, np.roll(b, -1, axis=0), strict=True):
        left = [cross(end - start, p - start) for p in polygon]
        clipped = []
        for i, (p, q) in enumerate(zip(polygon, polygon[1:] + polygon[:1], strict=True)):
            s, t = left[i], left[(i + 1) % len(left)]
            clipped += [p] * bool(s >= 0) + [p + s / (s - t) * (q - p)] * bool((s >= 0) != (t >= 0))
        polygon = clipped
    return sum(cross(p, q) for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True)) / 2 if polygon else 0.0


def test_fast_equals_plain(monkeypatch):
    random = np.random.default_rng(3)
    triangles = random.random((60, 1, 2)) + random.random((60, 1, 1)) * random.normal(size=(60, 3, 2)) * 0.4
    expected = {(i, j): plain(triangles[i], triangles[j]) for i in range(60) for j in range(i + 1, 60)}
    expected = {pair: area for pair, area in expected.items() if area > 1e-5}
    for chunk in (7, 1_000_000):
        monkeypatch.setattr(overlap, "_CHUNK", chunk)
        found = overlaps(triangles)
        areas = {tuple(pair): area for pair, area in zip(found.pairs.tolist(), found.area, strict=True) if area > 1e-5}
        assert list(areas) == sorted(expected) and areas == pytest.approx(expected, rel=1e-9)


def test_a_regular_grid_has_none_and_a_shift_of_half_is_area_for_area():
    x, y = np.meshgrid(np.arange(30), np.arange(30))
    corner = np.stack([x, y], axis=-1).reshape(-1, 1, 2).astype(np.float32) / 31
    grid = np.concatenate([corner + HALF.astype(np.float32) / 31, corner + (1 - HALF.astype(np.float32)) / 31])
    assert len(overlaps(grid).pairs) == 0
    both = np.concatenate([grid, grid + np.float32([0.5, 0])])
    assert overlaps(both).area.sum() == pytest.approx(30 * 14.5 / 31**2, rel=1e-5)


def test_a_pile_ends_early_and_says_so(monkeypatch):
    monkeypatch.setattr(overlap, "_MOST_PAIRS", 100)
    monkeypatch.setattr(overlap, "_CHUNK", 50)
    found = overlaps(np.repeat(HALF[None], 60, axis=0))
    assert not found.complete and len(found.pairs) == 100


def test_twenty_thousand_times_the_same_triangle_end_soon():
    import time

    start = time.process_time()
    assert not overlaps(np.repeat(HALF[None], 20_000, axis=0)).complete
    assert time.process_time() - start < 5
