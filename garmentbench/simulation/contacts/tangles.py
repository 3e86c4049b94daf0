"""Cloth that has passed through itself and stays so: the line along which it crosses is shortened until it is gone.

On which side of each other the pieces were is forgotten there, or wrong. So contact lets them go, and each edge that
goes through a face is moved against it in the direction that shortens the line (Volino and Magnenat-Thalmann 2006,
"Resolving surface collisions through intersection contour minimization"). That needs no history, and leads round
borders.
"""

import numpy as np
import warp as wp

from garmentbench.simulation.assembly import Fabric
from garmentbench.simulation.contacts.candidates import Candidates
from garmentbench.simulation.contacts.constraints import TANGLE, Constraints
from garmentbench.simulation.contacts.geometry import face_normal, has
from garmentbench.simulation.contacts.listing import ContactList
from garmentbench.simulation.kernels import Cloth

OLD = wp.constant(2)  # times that a crossing is seen before it is taken for one that contact doesn't bring back
SPEED = wp.constant(0.5)  # [m/s] at which an edge is led out of a face: by less than the body holds it off with
CLEAR = wp.constant(0.2)  # length of the direction beyond which it is followed in earnest
STEEP = wp.constant(0.1)  # least sine of the angle between edge and face that is counted with


@wp.struct
class Tangles:
    """E edges, P particles."""

    beside: wp.array[wp.vec2i]  # faces of an edge; -1: none
    face: wp.array[int]  # that an edge goes through; -1: none
    age: wp.array[int]  # times that it has been seen to go through one, in a row
    caught: wp.array[int]  # 1: a particle of an edge that has long gone through a face, or of such a face


@wp.func
def volume(a: wp.vec3, b: wp.vec3, c: wp.vec3) -> float:
    """Six times the signed volume of a tetrahedron, one corner of which is the origin."""
    return wp.dot(wp.cross(a, b), c)


@wp.func
def pierces(x: wp.array[wp.vec3], e: wp.vec2i, f: wp.vec3i) -> bool:
    """Does an edge go through a face?"""
    p = x[e[0]]
    way = x[e[1]] - p
    a = x[f[0]] - p
    b = x[f[1]] - p
    c = x[f[2]] - p
    n = wp.cross(b - a, c - a)
    through = bool(False)
    if wp.dot(n, a) * (wp.dot(n, a) - wp.dot(n, way)) < 0.0:
        u = volume(way, a, b)
        v = volume(way, b, c)
        w = volume(way, c, a)
        through = (u > 0.0 and v > 0.0 and w > 0.0) or (u < 0.0 and v < 0.0 and w < 0.0)
    return through


@wp.kernel(enable_backward=False)
def look(tree: wp.uint64, c: Cloth, n: Candidates, t: Tangles):
    """The face that each edge goes through, of several the first by number: dim = F."""
    i = wp.tid()
    mine = n.own_edges[i]
    found = wp.vec3i(-1, -1, -1)
    own = n.faces[i]
    a, b, g = c.x[own[0]], c.x[own[1]], c.x[own[2]]
    query = wp.bvh_query_aabb(tree, wp.min(wp.min(a, b), g), wp.max(wp.max(a, b), g))
    j = int(0)
    while wp.bvh_query_next(query, j):
        f = n.faces[j]
        for k in range(3):
            d = mine[k]
            if d >= 0 and (found[k] < 0 or j < found[k]):
                e = n.edges[d]
                if not has(f, e[0]) and not has(f, e[1]) and pierces(c.x, e, f):
                    found[k] = j
    for k in range(3):
        if mine[k] >= 0:
            t.face[mine[k]] = found[k]


@wp.kernel(enable_backward=False)
def forget(t: Tangles):
    """dim = P."""
    t.caught[wp.tid()] = 0


@wp.kernel(enable_backward=False)
def grow_old(n: Candidates, t: Tangles):
    """dim = E."""
    d = wp.tid()
    if t.face[d] < 0:
        t.age[d] = 0
    else:
        t.age[d] = wp.min(t.age[d] + 1, OLD)
        if t.age[d] == OLD:
            f = n.faces[t.face[d]]
            for k in range(3):
                t.caught[f[k]] = 1
            t.caught[n.edges[d][0]] = 1
            t.caught[n.edges[d][1]] = 1


@wp.kernel(enable_backward=False)
def judge(c: Cloth, n: Candidates, t: Tangles, found: wp.array[int], begin: int):
    """Each end of an edge that still goes through its face is a contact: dim = E."""
    d = wp.tid()
    count = int(0)
    if t.age[d] == OLD:
        count = wp.where(pierces(c.x, n.edges[d], n.faces[t.face[d]]), 2, 0)
    found[begin + d] = count


@wp.func
def way_out(x: wp.array[wp.vec3], n: Candidates, t: Tangles, d: int, up: wp.vec3) -> wp.vec3:
    """Where edge d has to go, against a face of normal `up`, for the line of crossing to become shorter."""
    e = n.edges[d]
    along = wp.normalize(x[e[1]] - x[e[0]])
    steep = wp.dot(along, up)
    steep = wp.where(steep < 0.0, wp.min(steep, -STEEP), wp.max(steep, STEEP))
    out = wp.vec3(0.0)
    for k in range(2):
        g = t.beside[d][k]
        if g >= 0:
            f = n.faces[g]
            inward = x[f[0]] + x[f[1]] + x[f[2]] - 3.0 * x[e[0]]
            inward = inward - wp.dot(inward, along) * along
            line = wp.normalize(wp.cross(up, face_normal(x, f)))
            line = wp.where(wp.dot(line, inward) < 0.0, -1.0, 1.0) * line
            out += line - 2.0 * wp.dot(along, line) / steep * up
    return out


@wp.kernel(enable_backward=False)
def write_tangles(
    c: Cloth, n: Candidates, t: Tangles, found: wp.array[int], first: wp.array[int], begin: int, k: Constraints
):
    """The list's entries: dim = E."""
    d = wp.tid()
    j = first[begin + d]
    if found[begin + d] == 2 and j + 1 < k.index.shape[0]:
        e = n.edges[d]
        f = n.faces[t.face[d]]
        up = face_normal(c.x, f)
        out = way_out(c.x, n, t, d, up)
        size = wp.length(out)
        for m in range(2):
            k.kind[j + m] = TANGLE
            k.index[j + m] = wp.vec4i(e[m], f[0], f[1], f[2])
            k.weight[j + m] = wp.vec4(1.0, -1.0 / 3.0, -1.0 / 3.0, -1.0 / 3.0)
            k.normal[j + m] = out / wp.max(size, 1.0e-6)
            k.gap[j + m] = SPEED * wp.min(size / CLEAR, 1.0)
            k.side[j + m] = 0.0
            k.point[j + m] = wp.vec3(0.0)
            k.velocity[j + m] = wp.vec3(0.0)


class Untangling:
    """Where a cloth stays crossed with itself.

    Args:
        fabric: What is simulated.
        cloth: Its particles under way.
        candidates: Its faces and edges, and the boxes that are searched.
        begin: The first owner in the list of contacts.
        device: Warp device.
    """

    def __init__(self, fabric: Fabric, cloth: Cloth, candidates: Candidates, begin: int, device: str) -> None:
        self.cloth, self.candidates, self.begin, self.device = cloth, candidates, begin, device
        self.faces, self.owners = len(fabric.faces), len(fabric.edges)
        t = self.tangles = Tangles()
        t.beside = wp.array(_beside(fabric.faces, fabric.edges), dtype=wp.vec2i, device=device)
        t.face = wp.full(self.owners, -1, dtype=int, device=device)
        t.age = wp.zeros(self.owners, dtype=int, device=device)
        t.caught = wp.zeros(len(fabric.mass), dtype=int, device=device)

    def search(self, tree: wp.Bvh) -> None:
        """Which edges go through faces, and which have for long."""
        n, t = self.candidates, self.tangles
        self._launch(look, self.faces, [tree.id, self.cloth, n, t])
        self._launch(forget, len(t.caught), [t])
        self._launch(grow_old, self.owners, [n, t])

    def find(self, contacts: ContactList) -> None:
        """Which of them are led out until the next query."""
        self._launch(judge, self.owners, [self.cloth, self.candidates, self.tangles, contacts.found, self.begin])

    def write(self, contacts: ContactList) -> None:
        """Put them into the list."""
        inputs = [self.cloth, self.candidates, self.tangles, contacts.found, contacts.first, self.begin]
        self._launch(write_tangles, self.owners, [*inputs, contacts.constraints])

    def _launch(self, kernel: wp.Kernel, dim: int, inputs: list) -> None:
        wp.launch(kernel, dim=dim, inputs=inputs, device=self.device)


def _beside(faces: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """The faces of each edge, shape (E, 2), -1 where there is no second; of more than two the first and the last."""
    number = {tuple(e): k for k, e in enumerate(np.sort(edges, axis=1).tolist())}
    out = np.full((len(edges), 2), -1, np.int32)
    for j, (a, b, c) in enumerate(np.sort(faces, axis=1).tolist()):
        for side in ((a, b), (b, c), (a, c)):
            row = out[number[side]]
            row[int(row[0] >= 0)] = j
    return out
