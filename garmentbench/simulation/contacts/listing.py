"""The list of contacts on the device: how it is filled at a query, and resolved in parallel."""

import warp as wp

from garmentbench.simulation.contacts.constraints import (
    Constraints,
    divide_pass,
    has_part,
    press_pass,
    recoil_pass,
    strike_pass,
)
from garmentbench.simulation.kernels import Cloth, Physics


@wp.kernel(enable_backward=False)
def take_count(first: wp.array[int], found: wp.array[int], k: Constraints):
    """How many contacts there are, of how many were found, none of them numbered yet: dim = 1."""
    last = first.shape[0] - 1
    k.count[0] = wp.min(first[last] + found[last], k.index.shape[0])
    k.touched_count[0] = 0


@wp.kernel(enable_backward=False)
def count_entries(k: Constraints, entries: wp.array[int]):
    """Entries of each particle, which begin at 0: dim = capacity."""
    j = wp.tid()
    if j < k.count[0]:
        for a in range(4):
            if has_part(k, j, a):
                wp.atomic_add(entries, k.index[j][a], 1)


@wp.kernel(enable_backward=False)
def fill_entries(k: Constraints, entries: wp.array[int]):
    """In any order; what is left of `entries` is 0: dim = capacity."""
    j = wp.tid()
    if j < k.count[0]:
        for a in range(4):
            i = k.index[j][a]
            if has_part(k, j, a):
                k.entry[k.start[i] + wp.atomic_sub(entries, i, 1) - 1] = 4 * j + a


@wp.kernel(enable_backward=False)
def sort_entries(k: Constraints):
    """In the order of contacts, and which particles have any: dim = P."""
    i = wp.tid()
    begin = k.start[i]
    for s in range(begin + 1, k.start[i + 1]):
        held = k.entry[s]
        t = int(s)
        while t > begin and k.entry[wp.max(t - 1, 0)] > held:
            k.entry[t] = k.entry[t - 1]
            t -= 1
        k.entry[t] = held
    if k.start[i + 1] > begin:
        k.touched[wp.atomic_add(k.touched_count, 0, 1)] = i


class ContactList:
    """Contacts that are found by `owners`, each of which writes its own number of them.

    Args:
        particles: P.
        owners: Of contacts: particles, edges, samples of the surface.
        capacity: Contacts that the list can hold; further ones are left out.
        device: Warp device.
    """

    def __init__(self, particles: int, owners: int, capacity: int, device: str) -> None:
        self.device, self.particles, self.capacity = device, particles, capacity
        self.found = wp.zeros(owners, dtype=int, device=device)
        self.first = wp.zeros(owners, dtype=int, device=device)
        self.entries = wp.zeros(particles + 1, dtype=int, device=device)
        k = self.constraints = Constraints()
        for name, count, kind in (
            ("count", 1, int),
            ("kind", capacity, int),
            ("index", capacity, wp.vec4i),
            ("weight", capacity, wp.vec4),
            ("normal", capacity, wp.vec3),
            ("side", capacity, float),
            ("gap", capacity, float),
            ("point", capacity, wp.vec3),
            ("velocity", capacity, wp.vec3),
            ("push", capacity, float),
            ("impulse", capacity, wp.vec3),
            ("start", particles + 1, int),
            ("entry", 4 * capacity, int),
            ("share", particles, float),
            ("touched", particles, int),
            ("touched_count", 1, int),
        ):
            setattr(k, name, wp.zeros(count, dtype=kind, device=device))

    def number(self) -> None:
        """Give each owner the place `first` of its contacts, by `found`, their number."""
        wp.utils.array_scan(self.found, self.first, inclusive=False)
        wp.launch(take_count, 1, [self.first, self.found, self.constraints], device=self.device)

    def index(self) -> None:
        """Collect the entries of each particle, once all contacts are written."""
        k, width = self.constraints, self.capacity
        wp.launch(count_entries, width, [k, self.entries], device=self.device)
        wp.utils.array_scan(self.entries, k.start, inclusive=False)
        wp.launch(fill_entries, width, [k, self.entries], device=self.device)
        wp.launch(sort_entries, self.particles, [k], device=self.device)

    def resolve(self, cloth: Cloth, physics: Physics, substep: int) -> None:
        """One substep in parallel: what `constraints.resolve` does in one thread."""
        k, width = self.constraints, self.capacity
        for kernel, dim, inputs in (
            (press_pass, width, [cloth, k, physics, substep]),
            (divide_pass, self.particles, [k]),
            (strike_pass, width, [cloth, k, physics]),
            (recoil_pass, self.particles, [cloth, k]),
        ):
            wp.launch(kernel, dim, inputs, device=self.device)
