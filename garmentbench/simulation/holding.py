"""Where pinned particles are held, in Warp, the same on CPU and CUDA.

The skin holds each at its point over the face beneath. A garment doesn't: it folds and slides as no waistband does, and
pins on both sides of a fold would be carried into each other (an over-skirt's on a jump, to a twentieth of their
distance). A waistband is stiffer. So each place of it goes with the faces beneath the pins round it as one piece: by
the turn and the move that fit them best (shape matching, Müller et al. 2005, "Meshless deformations based on shape
matching").
"""

import warp as wp

from garmentbench.simulation.contact import Surface
from garmentbench.simulation.kernels import Cloth, Contact

# [m] Over which a band keeps its shape (weights fall to 1 / e); at 0.08 it cut into what is beneath.
REACH = wp.constant(0.05)
NEGLIGIBLE = wp.constant(9.0)  # squared distance in reaches beyond which nothing counts


@wp.struct
class Holding:
    """K pinned particles, and the collider beneath them at the start."""

    pin: wp.array[int]  # the particle
    face: wp.array[int]  # nearest to it
    at: wp.array[wp.vec3]  # its two barycentric coordinates (any sign) and its height over the face [m]
    start: wp.array[wp.vec3]  # where it was fastened [m]
    corners: wp.array[wp.mat33]  # of the face then, one a row [m]
    banded: wp.array[int]  # 1: held by cloth


@wp.func
def corners_of(s: Surface, faces: wp.array[int], face: int, time: float) -> wp.mat33:
    """The corners of a face, one a row, `time` seconds after the query [m]."""
    a, b, c = faces[3 * face], faces[3 * face + 1], faces[3 * face + 2]
    return wp.matrix_from_rows(
        s.points[a] + time * s.velocities[a], s.points[b] + time * s.velocities[b], s.points[c] + time * s.velocities[c]
    )


@wp.func
def held_point(corners: wp.mat33, at: wp.vec3) -> wp.vec3:
    """The point at barycentric (at.x, at.y) and height at.z over a triangle."""
    a, b, c = corners[0], corners[1], corners[2]
    n = wp.normalize(wp.cross(b - a, c - a))
    return at[0] * a + at[1] * b + (1.0 - at[0] - at[1]) * c + at[2] * n


@wp.kernel(enable_backward=False)
def attach(mesh: wp.uint64, s: Surface, faces: wp.array[int], skin_faces: int, c: Cloth, h: Holding):
    """Fasten each pinned particle to the nearest face, wherever it is; the first `skin_faces` are skin: dim = K."""
    k = wp.tid()
    x = c.x[h.pin[k]]
    q = wp.mesh_query_point_no_sign(mesh, x, 1.0e6)
    corners = corners_of(s, faces, q.face, 0.0)
    a = corners[0]
    ab = corners[1] - a
    ac = corners[2] - a
    n = wp.cross(ab, ac)
    d = x - a
    v = wp.dot(wp.cross(d, ac), n) / wp.dot(n, n)
    w = wp.dot(wp.cross(ab, d), n) / wp.dot(n, n)
    h.face[k] = q.face
    h.at[k] = wp.vec3(1.0 - v - w, v, wp.dot(d, wp.normalize(n)))
    h.start[k] = x
    h.corners[k] = corners
    h.banded[k] = wp.where(q.face >= skin_faces, 1, 0)


@wp.func
def weight(h: Holding, k: int, j: int) -> float:
    """How much the face beneath pin j counts for pin k of a band."""
    w = float(0.0)
    far = wp.length_sq(h.start[j] - h.start[k]) / (REACH * REACH)
    if h.banded[j] == 1 and far < NEGLIGIBLE:
        w = wp.exp(-far)
    return w


@wp.func
def turn_of(spread: wp.mat33) -> wp.mat33:
    """The rotation in a matrix. Both factors of `svd3` are rotations, and a sign is left to the last singular value; in
    single precision it is wrong by degrees where pins lie in a line. It has absolute bounds: hence the norm of 1."""
    u, _, v = wp.svd3(wp.mat33d(spread / wp.max(wp.sqrt(wp.ddot(spread, spread)), 1.0e-12)))
    return wp.mat33(u @ wp.transpose(v))


@wp.func
def fitted_point(s: Surface, faces: wp.array[int], h: Holding, k: int, time: float) -> wp.vec3:
    """Where the faces round pin k of a band bring it as one piece, `time` seconds after the query."""
    third = wp.vec3(1.0 / 3.0)
    total = float(0.0)
    before = wp.vec3(0.0)
    now = wp.vec3(0.0)
    for j in range(h.pin.shape[0]):
        w = weight(h, k, j)
        if w > 0.0:
            total += w
            before += w * (third @ h.corners[j])
            now += w * (third @ corners_of(s, faces, h.face[j], time))
    before = before / total
    now = now / total
    spread = wp.mat33(0.0)
    for j in range(h.pin.shape[0]):
        w = weight(h, k, j)
        if w > 0.0:
            there = corners_of(s, faces, h.face[j], time)
            for m in range(3):
                spread += w * wp.outer(there[m] - now, h.corners[j][m] - before)
    return now + turn_of(spread) @ (h.start[k] - before)


@wp.func
def place(s: Surface, faces: wp.array[int], h: Holding, k: int, time: float) -> wp.vec3:
    """Where pin k is held, `time` seconds after the query [m]."""
    if h.banded[k] == 1:
        return fitted_point(s, faces, h, k, time)
    return held_point(corners_of(s, faces, h.face[k], time), h.at[k])


@wp.kernel(enable_backward=False)
def hold(s: Surface, faces: wp.array[int], h: Holding, contact: Contact, interval: float):
    """Where pinned particles are held, and how that moves until the next query: dim = K."""
    k = wp.tid()
    i = h.pin[k]
    here = place(s, faces, h, k, 0.0)
    contact.point[i] = here
    contact.velocity[i] = (place(s, faces, h, k, interval) - here) / interval
