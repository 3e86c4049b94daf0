"""How the faces of a mesh meet: edges, winding, fans, pieces and border loops, whatever is wrong with the mesh.

Faces are given by their corners, indices of points, shape (F, 3). A face that names a point twice takes no part.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components


@dataclass(frozen=True)
class Sides:
    """The three sides of each face (from corner k to corner k + 1), and the edges E that they lie on.

    Attributes:
        edges: Point pairs, lower first, sorted, shape (E, 2).
        edge: Edge of each side, shape (F, 3); -1 for the sides of a face that names a point twice.
        forward: Does the side run from the lower point to the higher? Shape (F, 3).
        count: Number of faces at each edge, shape (E,).
        border: Is the side on an edge of one face? Shape (F, 3).
        joined: Pairs of sides, as 3 * face + k, that share an edge of exactly two faces, shape (J, 2).
    """

    edges: np.ndarray
    edge: np.ndarray
    forward: np.ndarray
    count: np.ndarray
    border: np.ndarray
    joined: np.ndarray


def sides(corners: np.ndarray) -> Sides:
    """The sides of faces, shape (F, 3)."""
    start, end = corners, np.roll(corners, -1, axis=1)
    whole = np.repeat(~repeats_a_corner(corners)[:, None], 3, axis=1)
    pairs = np.sort(np.stack([start[whole], end[whole]], axis=1), axis=1)
    edges, index, count = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
    edge, border = np.full(corners.shape, -1), np.zeros(corners.shape, bool)
    edge[whole], border[whole] = index.ravel(), count[index.ravel()] == 1
    order = np.flatnonzero(whole.ravel())[np.argsort(index.ravel(), kind="stable")]
    first = (np.cumsum(count) - count)[count == 2]
    joined = np.stack([order[first], order[first + 1]], axis=1)
    return Sides(edges, edge, start < end, count, border, joined)


def repeats_a_corner(corners: np.ndarray) -> np.ndarray:
    """Which faces name a point twice, shape (F,), bool."""
    return (corners == np.roll(corners, 1, axis=1)).any(axis=1)


def doubles(corners: np.ndarray) -> np.ndarray:
    """Faces that have the same three corners as an earlier one, in whatever order, shape (D,)."""
    _, first = np.unique(np.sort(corners, axis=1), axis=0, return_index=True)
    return np.setdiff1d(np.arange(len(corners)), first)


def components(count: int, pairs: np.ndarray) -> np.ndarray:
    """Component of each of `count` nodes that `pairs`, shape (N, 2), join; numbered from 0, shape (count,)."""
    graph = sp.coo_matrix((np.ones(len(pairs), bool), pairs.T), shape=(count, count))
    return connected_components(graph, directed=False)[1]


@dataclass(frozen=True)
class Winding:
    """Which faces to turn so that neighbours agree.

    Attributes:
        patch: Patch of each face, shape (F,): faces joined across edges of exactly two faces.
        turned: Faces that run against most of their patch's, shape (F,), bool.
        one_sided: Patches that no turning of faces makes consistent (Moebius strips), shape (M,).
    """

    patch: np.ndarray
    turned: np.ndarray
    one_sided: np.ndarray


def winding(found: Sides) -> Winding:
    """Whether neighbours agree which way round they run.

    Each face is two nodes, itself and itself turned; nodes that agree across an edge are joined. A patch whose faces
    can agree falls into two components, one the mirror of the other; a one-sided patch stays in one.
    """
    count = len(found.edge)
    face = found.joined // 3
    against = found.forward.ravel()[found.joined[:, 0]] == found.forward.ravel()[found.joined[:, 1]]
    a, b = face.T
    other = b + np.where(against, count, 0)
    mirrored = np.where(against, b, b + count)
    side = components(2 * count, np.concatenate([np.stack([a, other], 1), np.stack([a + count, mirrored], 1)]))
    patch = components(count, face)
    one_sided = np.unique(patch[side[:count] == side[count:]])
    first = np.unique(patch, return_index=True)[1]
    with_first = side[:count] == side[first][patch]
    most = np.bincount(patch, with_first) * 2 >= np.bincount(patch)
    turned = with_first != most[patch]
    turned[np.isin(patch, one_sided)] = False
    return Winding(patch, turned, one_sided)


def torn_points(corners: np.ndarray, found: Sides, count: int) -> np.ndarray:
    """Points where faces meet that share no edge there: more than one fan of faces, shape (T,)."""
    first, second = found.joined.T
    same_way = found.forward.ravel()[first] == found.forward.ravel()[second]
    (f, i), (g, j) = np.divmod(first, 3), np.divmod(second, 3)
    next_i, next_j = 3 * f + (i + 1) % 3, 3 * g + (j + 1) % 3
    start = np.stack([first, np.where(same_way, second, next_j)], axis=1)
    end = np.stack([next_i, np.where(same_way, next_j, second)], axis=1)
    fan = components(corners.size, np.concatenate([start, end]))
    whole = np.repeat(found.edge[:, 0] >= 0, 3)
    fans = np.unique(np.stack([corners.ravel()[whole], fan[whole]], axis=1), axis=0)
    ends_of_bad_edges = found.edges[found.count > 2]
    return np.setdiff1d(np.flatnonzero(np.bincount(fans[:, 0], minlength=count) > 1), ends_of_bad_edges)


def borders(found: Sides, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Border edges, shape (B, 2), and the loop that each lies on, numbered from 0, shape (B,)."""
    edges = found.edges[found.count == 1]
    label = components(count, edges)[edges[:, 0]]
    return edges, np.unique(label, return_inverse=True)[1].ravel()
