"""The loops over substeps: one launch for all of them on a CPU, two passes each on CUDA. Both give the same."""

import warp as wp

from garmentbench.simulation.hinge import hinge_force
from garmentbench.simulation.kernels import Cloth, Contact, Physics, edge_force, move_particle, take_area


@wp.kernel(enable_backward=False)
def advance_serial(c: Cloth, h: Contact, o: Contact, p: Physics, substeps: int):
    """All substeps up to the next query in one launch of one thread: the way on a CPU."""
    for s in range(substeps):
        for i in range(c.x.shape[0]):
            c.y[i] = c.x[i]
        for e in range(c.ends.shape[0]):
            c.force[e] = edge_force(c, p, e)
        for k in range(c.crease.shape[0]):
            hinge_force(c, k)
        for i in range(c.x.shape[0]):
            move_particle(c, h, o, p, i, float(s) * p.dt)


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
def particle_pass(c: Cloth, h: Contact, o: Contact, p: Physics, substep: int):
    """The move of each particle: dim = P."""
    i = wp.tid()
    move_particle(c, h, o, p, i, float(substep) * p.dt)


@wp.kernel(enable_backward=False)
def area_pass(c: Cloth):
    """The cloth's areas, which hold until the next query: dim = P."""
    take_area(c, wp.tid())
