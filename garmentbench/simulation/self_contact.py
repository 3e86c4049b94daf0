"""Cloth that touches itself: each particle against the faces that it is no corner of.

Of two layers that touch, each particle keeps to its side of the plane half-way to the nearest point of the other, which
moves with the mean of both velocities; so both give way alike, and what meets stays together instead of bouncing. The
plane is held until the next query, and met as the body's is: implicit in its normal, with Coulomb friction. A particle
that has got to the other side of a face between two queries is brought back.

Vertices against faces only: two edges can cross. A vertex that pokes at the middle of a face feels it alone.
"""

import numpy as np
import warp as wp

from garmentbench.geometry.triangle import nearest_weights
from garmentbench.simulation.assembly import Fabric
from garmentbench.simulation.kernels import Cloth, Contact, Physics

MARGIN = wp.constant(0.007)  # [m] what is farther than this and the thickness is not looked at until the next query
REST_SHARE = wp.constant(0.5)  # of its distance at rest is all that a face is kept away: cloth may lie close by its cut
OPPOSITE = wp.constant(-0.5)  # normals of the same face before and after, whose product is less: on the other side


@wp.struct
class Own:
    """F faces of the cloth."""

    faces: wp.array[wp.vec3i]
    rest: wp.array[wp.vec3]  # positions at rest [m]
    face: wp.array[int]  # that each particle was near to at the last query; -1: none
    normal: wp.array[wp.vec3]  # of its plane then


@wp.func
def blend(values: wp.array[wp.vec3], face: wp.vec3i, weights: wp.vec3) -> wp.vec3:
    """What a point of a face has of its corners' values."""
    return weights[0] * values[face[0]] + weights[1] * values[face[1]] + weights[2] * values[face[2]]


@wp.func
def has(face: wp.vec3i, i: int) -> bool:
    """Is i a corner of the face?"""
    return face[0] == i or face[1] == i or face[2] == i


@wp.kernel(enable_backward=False)
def find_own_contacts(mesh: wp.uint64, own: Own, c: Cloth, o: Contact, p: Physics):
    """The plane between each particle and the face that presses most on it: dim = P."""
    i = wp.tid()
    x = c.x[i]
    last = own.face[i]
    own.face[i] = -1
    o.active[i] = 0
    reach = p.thickness + MARGIN
    box = wp.vec3(reach, reach, reach)
    query = wp.mesh_query_aabb(mesh, x - box, x + box)
    room = float(MARGIN)
    j = int(0)
    while wp.mesh_query_aabb_next(query, j):
        f = own.faces[j]
        if not has(f, i):
            w = nearest_weights(x, c.x[f[0]], c.x[f[1]], c.x[f[2]])
            away = x - blend(c.x, f, w)
            distance = wp.length(away)
            if distance < p.thickness + room:
                at_rest = nearest_weights(own.rest[i], own.rest[f[0]], own.rest[f[1]], own.rest[f[2]])
                gap = wp.min(p.thickness, REST_SHARE * wp.length(own.rest[i] - blend(own.rest, f, at_rest)))
                if distance - gap < room and distance > 1.0e-6 and c.pinned[i] == 0:
                    room = distance - gap
                    own.face[i] = j
                    n = away / distance
                    if last >= 0:
                        g = own.faces[last]
                        if (has(f, g[0]) or has(f, g[1]) or has(f, g[2])) and wp.dot(n, own.normal[i]) < OPPOSITE:
                            n = -n
                    o.active[i] = 1
                    o.normal[i] = n
                    o.velocity[i] = 0.5 * (c.v[i] + blend(c.v, f, w))
                    # The plane lies half-way, and the particle keeps half the gap from it; `collide` keeps it the whole
                    # thickness from `point`.
                    o.point[i] = x - 0.5 * away + (0.5 * gap - p.thickness) * n
    if o.active[i] == 1:
        own.normal[i] = o.normal[i]


class SelfContact:
    """Where a cloth touches itself.

    Args:
        fabric: What is simulated.
        cloth: Its particles under way.
        contact: What is found, a plane a particle.
        physics: Of the substeps.
        device: Warp device.
    """

    def __init__(self, fabric: Fabric, cloth: Cloth, contact: Contact, physics: Physics, device: str) -> None:
        self.cloth, self.contact, self.physics, self.device = cloth, contact, physics, device
        faces = np.ascontiguousarray(fabric.faces, np.int32)
        self.indices = wp.array(faces.ravel(), dtype=int, device=device)
        self.mesh = wp.Mesh(points=cloth.x, indices=self.indices)
        own = self.own = Own()
        own.faces = wp.array(faces, dtype=wp.vec3i, device=device)
        own.rest = wp.array(fabric.rest.astype(np.float32), dtype=wp.vec3, device=device)
        own.normal = wp.zeros(len(fabric.mass), dtype=wp.vec3, device=device)
        own.face = wp.full(len(fabric.mass), -1, dtype=int, device=device)

    def find(self) -> None:
        """Look where the cloth is now; the planes hold until this is called again."""
        self.mesh.refit()
        inputs = [self.mesh.id, self.own, self.cloth, self.contact, self.physics]
        wp.launch(find_own_contacts, len(self.cloth.x), inputs, device=self.device)
