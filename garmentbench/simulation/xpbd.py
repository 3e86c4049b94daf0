"""XPBD (Macklin et al. 2016), small: the simulator that a time budget buys, not the reference.

One Gauss-Seidel pass a substep over the same springs, stencils, creases, tangent planes and friction as the reference.
It stays whole at any number of substeps, but what it converges to depends on them: its stiffness is set by the step.
"""

from typing import Any

import warp as wp

from garmentbench.simulation.assembly import Fabric
from garmentbench.simulation.cloth import Solver, device_array
from garmentbench.simulation.contacts.constraints import TANGLE, Constraints, apart, blend, meets, mobility
from garmentbench.simulation.hinge import bent, hinge_angle, hinge_gradient
from garmentbench.simulation.kernels import Cloth, Contact, Physics, in_air


@wp.struct
class Bends:
    """Bending stencils, S of them without the creased ones, and what the substep remembers of P particles."""

    stencil: wp.array[wp.vec4i]
    coefficient: wp.array[wp.vec4]
    stiffness: wp.array[float]  # [N/m]
    before: wp.array[wp.vec3]  # positions before the substep [m], shape (P,)


@wp.func
def predict(c: Cloth, h: Contact, b: Bends, p: Physics, i: int, since: float):
    """Free flight; a pinned particle goes where it is held."""
    b.before[i] = c.x[i]
    if c.pinned[i] == 1:
        c.x[i] = h.point[i] + (since + p.dt) * h.velocity[i]
    else:
        v = c.v[i] - wp.vec3(0.0, 0.0, p.gravity * p.dt)
        c.x[i] = c.x[i] + p.dt * in_air(v, h.air[i], c.area[i], c.inverse_mass[i], p)


@wp.func
def project_edge(c: Cloth, p: Physics, e: int):
    """Bring one edge to its length as far as its compliance 1 / (k dt^2) lets it."""
    a = c.ends[e][0]
    b = c.ends[e][1]
    d = c.x[b] - c.x[a]
    length = wp.length(d)
    k = c.stiffness[e]
    if length < c.length[e]:
        k = k * p.compression
    wa = mobility(c, a)
    wb = mobility(c, b)
    push = (length - c.length[e]) / (wa + wb + 1.0 / (k * p.dt * p.dt)) * d / wp.max(length, 1.0e-9)
    c.x[a] = c.x[a] + wa * push
    c.x[b] = c.x[b] - wb * push


@wp.func
def project_bend(c: Cloth, b: Bends, p: Physics, s: int):
    """Flatten one stencil likewise; its constraint is linear, so each axis is projected exactly."""
    off = wp.vec3(0.0)
    weight = 1.0 / (b.stiffness[s] * p.dt * p.dt)
    for k in range(4):
        i = b.stencil[s][k]
        off += b.coefficient[s][k] * c.x[i]
        weight += b.coefficient[s][k] * b.coefficient[s][k] * mobility(c, i)
    for k in range(4):
        i = b.stencil[s][k]
        c.x[i] = c.x[i] - mobility(c, i) * b.coefficient[s][k] / weight * off


@wp.func
def project_crease(c: Cloth, p: Physics, k: int):
    """Bend one crease back to its angle likewise."""
    q = c.crease[k]
    x0, x1, x2, x3 = c.x[q[0]], c.x[q[1]], c.x[q[2]], c.x[q[3]]
    g = hinge_gradient(x0, x1, x2, x3)
    w0, w1, w2, w3 = mobility(c, q[0]), mobility(c, q[1]), mobility(c, q[2]), mobility(c, q[3])
    total = w0 * wp.dot(g.a, g.a) + w1 * wp.dot(g.b, g.b) + w2 * wp.dot(g.c, g.c) + w3 * wp.dot(g.d, g.d)
    turn = bent(hinge_angle(x0, x1, x2, x3), c.crease_angle[k])
    turn = turn / (total + 1.0 / (c.crease_stiffness[k] * p.dt * p.dt))
    c.x[q[0]] = x0 - w0 * turn * g.a
    c.x[q[1]] = x1 - w1 * turn * g.b
    c.x[q[2]] = x2 - w2 * turn * g.c
    c.x[q[3]] = x3 - w3 * turn * g.d


@wp.func
def push_out(c: Cloth, h: Contact, b: Bends, p: Physics, i: int, since: float):
    """Push out of what is touched, and rub against it."""
    if h.active[i] == 1:
        plane = h.point[i] + (since + p.dt) * h.velocity[i]
        depth = p.thickness - wp.dot(c.x[i] - plane, h.normal[i])
        if depth > 0.0:
            c.x[i] = c.x[i] + depth * h.normal[i]
            way = c.x[i] - b.before[i] - p.dt * h.velocity[i]
            way = way - wp.dot(way, h.normal[i]) * h.normal[i]
            c.x[i] = c.x[i] - wp.min(1.0, p.friction * depth / wp.max(wp.length(way), 1.0e-9)) * way


@wp.func
def push_apart(c: Cloth, k: Constraints, b: Bends, p: Physics, j: int, since: float):
    """Push the particles of a contact until it has its gap, and rub them against each other."""
    index = k.index[j]
    weight = k.weight[j]
    n = k.normal[j]
    depth = float(0.0)
    if k.kind[j] == TANGLE:  # its gap is a speed
        depth = p.dt * k.gap[j] - wp.dot(blend(c.x, index, weight) - blend(b.before, index, weight), n)
    elif meets(c, k, j, since + p.dt):
        depth = k.gap[j] - apart(c, k, j, since + p.dt)
    give = float(0.0)
    for a in range(4):
        give += weight[a] * weight[a] * mobility(c, index[a])
    if depth > 0.0 and give > 0.0:
        way = blend(c.x, index, weight) - blend(b.before, index, weight) - p.dt * k.velocity[j]
        way = way - wp.dot(way, n) * n
        push = (depth * n - wp.min(1.0, p.friction * depth / wp.max(wp.length(way), 1.0e-9)) * way) / give
        for a in range(4):
            c.x[index[a]] = c.x[index[a]] + weight[a] * mobility(c, index[a]) * push


@wp.func
def settle(c: Cloth, h: Contact, b: Bends, p: Physics, i: int, since: float):
    """Push out of the body, and take the velocity from the way gone."""
    push_out(c, h, b, p, i, since)
    c.v[i] = (c.x[i] - b.before[i]) / p.dt


@wp.kernel(enable_backward=False)
def advance_xpbd(c: Cloth, h: Contact, k: Constraints, b: Bends, p: Physics, substeps: int):
    """All substeps up to the next query, one thread: Gauss-Seidel goes from edge to edge."""
    for s in range(substeps):
        since = float(s) * p.dt
        for i in range(c.x.shape[0]):
            predict(c, h, b, p, i, since)
        for e in range(c.ends.shape[0]):
            project_edge(c, p, e)
        for i in range(b.stiffness.shape[0]):
            project_bend(c, b, p, i)
        for i in range(c.crease.shape[0]):
            project_crease(c, p, i)
        for i in range(c.x.shape[0]):  # first, so that the samples between particles find little left to do
            push_out(c, h, b, p, i, since)
        for j in range(k.count[0]):
            push_apart(c, k, b, p, j, since)
        for i in range(c.x.shape[0]):
            settle(c, h, b, p, i, since)


class XpbdSolver(Solver):
    """`Solver` with XPBD in place of the explicit integrator; takes any number of substeps."""

    LAG = 0.0

    def __init__(self, fabric: Fabric, *args: Any, **options: Any) -> None:
        super().__init__(fabric, *args, **options)
        b = self.bends = Bends()
        flat = ~fabric.creased
        b.stencil = device_array(fabric.stencils[flat], wp.vec4i, self.device)
        b.coefficient = device_array(fabric.curvature[flat], wp.vec4, self.device)
        b.stiffness = device_array(fabric.bend_stiffness[flat], float, self.device)
        b.before = wp.zeros(len(fabric.mass), dtype=wp.vec3, device=self.device)

    def _integrate(self) -> None:
        inputs = [self.cloth, self.contact, self.shared.contacts.constraints, self.bends, self.physics, self.steps]
        self._launch(advance_xpbd, 1, inputs)
