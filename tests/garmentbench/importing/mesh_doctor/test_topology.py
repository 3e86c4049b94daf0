"""How faces meet, on meshes small enough to count by hand."""

import numpy as np

from garmentbench.importing.mesh_doctor.coincident import coincident
from garmentbench.importing.mesh_doctor.topology import borders, components, doubles, sides, torn_points, winding

SQUARE = np.array([[0, 1, 2], [0, 2, 3]])
BOOK = np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]])  # three pages on the spine 0-1


def test_sides_of_a_square():
    found = sides(SQUARE)
    assert found.edges.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]
    assert found.count.tolist() == [1, 2, 1, 1, 1]
    assert found.edge.tolist() == [[0, 3, 1], [1, 4, 2]]
    assert found.forward.tolist() == [[True, True, False], [True, True, False]]
    assert found.joined.tolist() == [[2, 3]]


def test_a_face_that_names_a_point_twice_takes_no_part():
    found = sides(np.concatenate([SQUARE, [[2, 2, 0]]]))
    assert found.edge[2].tolist() == [-1, -1, -1] and found.count.tolist() == [1, 2, 1, 1, 1]


def test_an_edge_of_three_faces_joins_none():
    found = sides(BOOK)
    assert found.count.max() == 3 and len(found.joined) == 0
    assert winding(found).patch.tolist() == [0, 1, 2]


def test_the_fewer_faces_are_turned():
    fan = np.array([[0, k, k + 1] for k in range(1, 6)])
    for wrong in ([], [2], [0, 4]):
        faces = fan.copy()
        faces[wrong] = faces[wrong][:, ::-1]
        assert np.flatnonzero(winding(sides(faces)).turned).tolist() == wrong


def test_a_moebius_strip_is_one_sided_and_a_ring_is_not():
    ring = np.array([[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4], [2, 0, 5], [0, 3, 5]])
    twisted = np.concatenate([ring[:4], [[2, 3, 5], [3, 0, 5]]])
    assert winding(sides(ring)).one_sided.tolist() == []
    way = winding(sides(twisted))
    assert way.one_sided.tolist() == [0] and not way.turned.any()


def test_points_where_fans_touch():
    bow_tie = np.array([[0, 1, 2], [0, 3, 4]])
    assert torn_points(bow_tie, sides(bow_tie), 5).tolist() == [0]
    assert torn_points(SQUARE, sides(SQUARE), 4).tolist() == []
    assert torn_points(BOOK, sides(BOOK), 5).tolist() == []  # its spine is told of as an edge
    closed = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    tip_to_tip = np.concatenate([closed, np.array([[3, 5, 4], [3, 4, 6], [4, 5, 6], [5, 3, 6]])])
    assert torn_points(tip_to_tip, sides(tip_to_tip), 7).tolist() == [3]
    flipped = closed.copy()
    flipped[1] = flipped[1, ::-1]
    assert torn_points(flipped, sides(flipped), 4).tolist() == []


def test_border_loops():
    two = np.concatenate([SQUARE, SQUARE + 4])
    edges, loop = borders(sides(two), 8)
    assert edges.tolist() == [[0, 1], [0, 3], [1, 2], [2, 3], [4, 5], [4, 7], [5, 6], [6, 7]]
    assert loop.tolist() == [0, 0, 0, 0, 1, 1, 1, 1]


def test_doubles_whatever_their_order():
    assert doubles(np.array([[0, 1, 2], [2, 1, 3], [1, 2, 0], [2, 1, 0]])).tolist() == [2, 3]


def test_components():
    assert components(5, np.array([[0, 3], [3, 4]])).tolist() == [0, 1, 2, 0, 0]


def test_coincident_points_and_piles_of_them():
    points = np.array([[0, 0, 0], [1, 0, 0], [1e-6, 0, 0], [1.9e-6, 0, 0], [1, 0, 2e-6]])
    assert coincident(points, 1e-6 * 1.01).tolist() == [0, 1, 0, 0, 2]
    pile = np.concatenate([np.zeros((30_000, 3)), [[1, 1, 1]]])
    assert coincident(pile, 1e-6).tolist() == [0] * 30_000 + [1]
