"""The body, and the garment beneath, as moving surfaces, and where each particle touches them.

Warp kernels, the same on CPU and CUDA.
"""

import warp as wp

from garmentbench.geometry.side import side, winding
from garmentbench.geometry.triangle import distance_to_face
from garmentbench.simulation.kernels import Cloth, Contact

FAR = wp.constant(0.1)  # [m] beyond this a particle has nothing to do with the body
# [m] The face that was the nearest bounds the search; others as near decide the sign with it.
SLACK = wp.constant(1.0e-4)
# [m] So deep nothing gets: it may be outside of a fold that skinning has turned inside out (an armpit, arm raised).
DOUBTFUL = wp.constant(0.003)
STILL = wp.constant(0.06)  # [m] from the skin: the air here moves with the body as a whole


@wp.struct
class Surface:
    """The collider between two frames: cubic Hermite, tangents m in metres a frame."""

    p0: wp.array[wp.vec3]
    p1: wp.array[wp.vec3]
    m0: wp.array[wp.vec3]
    m1: wp.array[wp.vec3]
    points: wp.array[wp.vec3]
    velocities: wp.array[wp.vec3]  # mean velocity until the next query [m/s]
    wind: wp.array[wp.vec3]  # shape (1,): velocity of the air away from the skin [m/s]
    border: wp.array[int]  # of a point: 1 where its surface ends


@wp.func
def hermite(s: Surface, i: int, u: float) -> wp.vec3:
    """Position of body vertex i at the fraction u of the frame."""
    w = 1.0 - u
    return w * w * ((1.0 + 2.0 * u) * s.p0[i] + u * s.m0[i]) + u * u * ((3.0 - 2.0 * u) * s.p1[i] - w * s.m1[i])


@wp.kernel(enable_backward=False)
def move_surface(s: Surface, u0: float, u1: float, interval: float):
    """Points at u0 and the velocities that lead to u1, `interval` seconds later: dim = B."""
    i = wp.tid()
    here = hermite(s, i, u0)
    s.points[i] = here
    s.velocities[i] = (hermite(s, i, u1) - here) / interval


@wp.kernel(enable_backward=False)
def forget_contacts(s: Surface, c: Cloth, h: Contact):
    """Particles that are not pinned touch nothing yet: dim = P."""
    i = wp.tid()
    if c.pinned[i] == 0:
        h.active[i] = 0
        h.distance[i] = FAR
        h.air[i] = s.wind[0]


@wp.kernel(enable_backward=False)
def find_contacts(
    mesh: wp.uint64,
    closed: bool,
    s: Surface,
    near: wp.array[int],
    points: wp.array[wp.vec3],
    skip: wp.array[int],
    h: Contact,
):
    """Tangent plane, its motion and the air round each of N points that is not skipped: dim = N.

    Of several surfaces, the one that it is deepest in or else nearest to. closed: has the surface no border? near: the
    nearest face at the last query, or -1.
    """
    i = wp.tid()
    if skip[i] == 0:
        x = points[i]
        reach = float(FAR)
        if h.distance[i] > 0.0:
            reach = wp.min(h.distance[i], FAR)  # outside of another surface, what is farther does not count
        if near[i] >= 0:
            reach = wp.min(distance_to_face(mesh, near[i], x) + SLACK, reach)
        q = wp.mesh_query_point_sign_normal(mesh, x, reach)
        near[i] = -1
        if q.result:
            near[i] = q.face
            p = wp.mesh_eval_position(mesh, q.face, q.u, q.v)
            v = wp.mesh_eval_velocity(mesh, q.face, q.u, q.v)
            sign = side(mesh, s.border, q, x - p)
            away = sign * (x - p)
            distance = wp.length(away)
            if closed and sign < 0.0 and distance > DOUBTFUL and winding(mesh, x) == 0:
                sign = 1.0
                away = x - p
            if sign * distance < h.distance[i]:
                n = wp.mesh_eval_face_normal(mesh, q.face)
                if distance > 1.0e-4:
                    n = away / distance
                h.active[i] = 1
                h.distance[i] = sign * distance
                h.point[i] = p
                h.normal[i] = n
                h.velocity[i] = v
                h.air[i] = v + wp.min(distance / STILL, 1.0) * (s.wind[0] - v)
