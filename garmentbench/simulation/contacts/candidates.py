"""Broad phase: which particles and faces, and which pairs of edges, may touch until it is run again.

Each face looks in a tree of boxes for the others that it may meet, and tests the particles and edges that it owns
against theirs. A particle or edge keeps the nearest few.
"""

import numpy as np
import warp as wp

from garmentbench.simulation.contacts.geometry import has, nearest_on_edges, nearest_on_face, over_edge, over_face
from garmentbench.simulation.kernels import Cloth, Physics

PLACES = wp.constant(8)  # candidates that a particle or an edge keeps
# [m] What is farther than this, the gap and the way at the present speed is not looked at until the next time.
SLACK = wp.constant(0.004)
REST_SHARE = wp.constant(0.5)  # of its distance at rest is all that cloth is kept apart: it may lie close by its cut
SAMPLE = wp.constant(32)  # particles whose mean velocity is the garment's


@wp.struct
class Candidates:
    """P particles, F faces, E edges. Owners: the particles, then the edges; `PLACES` places each."""

    faces: wp.array[wp.vec3i]
    edges: wp.array[wp.vec2i]
    own_particles: wp.array[wp.vec3i]  # of each face; -1: another face's
    own_edges: wp.array[wp.vec3i]
    rest: wp.array[wp.vec3]  # positions at rest [m]
    lower: wp.array[wp.vec3]  # boxes of the faces and of the way that they go [m]
    upper: wp.array[wp.vec3]
    drift: wp.array[wp.vec3]  # shape (1,): mean velocity [m/s]
    number: wp.array[int]  # of each owner
    other: wp.array[int]  # face or edge
    gap: wp.array[float]  # that is kept [m]
    room: wp.array[float]  # what is left of the distance beyond the gap [m]
    side: wp.array[float]  # on which the owner is, 1 or -1; 0: not known
    last_number: wp.array[int]  # the same three, before
    last_other: wp.array[int]
    last_side: wp.array[float]


@wp.func
def enter(n: Candidates, owner: int, other: int, gap: float, room: float):
    """Keep a candidate if there is a place, or in place of the farthest; with the side that is known of it."""
    place = n.number[owner]
    if place < PLACES:
        n.number[owner] = place + 1
    else:
        place = int(0)
        for k in range(1, PLACES):
            if n.room[owner * PLACES + k] > n.room[owner * PLACES + place]:
                place = k
        if n.room[owner * PLACES + place] <= room:
            return
    slot = owner * PLACES + place
    n.other[slot] = other
    n.gap[slot] = gap
    n.room[slot] = room
    n.side[slot] = 0.0
    for k in range(n.last_number[owner]):
        if n.last_other[owner * PLACES + k] == other:
            n.side[slot] = n.last_side[owner * PLACES + k]


@wp.func
def try_face(n: Candidates, c: Cloth, p: Physics, i: int, j: int, time: float):
    """Particle i against face j."""
    f = n.faces[j]
    w = nearest_on_face(c.x, i, f)
    away = wp.length(over_face(c.x, i, f, w))
    way = SLACK + time * wp.length(over_face(c.v, i, f, w))
    if away < p.thickness + way:
        at_rest = wp.length(over_face(n.rest, i, f, nearest_on_face(n.rest, i, f)))
        gap = wp.min(p.thickness, REST_SHARE * at_rest)
        if away - gap < way:
            enter(n, i, j, gap, away - gap)


@wp.func
def try_edge(n: Candidates, c: Cloth, p: Physics, d: int, e: int, time: float):
    """Edge d against edge e."""
    a = n.edges[d]
    b = n.edges[e]
    q = nearest_on_edges(c.x, a, b)
    way = SLACK + time * wp.length(over_edge(c.v, a, b, q[0], q[1]))
    if q[2] < p.thickness + way:
        at_rest = nearest_on_edges(n.rest, a, b)
        gap = wp.min(p.thickness, REST_SHARE * at_rest[2])
        if q[2] - gap < way:
            enter(n, c.x.shape[0] + d, e, gap, q[2] - gap)


@wp.kernel(enable_backward=False)
def take_drift(c: Cloth, n: Candidates):
    """Mean velocity of a sample of particles: dim = 1."""
    total = wp.vec3(0.0)
    for k in range(SAMPLE):
        total += c.v[k * c.x.shape[0] / SAMPLE]
    n.drift[0] = total / float(SAMPLE)


@wp.kernel(enable_backward=False)
def sweep(c: Cloth, n: Candidates, p: Physics, time: float):
    """The boxes of the faces on their way of the next `time` seconds, beside the drift: dim = F."""
    j = wp.tid()
    low = wp.vec3(1.0e9)
    high = wp.vec3(-1.0e9)
    for k in range(3):
        i = n.faces[j][k]
        x = c.x[i]
        y = x + time * (c.v[i] - n.drift[0])
        low = wp.min(low, wp.min(x, y))
        high = wp.max(high, wp.max(x, y))
    reach = 0.5 * (p.thickness + SLACK)
    n.lower[j] = low - wp.vec3(reach)
    n.upper[j] = high + wp.vec3(reach)


@wp.kernel(enable_backward=False)
def clear(n: Candidates):
    """Remember the candidates and begin anew: dim = owners."""
    o = wp.tid()
    n.last_number[o] = n.number[o]
    for k in range(n.number[o]):
        n.last_other[o * PLACES + k] = n.other[o * PLACES + k]
        n.last_side[o * PLACES + k] = n.side[o * PLACES + k]
    n.number[o] = 0


@wp.kernel(enable_backward=False)
def search(tree: wp.uint64, c: Cloth, n: Candidates, p: Physics, time: float):
    """Candidates of what each face owns, for the next `time` seconds: dim = F."""
    i = wp.tid()
    mine = n.own_particles[i]
    edges = n.own_edges[i]
    query = wp.bvh_query_aabb(tree, n.lower[i], n.upper[i])
    j = int(0)
    while wp.bvh_query_next(query, j):
        if j != i:
            f = n.faces[j]
            for k in range(3):
                if mine[k] >= 0 and not has(f, mine[k]):
                    try_face(n, c, p, mine[k], j, time)
            theirs = n.own_edges[j]
            for k in range(3):
                d = edges[k]
                if d >= 0:
                    a = n.edges[d]
                    for m in range(3):
                        e = theirs[m]
                        if e > d:
                            b = n.edges[e]
                            if a[0] != b[0] and a[0] != b[1] and a[1] != b[0] and a[1] != b[1]:
                                try_edge(n, c, p, d, e, time)


def owned(faces: np.ndarray, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Particles and edges of each face that no face before it has, shape (F, 3) each; -1: it has."""
    corners = faces.ravel()
    sides = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    number = {tuple(e): k for k, e in enumerate(np.sort(edges, axis=1).tolist())}
    side = np.array([number[tuple(s)] for s in sides.tolist()])
    return _first(corners).reshape(-1, 3), _first(side).reshape(-1, 3)


def _first(values: np.ndarray) -> np.ndarray:
    """The values, -1 in place of all but the first of each."""
    _, first = np.unique(values, return_index=True)
    out = np.full(len(values), -1, np.int32)
    out[first] = values[first]
    return out
