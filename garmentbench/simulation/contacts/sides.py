"""Narrow phase: which candidates touch until the next query, where, and on which side of each other they are.

A particle is on one side of a face, an edge on one side of another; the side is kept while the two stay near, so
that what gets through is brought back. A pair that is new, and passed through itself since the last query, is on the
side where it was then.
"""

import warp as wp

from garmentbench.simulation.contacts.candidates import PLACES, Candidates
from garmentbench.simulation.contacts.constraints import CORNER, EDGES, PLANE, Constraints
from garmentbench.simulation.contacts.geometry import (
    across,
    face_normal,
    has,
    nearest_on_edges,
    nearest_on_face,
    over_edge,
    over_face,
)
from garmentbench.simulation.kernels import Cloth

MARGIN = wp.constant(0.002)  # [m] beyond the gap and the way: what is farther is not in the list
HASTE = wp.constant(2.0)  # times the way at the present speed until the next query is looked at
PARALLEL = wp.constant(0.05)  # sine of the angle between two edges below which they have no side
ABOVE = wp.constant(0.7)  # share of its distance along the normal by which a particle beside a face is above it


@wp.struct
class Narrow:
    """What was found of each place: P particles, E edges as owners."""

    old: wp.array[wp.vec3]  # positions at the last query [m]
    rim: wp.array[wp.vec3i]  # of each face: 1 where the edge opposite to a corner is the cloth's border
    kind: wp.array[int]  # of contact; 0: none
    weight: wp.array[wp.vec3]  # of the face's corners; of edges, where on the owner and on the other
    normal: wp.array[wp.vec3]  # from the other to the owner


@wp.func
def sign_of(value: float) -> float:
    """1 or -1."""
    return wp.where(value < 0.0, -1.0, 1.0)


@wp.func
def neighbours_side(n: Candidates, owner: int, slot: int, f: wp.vec3i) -> float:
    """The side of a particle over the faces that share a corner with f; 0 if none is known."""
    side = float(0.0)
    for k in range(n.number[owner]):
        t = owner * PLACES + k
        g = n.faces[n.other[t]]
        if t != slot and n.side[t] != 0.0 and (has(g, f[0]) or has(g, f[1]) or has(g, f[2])):
            side = n.side[t]
    return side


@wp.func
def at_rim(rim: wp.vec3i, w: wp.vec3) -> bool:
    """Is a point of a face, given by its weights, on the cloth's border?"""
    return (w[0] == 0.0 and rim[0] == 1) or (w[1] == 0.0 and rim[1] == 1) or (w[2] == 0.0 and rim[2] == 1)


@wp.func
def near_enough(n: Candidates, slot: int, apart: float, closing: float, interval: float) -> bool:
    """May a pair touch before the next query?"""
    return apart - n.gap[slot] < MARGIN + HASTE * interval * wp.max(closing, 0.0)


@wp.func
def meet_face(n: Candidates, r: Narrow, c: Cloth, i: int, slot: int, interval: float):
    """Particle i and the face of one of its places."""
    j = n.other[slot]
    f = n.faces[j]
    w = nearest_on_face(c.x, i, f)
    away = over_face(c.x, i, f, w)
    distance = wp.length(away)
    up = face_normal(c.x, f)
    height = wp.dot(away, up)
    side = n.side[slot]
    inside = wp.min(wp.min(w[0], w[1]), w[2]) > 0.0
    normal = away / wp.max(distance, 1.0e-9)
    apart = distance
    live = bool(True)
    if inside:
        if side == 0.0:
            side = neighbours_side(n, i, slot, f)
        if side == 0.0:
            before = wp.dot(over_face(r.old, i, f, w), face_normal(r.old, f))
            side = sign_of(wp.where(before == 0.0, height, before))
        normal = side * up
        apart = side * height
    elif height * side < 0.0:
        if at_rim(r.rim[j], w):
            side = 0.0  # round the border is a way to the other side
        else:
            live = False
    elif side == 0.0 and wp.abs(height) > ABOVE * distance:
        side = sign_of(height)
    n.side[slot] = side
    closing = -wp.dot(over_face(c.v, i, f, w), normal)
    if live and distance > 0.0 and near_enough(n, slot, apart, closing, interval):
        r.kind[slot] = wp.where(inside, PLANE, CORNER)
        r.weight[slot] = w
        r.normal[slot] = normal


@wp.func
def meet_edge(n: Candidates, r: Narrow, c: Cloth, d: int, slot: int, interval: float):
    """Edge d and the edge of one of its places. Their ends are met as particles."""
    a = n.edges[d]
    b = n.edges[n.other[slot]]
    q = nearest_on_edges(c.x, a, b)
    up = across(c.x, a, b)
    side = float(0.0)
    if wp.min(q[0], q[1]) > 0.0 and wp.max(q[0], q[1]) < 1.0 and wp.length(up) > PARALLEL:
        up = wp.normalize(up)
        height = wp.dot(over_edge(c.x, a, b, q[0], q[1]), up)
        side = n.side[slot]
        if side == 0.0:
            then = across(r.old, a, b)
            before = wp.dot(over_edge(r.old, a, b, q[0], q[1]), then)
            if wp.dot(then, up) < 0.5 * PARALLEL or before == 0.0:
                before = height
            side = sign_of(before)
        closing = -side * wp.dot(over_edge(c.v, a, b, q[0], q[1]), up)
        if near_enough(n, slot, side * height, closing, interval):
            r.kind[slot] = EDGES
            r.weight[slot] = wp.vec3(q[0], q[1], 0.0)
            r.normal[slot] = side * up
    n.side[slot] = side


@wp.func
def over_neighbour(n: Candidates, r: Narrow, owner: int, slot: int) -> bool:
    """Is a particle that is beside a face over one that shares a corner with it? Then that one holds it off."""
    found = bool(False)
    f = n.faces[n.other[slot]]
    for k in range(n.number[owner]):
        t = owner * PLACES + k
        g = n.faces[n.other[t]]
        if r.kind[t] == PLANE and (has(g, f[0]) or has(g, f[1]) or has(g, f[2])):
            found = True
    return found


@wp.func
def is_caught(n: Candidates, caught: wp.array[int], o: int, slot: int) -> bool:
    """Are an owner and its place in a tangle? Then the side is not known, and contact lets go."""
    particles = caught.shape[0]
    other = n.other[slot]
    if o < particles:
        f = n.faces[other]
        found = caught[o] * (caught[f[0]] + caught[f[1]] + caught[f[2]])
    else:
        a = n.edges[o - particles]
        b = n.edges[other]
        found = (caught[a[0]] + caught[a[1]]) * (caught[b[0]] + caught[b[1]])
    return found > 0


@wp.kernel(enable_backward=False)
def meet(n: Candidates, r: Narrow, c: Cloth, caught: wp.array[int], found: wp.array[int], interval: float):
    """Which places of each owner touch before `interval` seconds are over: dim = P + E."""
    o = wp.tid()
    particles = c.x.shape[0]
    for k in range(n.number[o]):
        slot = o * PLACES + k
        r.kind[slot] = 0
        if is_caught(n, caught, o, slot):
            n.side[slot] = 0.0
        elif o < particles:
            meet_face(n, r, c, o, slot, interval)
        else:
            meet_edge(n, r, c, o - particles, slot, interval)
    count = int(0)
    for k in range(n.number[o]):
        slot = o * PLACES + k
        if r.kind[slot] == CORNER and over_neighbour(n, r, o, slot):
            r.kind[slot] = 0
        count += wp.min(r.kind[slot], 1)
    found[o] = count


@wp.kernel(enable_backward=False)
def write_pairs(n: Candidates, r: Narrow, c: Cloth, first: wp.array[int], k: Constraints):
    """The list's entries of each owner: dim = P + E."""
    o = wp.tid()
    particles = c.x.shape[0]
    j = first[o]
    if o < particles:
        r.old[o] = c.x[o]
    for m in range(n.number[o]):
        slot = o * PLACES + m
        if r.kind[slot] > 0 and j < k.index.shape[0]:
            w = r.weight[slot]
            if o < particles:
                f = n.faces[n.other[slot]]
                k.index[j] = wp.vec4i(o, f[0], f[1], f[2])
                k.weight[j] = wp.vec4(1.0, -w[0], -w[1], -w[2])
            else:
                a = n.edges[o - particles]
                b = n.edges[n.other[slot]]
                k.index[j] = wp.vec4i(a[0], a[1], b[0], b[1])
                k.weight[j] = wp.vec4(1.0 - w[0], w[0], w[1] - 1.0, -w[1])
            k.kind[j] = r.kind[slot]
            k.side[j] = n.side[slot]
            k.normal[j] = r.normal[slot]
            k.gap[j] = n.gap[slot]
            k.point[j] = wp.vec3(0.0)
            k.velocity[j] = wp.vec3(0.0)
            j += 1
