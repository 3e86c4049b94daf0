"""Contact of the body with the centres of faces and the middles of edges: a face that its corners hold off is curved
round by the body, which would come through between them.

The body's tangent plane at such a sample holds it off as it holds a particle off, and the sample's corners share the
reaction. A sample that the planes of its corners hold far off anyway is not looked at.
"""

import numpy as np
import warp as wp

from garmentbench.simulation.assembly import Fabric
from garmentbench.simulation.collider import Collider
from garmentbench.simulation.contact import FAR
from garmentbench.simulation.contacts.constraints import BODY, Constraints, blend
from garmentbench.simulation.contacts.listing import ContactList
from garmentbench.simulation.kernels import Cloth, Contact, Physics

SHARE = wp.constant(0.5)  # of the thickness is what samples keep; between particles that keep it all, cloth may be flat
MARGIN = wp.constant(0.003)  # [m] beyond that and the way: what is farther is not looked at until the next query
HASTE = wp.constant(2.0)  # times the way at the present speed until the next query is looked at


@wp.struct
class Samples:
    """N samples of the cloth."""

    index: wp.array[wp.vec4i]
    weight: wp.array[wp.vec4]
    x: wp.array[wp.vec3]
    skip: wp.array[int]  # 1: far from the body, or held fast


@wp.func
def closing(v: wp.vec3, velocity: wp.vec3, n: wp.vec3, interval: float) -> float:
    """The way that something goes towards a plane until the next query, and more [m]."""
    return HASTE * interval * wp.max(wp.dot(velocity - v, n), 0.0)


@wp.kernel(enable_backward=False)
def choose(m: Samples, c: Cloth, h: Contact, o: Contact, p: Physics, interval: float):
    """Where samples are, and which of them are to be looked at; h: the particles' contacts, o: theirs: dim = N."""
    s = wp.tid()
    index = m.index[s]
    weight = m.weight[s]
    x = blend(c.x, index, weight)
    v = blend(c.v, index, weight)
    skip = int(1)
    for a in range(4):
        i = index[a]
        if weight[a] > 0.0 and c.pinned[i] == 0:
            if h.active[i] == 1:
                room = wp.dot(x - h.point[i], h.normal[i]) - SHARE * p.thickness - MARGIN
                if room < closing(v, h.velocity[i], h.normal[i], interval):
                    skip = 0
            elif wp.length(x - c.x[i]) > 0.5 * FAR:
                skip = 0
    m.x[s] = x
    m.skip[s] = skip
    o.active[s] = 0
    o.distance[s] = FAR


@wp.kernel(enable_backward=False)
def judge(m: Samples, c: Cloth, o: Contact, p: Physics, found: wp.array[int], begin: int, interval: float):
    """Which samples touch before the next query; they are the owners from `begin` on: dim = N."""
    s = wp.tid()
    near = int(0)
    if o.active[s] == 1:
        room = o.distance[s] - SHARE * p.thickness - MARGIN
        if room < closing(blend(c.v, m.index[s], m.weight[s]), o.velocity[s], o.normal[s], interval):
            near = 1
    found[begin + s] = near


@wp.kernel(enable_backward=False)
def write_samples(
    m: Samples, o: Contact, p: Physics, found: wp.array[int], first: wp.array[int], begin: int, k: Constraints
):
    """The list's entries: dim = N."""
    s = wp.tid()
    j = first[begin + s]
    if found[begin + s] == 1 and j < k.index.shape[0]:
        k.kind[j] = BODY
        k.index[j] = m.index[s]
        k.weight[j] = m.weight[s]
        k.normal[j] = o.normal[s]
        k.gap[j] = SHARE * p.thickness
        k.point[j] = o.point[s]
        k.velocity[j] = o.velocity[s]


class BodySamples:
    """Where faces and edges touch the body between their corners.

    Args:
        fabric: What is simulated.
        cloth: Its particles under way.
        contact: The particles' own contacts with the body.
        collider: The body.
        physics: Of the substeps.
        begin: The first owner in the list of contacts.
        device: Warp device.
    """

    def __init__(
        self,
        fabric: Fabric,
        cloth: Cloth,
        contact: Contact,
        collider: Collider,
        physics: Physics,
        begin: int,
        device: str,
    ) -> None:
        self.cloth, self.contact, self.collider, self.physics = cloth, contact, collider, physics
        self.begin, self.device = begin, device
        index, weight = _corners(fabric)
        self.owners = count = len(index)
        m, o = self.samples, self.touch = Samples(), Contact()
        m.index = wp.array(index, dtype=wp.vec4i, device=device)
        m.weight = wp.array(weight, dtype=wp.vec4, device=device)
        m.x = wp.zeros(count, dtype=wp.vec3, device=device)
        m.skip = wp.zeros(count, dtype=int, device=device)
        for name in ("point", "normal", "velocity", "air"):
            setattr(o, name, wp.zeros(count, dtype=wp.vec3, device=device))
        o.active = wp.zeros(count, dtype=int, device=device)
        o.distance = wp.zeros(count, dtype=float, device=device)
        self.near = collider.nothing_near(count)

    def find(self, contacts: ContactList, interval: float) -> None:
        """Which samples touch in the next `interval` seconds."""
        m, o = self.samples, self.touch
        self._launch(choose, [m, self.cloth, self.contact, o, self.physics, interval])
        self.collider.find(m.x, m.skip, self.near, o)
        self._launch(judge, [m, self.cloth, o, self.physics, contacts.found, self.begin, interval])

    def write(self, contacts: ContactList) -> None:
        """Put them into the list."""
        inputs = [self.samples, self.touch, self.physics, contacts.found, contacts.first, self.begin]
        self._launch(write_samples, [*inputs, contacts.constraints])

    def _launch(self, kernel: wp.Kernel, inputs: list) -> None:
        wp.launch(kernel, dim=self.owners, inputs=inputs, device=self.device)


def _corners(fabric: Fabric) -> tuple[np.ndarray, np.ndarray]:
    """Particles and weights of the centres of faces, then of the middles of edges, shape (F + E, 4) each."""
    f, e = fabric.faces, fabric.edges
    index = np.concatenate([f[:, [0, 1, 2, 0]], e[:, [0, 1, 0, 0]]])
    weight = np.repeat([[1 / 3, 1 / 3, 1 / 3, 0], [1 / 2, 1 / 2, 0, 0]], [len(f), len(e)], axis=0)
    free = ~fabric.pinned[index].all(axis=1)
    return index[free].astype(np.int32), weight[free].astype(np.float32)
