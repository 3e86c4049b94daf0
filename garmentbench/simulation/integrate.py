"""The loops over substeps: one launch for all of them on a CPU, a few passes each on CUDA. Both give the same."""

import warp as wp

from garmentbench.simulation.contacts.constraints import Constraints, resolve
from garmentbench.simulation.hinge import hinge_force
from garmentbench.simulation.kernels import Cloth, Contact, Physics, accelerate, edge_force, move_particle, take_area


@wp.kernel(enable_backward=False)
def advance_serial(c: Cloth, h: Contact, k: Constraints, p: Physics, substeps: int):
    """All substeps up to the next query in one launch of one thread: the way on a CPU."""
    for s in range(substeps):
        since = float(s) * p.dt
        for i in range(c.x.shape[0]):
            c.y[i] = c.x[i]
        for e in range(c.ends.shape[0]):
            c.force[e] = edge_force(c, p, e)
        for e in range(c.crease.shape[0]):
            hinge_force(c, e)
        for i in range(c.x.shape[0]):
            accelerate(c, h, p, i)
        resolve(c, k, p, since)
        for i in range(c.x.shape[0]):
            move_particle(c, h, p, i, since)


@wp.kernel(enable_backward=False)
def force_pass(c: Cloth, p: Physics):
    """Forces of edges and creases, and the positions that they are of: dim = max(E, C, P)."""
    i = wp.tid()
    if i < c.ends.shape[0]:
        c.force[i] = edge_force(c, p, i)
    if i < c.crease.shape[0]:
        hinge_force(c, i)
    if i < c.x.shape[0]:
        c.y[i] = c.x[i]


@wp.kernel(enable_backward=False)
def accelerate_pass(c: Cloth, h: Contact, p: Physics):
    """dim = P."""
    accelerate(c, h, p, wp.tid())


@wp.kernel(enable_backward=False)
def move_pass(c: Cloth, h: Contact, p: Physics, substep: int):
    """dim = P."""
    move_particle(c, h, p, wp.tid(), float(substep) * p.dt)


@wp.kernel(enable_backward=False)
def area_pass(c: Cloth):
    """The cloth's areas, which hold until the next query: dim = P."""
    take_area(c, wp.tid())
