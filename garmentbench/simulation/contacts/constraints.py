"""Contacts between up to four particles, and the impulses that resolve them.

A contact is a point of cloth that has to keep a gap from a moving plane: the sum of weight times position over its
particles. Where cloth meets cloth the weights sum to 0 and the plane goes through the origin, so that the impulses on
the two sides are equal and opposite and momentum is kept. Each contact is compliant and implicit in its normal
direction, with Coulomb friction.

All contacts of a substep are resolved at once (Jacobi) with mass splitting (Tonge, Benevolenski and Voroshilov 2012): a
particle lends each contact that presses on it a part of its mass, so no sum of impulses can overshoot. Impulses are
gathered by particle in a fixed order, so that the result doesn't depend on the number of threads.
"""

import warp as wp

from garmentbench.simulation.contacts.geometry import (
    across,
    face_normal,
    nearest_on_edges,
    nearest_on_face,
    over_face,
)
from garmentbench.simulation.kernels import Cloth, Physics

BODY = wp.constant(1)  # a sample of the cloth and the body's plane
PLANE = wp.constant(2)  # a particle over a face
CORNER = wp.constant(3)  # a particle beside a face, and the nearest point of the face's edges
EDGES = wp.constant(4)  # two edges
TANGLE = wp.constant(5)  # an end of an edge and the face that it goes through; the gap is a speed [m/s]
# Times the frequency of a particle's contact with the body: taut cloth presses hard on few particles, and gets through
# itself in a twist, and skin through tight sleeves, at a third of this.
HARDER = wp.constant(3.0)
FAR = wp.constant(0.003)  # [m] farther apart than this and the gap, cloth does not meet in the next substep


@wp.struct
class Constraints:
    """A list of contacts, and for each particle the entries of those that it has part in."""

    count: wp.array[int]  # shape (1,): how many there are
    kind: wp.array[int]
    index: wp.array[wp.vec4i]  # the particle and the face's corners; or the ends of an edge, and of the other
    weight: wp.array[wp.vec4]
    normal: wp.array[wp.vec3]
    side: wp.array[float]  # of the face or of the two edges, on which the first is; 0: not known
    gap: wp.array[float]  # [m]; of a TANGLE a speed [m/s]
    point: wp.array[wp.vec3]  # of the plane, at the time of the query [m]; 0 between cloth and cloth
    velocity: wp.array[wp.vec3]  # ... its velocity [m/s]
    push: wp.array[float]  # change of velocity along the normal in this substep [m/s]
    impulse: wp.array[wp.vec3]  # ... and the impulse [N s]
    start: wp.array[int]  # of each particle's entries
    entry: wp.array[int]  # 4 times the contact plus the corner
    share: wp.array[float]  # sum of |weight| over the contacts that press on a particle in this substep
    touched: wp.array[int]  # particles that have entries
    touched_count: wp.array[int]  # shape (1,)


@wp.func
def blend(values: wp.array[wp.vec3], index: wp.vec4i, weight: wp.vec4) -> wp.vec3:
    """The sum of weight times value over a contact's particles."""
    return (
        weight[0] * values[index[0]]
        + weight[1] * values[index[1]]
        + weight[2] * values[index[2]]
        + weight[3] * values[index[3]]
    )


@wp.func
def mobility(c: Cloth, i: int) -> float:
    """Inverse mass of a particle [1/kg], 0 of a pinned one."""
    return c.inverse_mass[i] * float(1 - c.pinned[i])


@wp.func
def has_part(k: Constraints, j: int, corner: int) -> bool:
    """Is there a particle at this corner of contact j? Its weight may be 0 for a while."""
    return k.kind[j] != BODY or k.weight[j][corner] != 0.0


@wp.func
def follow(c: Cloth, k: Constraints, j: int) -> bool:
    """Bring weights and normal of contact j to where the cloth is now. False: the two are out of each other's way."""
    index = k.index[j]
    side = k.side[j]
    meets = bool(True)
    if k.kind[j] == EDGES:
        a = wp.vec2i(index[0], index[1])
        b = wp.vec2i(index[2], index[3])
        q = nearest_on_edges(c.x, a, b)
        up = side * across(c.x, a, b)
        meets = wp.dot(up, k.normal[j]) > 0.0 and wp.min(q[0], q[1]) > 0.0 and wp.max(q[0], q[1]) < 1.0
        if meets:
            k.weight[j] = wp.vec4(1.0 - q[0], q[0], q[1] - 1.0, -q[1])
            k.normal[j] = wp.normalize(up)
    else:
        f = wp.vec3i(index[1], index[2], index[3])
        w = nearest_on_face(c.x, index[0], f)
        up = face_normal(c.x, f)
        away = over_face(c.x, index[0], f, w)
        normal = side * up
        if k.kind[j] == CORNER and wp.min(wp.min(w[0], w[1]), w[2]) == 0.0:
            normal = wp.normalize(away)
            meets = wp.dot(away, up) * side >= 0.0
        elif side == 0.0:
            normal = k.normal[j]
        if meets:
            k.weight[j] = wp.vec4(1.0, -w[0], -w[1], -w[2])
            k.normal[j] = normal
    return meets


@wp.func
def apart(c: Cloth, k: Constraints, j: int, since: float) -> float:
    """The distance of contact j from its plane, `since` seconds after the query [m]."""
    return wp.dot(blend(c.x, k.index[j], k.weight[j]) - k.point[j] - since * k.velocity[j], k.normal[j])


@wp.func
def meets(c: Cloth, k: Constraints, j: int, since: float) -> bool:
    """May contact j meet in this substep? Then it is where the cloth is now."""
    near = bool(True)
    if k.kind[j] != BODY and k.kind[j] != TANGLE:
        near = apart(c, k, j, since) - k.gap[j] < FAR
        if near:
            near = follow(c, k, j)
    return near


@wp.func
def press(c: Cloth, k: Constraints, p: Physics, j: int, since: float) -> float:
    """How much contact j has to change the velocity along its normal, `since` seconds after the query [m/s]."""
    push = float(0.0)
    if meets(c, k, j, since):
        speed = wp.dot(blend(c.v, k.index[j], k.weight[j]) - k.velocity[j], k.normal[j])
        frequency = HARDER * p.contact_frequency
        q = frequency * p.dt
        damp = q * q + 2.0 * p.contact_damping * q
        penetration = wp.min(k.gap[j] - apart(c, k, j, since), p.contact_depth)
        push = wp.max(0.0, (frequency * q * penetration - damp * speed) / (1.0 + damp))
        if k.kind[j] == TANGLE:
            push = wp.max(0.0, k.gap[j] - speed)
    k.push[j] = push
    return push


@wp.func
def divide(k: Constraints, i: int):
    """Among how much weight particle i has to divide its mass."""
    total = float(0.0)
    for s in range(k.start[i], k.start[i + 1]):
        j = k.entry[s] / 4
        if k.push[j] > 0.0:
            total += wp.abs(k.weight[j][k.entry[s] - 4 * j])
    k.share[i] = total


@wp.func
def strike(c: Cloth, k: Constraints, p: Physics, j: int):
    """The impulse of contact j: along the normal, then friction against what is left of the sliding."""
    push = k.push[j]
    if push > 0.0:
        index = k.index[j]
        weight = k.weight[j]
        # Change of the contact's velocity for an impulse of 1 [1/kg], as if pinned particles gave way, too: a free one
        # that has a small part in it, beside pinned ones, would have to make it up alone, and is shot away.
        give = float(0.0)
        for a in range(4):
            give += wp.abs(weight[a]) * k.share[index[a]] * c.inverse_mass[index[a]]
        n = k.normal[j]
        way = blend(c.v, index, weight) - k.velocity[j]
        way = way - wp.dot(way, n) * n
        slow = wp.min(1.0, p.friction * push / wp.max(wp.length(way), 1.0e-9))
        k.impulse[j] = (push * n - slow * way) / wp.max(give, 1.0e-9)


@wp.func
def recoil(c: Cloth, k: Constraints, i: int):
    """Give particle i its share of all impulses."""
    total = wp.vec3(0.0)
    for s in range(k.start[i], k.start[i + 1]):
        j = k.entry[s] / 4
        if k.push[j] > 0.0:
            total += k.weight[j][k.entry[s] - 4 * j] * k.impulse[j]
    c.v[i] = c.v[i] + mobility(c, i) * total


@wp.func
def resolve(c: Cloth, k: Constraints, p: Physics, since: float):
    """All contacts of one substep, one thread."""
    total = float(0.0)
    for j in range(k.count[0]):
        total += press(c, k, p, j, since)
    if total > 0.0:
        for s in range(k.touched_count[0]):
            divide(k, k.touched[s])
        for j in range(k.count[0]):
            strike(c, k, p, j)
        for s in range(k.touched_count[0]):
            recoil(c, k, k.touched[s])


@wp.kernel(enable_backward=False)
def press_pass(c: Cloth, k: Constraints, p: Physics, substep: int):
    """dim = capacity of the list."""
    j = wp.tid()
    if j < k.count[0]:
        press(c, k, p, j, float(substep) * p.dt)


@wp.kernel(enable_backward=False)
def divide_pass(k: Constraints):
    """dim = P."""
    s = wp.tid()
    if s < k.touched_count[0]:
        divide(k, k.touched[s])


@wp.kernel(enable_backward=False)
def strike_pass(c: Cloth, k: Constraints, p: Physics):
    """dim = capacity of the list."""
    j = wp.tid()
    if j < k.count[0]:
        strike(c, k, p, j)


@wp.kernel(enable_backward=False)
def recoil_pass(c: Cloth, k: Constraints):
    """dim = P."""
    s = wp.tid()
    if s < k.touched_count[0]:
        recoil(c, k, k.touched[s])
