"""The integrator's arithmetic, in Warp. CPU and CUDA run the same functions; only the loops around them differ.

Explicit, symplectic Euler: forces from positions and velocities at the start of the substep, then the air, then the
contact implicit in its normal direction, then friction, then positions. One pass over edges and creases and one over
particles a substep; sums are gathered in a fixed order, so that the result does not depend on the number of threads.
Bending is damped between the queries (`damping`).
"""

import warp as wp


@wp.struct
class Cloth:
    """State and constants of P particles, E edges, F faces and C creases; sparse rows as (start, column, value)."""

    x: wp.array[wp.vec3]  # positions [m]
    v: wp.array[wp.vec3]  # velocities [m/s]
    y: wp.array[wp.vec3]  # positions at the start of the substep [m]: what bending acts on while x moves
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
    crease: wp.array[wp.vec4i]
    crease_stiffness: wp.array[float]  # [N m]
    crease_angle: wp.array[float]  # at rest [rad]
    crease_square: wp.array[wp.vec2]  # squares of twice the areas of its faces at rest [m^4]
    crease_force: wp.array[wp.vec3]  # on each of its four particles [N], shape (4 C,)
    crease_start: wp.array[int]
    crease_index: wp.array[int]
    faces: wp.array[wp.vec3i]
    face_start: wp.array[int]
    face_index: wp.array[int]
    area: wp.array[wp.vec3]  # a third of the areas of the faces round a particle, times their normals [m^2]


@wp.struct
class Contact:
    """A tangent plane of the body for each particle, or another point of the cloth.

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
    drag: float  # half the density of air times the drag coefficient, across the cloth [kg/m^3]
    drag_along: float  # ... along it [kg/m^3]
    settle_keep: float  # exp(-settling dt): what is left of the velocity relative to the air after a substep
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
    """Sum of the edges' forces, of the creases' and of bending, -sum_j K_ij y_j, from differences (rows of K sum to 0;
    float32)."""
    f = wp.vec3(0.0)
    for s in range(c.edge_start[i], c.edge_start[i + 1]):
        f += c.edge_sign[s] * c.force[c.edge_index[s]]
    yi = c.y[i]
    for s in range(c.bend_start[i], c.bend_start[i + 1]):
        f += c.bend_value[s] * (yi - c.y[c.bend_column[s]])
    for s in range(c.crease_start[i], c.crease_start[i + 1]):
        f += c.crease_force[c.crease_index[s]]
    return f


@wp.func
def take_area(c: Cloth, i: int):
    """The area of particle i where the cloth is now."""
    a = wp.vec3(0.0)
    for s in range(c.face_start[i], c.face_start[i + 1]):
        f = c.faces[c.face_index[s]]
        a += wp.cross(c.x[f[1]] - c.x[f[0]], c.x[f[2]] - c.x[f[0]])
    c.area[i] = a / 6.0


@wp.func
def in_air(v: wp.vec3, air: wp.vec3, area: wp.vec3, inverse_mass: float, p: Physics) -> wp.vec3:
    """Velocity after the air's drag: quadratic and exact for its direction (du/dt = -k u^2), so it can't overshoot."""
    size = wp.length(area)
    u = p.settle_keep * (v - air)
    n = area / wp.max(size, 1.0e-12)
    across = wp.dot(u, n)
    along = u - across * n
    k = p.dt * size * inverse_mass
    across = across / (1.0 + k * p.drag * wp.abs(across))
    return air + across * n + along / (1.0 + k * p.drag_along * wp.length(along))


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
def accelerate(c: Cloth, h: Contact, p: Physics, i: int):
    """Forces and air: the velocity of particle i after a substep that meets nothing, or of what holds it."""
    v = h.velocity[i]
    if c.pinned[i] == 0:
        v = c.v[i] + p.dt * (c.inverse_mass[i] * total_force(c, i) - wp.vec3(0.0, 0.0, p.gravity))
        v = in_air(v, h.air[i], c.area[i], c.inverse_mass[i], p)
    c.v[i] = v


@wp.func
def move_particle(c: Cloth, h: Contact, p: Physics, i: int, since: float):
    """Contact of particle i with the body, and its move, `since` seconds after the query."""
    if c.pinned[i] == 1:
        c.x[i] = h.point[i] + (since + p.dt) * h.velocity[i]
    else:
        v = c.v[i]
        if h.active[i] == 1:
            v = collide(v, c.x[i], h.point[i] + since * h.velocity[i], h.velocity[i], h.normal[i], p)
        c.v[i] = v
        c.x[i] = c.x[i] + p.dt * v
