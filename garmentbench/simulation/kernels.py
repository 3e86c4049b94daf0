"""The integrator's arithmetic, in Warp. CPU and CUDA run the same functions; only the loops around them differ.

Explicit, symplectic Euler: forces from positions and velocities at the start of the substep, then the contact implicit
in its normal direction, then friction, then positions. One pass over edges and one over particles a substep; sums are
gathered in a fixed order, so that the result does not depend on the number of threads.
"""

import warp as wp


@wp.struct
class Cloth:
    """State and constants of P particles and E edges; sparse rows as (start, column, value) triples of arrays."""

    x: wp.array[wp.vec3]  # positions [m]
    v: wp.array[wp.vec3]  # velocities [m/s]
    y: wp.array[wp.vec3]  # x + bend_damping v: what bending acts on [m]
    inverse_mass: wp.array[float]  # [1/kg]
    pinned: wp.array[int]
    ends: wp.array[wp.vec2i]
    length: wp.array[float]  # [m]
    stiffness: wp.array[float]  # [N/m]
    force: wp.array[wp.vec3]  # of each edge on its first end [N]
    edge_start: wp.array[int]
    edge_index: wp.array[int]
    edge_sign: wp.array[float]
    bend_start: wp.array[int]
    bend_column: wp.array[int]
    bend_value: wp.array[float]  # [N/m]


@wp.struct
class Contact:
    """A tangent plane of the body (or of the cloth itself) for each particle.

    It is held until the next query and moves with the touched point.
    """

    point: wp.array[wp.vec3]  # at the time of the query [m]; of a pinned particle, where it is held
    normal: wp.array[wp.vec3]
    velocity: wp.array[wp.vec3]  # of the point [m/s]
    air: wp.array[wp.vec3]  # velocity of the air round the particle [m/s]
    active: wp.array[int]  # 0: nothing within reach
    distance: wp.array[float]  # to the surface that it is nearest to or deepest in, negative inside [m]


@wp.struct
class Physics:
    """Constants of one simulation."""

    dt: float  # [s]
    gravity: float  # [m/s^2]
    compression: float
    stretch_damping: float  # [s]
    bend_damping: float  # [s]
    air_keep: float  # exp(-air dt): what is left of the velocity relative to the air after a substep
    friction: float
    thickness: float  # [m]
    contact_frequency: float  # [rad/s]
    contact_damping: float
    contact_depth: float  # [m]


@wp.func
def edge_force(c: Cloth, p: Physics, e: int) -> wp.vec3:
    """Force of edge e on its first end: k (l - L) + k t (n . v_rel), times `compression` where it is shortened."""
    a = c.ends[e][0]
    b = c.ends[e][1]
    d = c.x[b] - c.x[a]
    length = wp.length(d)
    n = d / wp.max(length, 1.0e-9)
    k = c.stiffness[e]
    stretch = length - c.length[e]
    if stretch < 0.0:
        k = k * p.compression
    return k * (stretch + p.stretch_damping * wp.dot(n, c.v[b] - c.v[a])) * n


@wp.func
def total_force(c: Cloth, i: int) -> wp.vec3:
    """Sum of the edges' forces and of bending, -sum_j K_ij y_j, from differences (rows of K sum to 0; float32)."""
    f = wp.vec3(0.0)
    for s in range(c.edge_start[i], c.edge_start[i + 1]):
        f += c.edge_sign[s] * c.force[c.edge_index[s]]
    yi = c.y[i]
    for s in range(c.bend_start[i], c.bend_start[i + 1]):
        f += c.bend_value[s] * (yi - c.y[c.bend_column[s]])
    return f


@wp.func
def collide(v: wp.vec3, x: wp.vec3, point: wp.vec3, velocity: wp.vec3, n: wp.vec3, p: Physics) -> wp.vec3:
    """Velocity after a compliant contact, implicit in the normal direction, and Coulomb friction with exact stick."""
    q = p.contact_frequency * p.dt
    k = q * q + 2.0 * p.contact_damping * q
    r = v - velocity
    rn = wp.dot(r, n)
    penetration = wp.min(p.thickness - wp.dot(x - point, n), p.contact_depth)
    push = wp.max(0.0, (p.contact_frequency * q * penetration - k * rn) / (1.0 + k))
    tangent = r - rn * n
    slide = wp.max(0.0, 1.0 - p.friction * push / wp.max(wp.length(tangent), 1.0e-9))
    return velocity + (rn + push) * n + slide * tangent


@wp.func
def move_particle(c: Cloth, h: Contact, o: Contact, p: Physics, i: int, since: float):
    """One substep of particle i, `since` seconds after the query; h: the body's contact, o: the cloth's own."""
    if c.pinned[i] == 1:
        c.v[i] = h.velocity[i]
        c.x[i] = h.point[i] + (since + p.dt) * h.velocity[i]
    else:
        v = c.v[i] + p.dt * (c.inverse_mass[i] * total_force(c, i) - wp.vec3(0.0, 0.0, p.gravity))
        v = h.air[i] + p.air_keep * (v - h.air[i])
        if o.active[i] == 1:
            v = collide(v, c.x[i], o.point[i] + since * o.velocity[i], o.velocity[i], o.normal[i], p)
        if h.active[i] == 1:
            v = collide(v, c.x[i], h.point[i] + since * h.velocity[i], h.velocity[i], h.normal[i], p)
        c.v[i] = v
        c.x[i] = c.x[i] + p.dt * v


@wp.kernel(enable_backward=False)
def advance_serial(c: Cloth, h: Contact, o: Contact, p: Physics, substeps: int):
    """All substeps up to the next query in one launch of one thread: the way on a CPU."""
    for s in range(substeps):
        for i in range(c.x.shape[0]):
            c.y[i] = c.x[i] + p.bend_damping * c.v[i]
        for e in range(c.ends.shape[0]):
            c.force[e] = edge_force(c, p, e)
        for i in range(c.x.shape[0]):
            move_particle(c, h, o, p, i, float(s) * p.dt)


@wp.kernel(enable_backward=False)
def force_pass(c: Cloth, p: Physics):
    """Force of each edge, and what bending acts on: dim = max(E, P)."""
    i = wp.tid()
    if i < c.ends.shape[0]:
        c.force[i] = edge_force(c, p, i)
    if i < c.x.shape[0]:
        c.y[i] = c.x[i] + p.bend_damping * c.v[i]


@wp.kernel(enable_backward=False)
def particle_pass(c: Cloth, h: Contact, o: Contact, p: Physics, substep: int):
    """The move of each particle: dim = P."""
    i = wp.tid()
    move_particle(c, h, o, p, i, float(substep) * p.dt)
