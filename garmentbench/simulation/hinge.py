"""Creases: edges that the rest shape bends, hinges that go back to their angle (discrete shells, Grinspun et al. 2003).

The gradient of the angle is exact (Bridson, Marino and Fedkiw 2003, eq. 1), with nothing left out: a crease neither
pushes nor turns the cloth as a whole.
"""

import warp as wp

from garmentbench.simulation.kernels import Cloth

TURN = wp.constant(6.283185307179586)


@wp.struct
class Gradient:
    """Of a hinge's angle by its four particles [rad/m]: the edge's ends, then the corners beside it."""

    a: wp.vec3
    b: wp.vec3
    c: wp.vec3
    d: wp.vec3


@wp.func
def hinge_gradient(x0: wp.vec3, x1: wp.vec3, x2: wp.vec3, x3: wp.vec3) -> Gradient:
    """The gradient of `hinge_angle`."""
    n1 = wp.cross(x2 - x0, x2 - x1)
    n2 = wp.cross(x3 - x1, x3 - x0)
    edge = x1 - x0
    length = wp.max(wp.length(edge), 1.0e-9)
    u = edge / length
    m1 = n1 / wp.max(wp.dot(n1, n1), 1.0e-14)
    m2 = n2 / wp.max(wp.dot(n2, n2), 1.0e-14)
    g = Gradient()
    g.a = -wp.dot(x2 - x1, u) * m1 - wp.dot(x3 - x1, u) * m2
    g.b = wp.dot(x2 - x0, u) * m1 + wp.dot(x3 - x0, u) * m2
    g.c = -length * m1
    g.d = -length * m2
    return g


@wp.func
def hinge_angle(x0: wp.vec3, x1: wp.vec3, x2: wp.vec3, x3: wp.vec3) -> float:
    """The signed angle between the faces (x0, x1, x2) and (x1, x0, x3) [rad], 0 where they lie in one plane."""
    n1 = wp.normalize(wp.cross(x2 - x0, x2 - x1))
    n2 = wp.normalize(wp.cross(x3 - x1, x3 - x0))
    return wp.atan2(wp.dot(wp.cross(n1, n2), wp.normalize(x1 - x0)), wp.dot(n1, n2))


@wp.func
def bent(angle: float, rest: float) -> float:
    """How far an angle is from its rest [rad], the short way round."""
    d = angle - rest
    return d - TURN * wp.round(d / TURN)


@wp.func
def firmness(c: Cloth, k: int) -> float:
    """What part of its stiffness crease k has.

    A triangle that collapses turns its angle ever faster, and would outrun the time step: below its area at rest, the
    stiffness falls as the gradient grows.
    """
    q = c.crease[k]
    x0, x1, x2, x3 = c.x[q[0]], c.x[q[1]], c.x[q[2]], c.x[q[3]]
    first = wp.length_sq(wp.cross(x2 - x0, x2 - x1)) / c.crease_square[k][0]
    second = wp.length_sq(wp.cross(x3 - x1, x3 - x0)) / c.crease_square[k][1]
    return wp.min(1.0, wp.min(first, second))


@wp.func
def hinge_force(c: Cloth, k: int):
    """Force of crease k on each of its particles."""
    q = c.crease[k]
    x0, x1, x2, x3 = c.x[q[0]], c.x[q[1]], c.x[q[2]], c.x[q[3]]
    g = hinge_gradient(x0, x1, x2, x3)
    moment = -firmness(c, k) * c.crease_stiffness[k] * bent(hinge_angle(x0, x1, x2, x3), c.crease_angle[k])
    c.crease_force[4 * k] = moment * g.a
    c.crease_force[4 * k + 1] = moment * g.b
    c.crease_force[4 * k + 2] = moment * g.c
    c.crease_force[4 * k + 3] = moment * g.d
