"""Cloth that touches itself: particles against faces, and edges against edges."""

import numpy as np
import warp as wp

from garmentbench.simulation.assembly import Fabric
from garmentbench.simulation.contacts.candidates import PLACES, Candidates, clear, owned, search, sweep, take_drift
from garmentbench.simulation.contacts.listing import ContactList
from garmentbench.simulation.contacts.sides import Narrow, meet, write_pairs
from garmentbench.simulation.contacts.tangles import Untangling
from garmentbench.simulation.kernels import Cloth, Physics


class SelfContact:
    """Where a cloth touches itself.

    Args:
        fabric: What is simulated.
        cloth: Its particles under way.
        physics: Of the substeps.
        device: Warp device.
    """

    def __init__(self, fabric: Fabric, cloth: Cloth, physics: Physics, device: str) -> None:
        self.cloth, self.physics, self.device = cloth, physics, device
        self.particles, self.faces = len(fabric.mass), len(fabric.faces)
        self.pairs = self.particles + len(fabric.edges)
        places = self.pairs * PLACES
        n, r = self.candidates, self.narrow = Candidates(), Narrow()
        particles, edges = owned(fabric.faces, fabric.edges)
        for target, name, values, kind in (
            (n, "faces", fabric.faces, wp.vec3i),
            (n, "edges", fabric.edges, wp.vec2i),
            (n, "own_particles", particles, wp.vec3i),
            (n, "own_edges", edges, wp.vec3i),
            (n, "rest", fabric.rest, wp.vec3),
            (r, "rim", _rim(fabric.faces), wp.vec3i),
        ):
            number = np.float32 if kind is wp.vec3 else np.int32
            setattr(target, name, wp.array(np.ascontiguousarray(values, number), dtype=kind, device=device))
        for target, name, count, kind in (
            *((n, name, self.faces, wp.vec3) for name in ("lower", "upper")),
            (n, "drift", 1, wp.vec3),
            *((n, name, self.pairs, int) for name in ("number", "last_number")),
            *((n, name, places, int) for name in ("other", "last_other")),
            *((n, name, places, float) for name in ("gap", "room", "side", "last_side")),
            (r, "kind", places, int),
            *((r, name, places, wp.vec3) for name in ("weight", "normal")),
        ):
            setattr(target, name, wp.zeros(count, dtype=kind, device=device))
        r.old = wp.clone(cloth.x)
        self._launch(sweep, self.faces, [cloth, n, physics, 0.0])
        self._tree = wp.Bvh(n.lower, n.upper)
        self.untangling = Untangling(fabric, cloth, n, self.pairs, device)
        self.owners = self.pairs + self.untangling.owners

    def search(self, time: float, untangle: bool) -> None:
        """Broad phase: what may touch in the next `time` seconds; `untangle`: and what is crossed."""
        cloth, n = self.cloth, self.candidates
        self._launch(take_drift, 1, [cloth, n])
        self._launch(sweep, self.faces, [cloth, n, self.physics, time])
        self._tree.refit()
        self._launch(clear, self.pairs, [n])
        self._launch(search, self.faces, [self._tree.id, cloth, n, self.physics, time])
        if untangle:
            self.untangling.search(self._tree)

    def find(self, contacts: ContactList, interval: float) -> None:
        """Narrow phase: how many contacts each owner has in the next `interval` seconds."""
        caught = self.untangling.tangles.caught
        self._launch(meet, self.pairs, [self.candidates, self.narrow, self.cloth, caught, contacts.found, interval])
        self.untangling.find(contacts)

    def write(self, contacts: ContactList) -> None:
        """Put them into the list."""
        inputs = [self.candidates, self.narrow, self.cloth, contacts.first, contacts.constraints]
        self._launch(write_pairs, self.pairs, inputs)
        self.untangling.write(contacts)

    def _launch(self, kernel: wp.Kernel, dim: int, inputs: list) -> None:
        wp.launch(kernel, dim=dim, inputs=inputs, device=self.device)


def _rim(faces: np.ndarray) -> np.ndarray:
    """1 for each corner whose opposite edge only this face has, shape (F, 3)."""
    sides = np.sort(np.stack([np.roll(faces, -1, axis=1), np.roll(faces, -2, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    _, index, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    return (count[index.ravel()] == 1).reshape(-1, 3).astype(np.int32)
