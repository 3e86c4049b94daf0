"""The limbs of a body with named parts: what turns about the trunk, and where."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from garmentbench.geometry.mesh import unique_edges
from garmentbench.geometry.seeds import SeedPoints
from garmentbench.sequence import Body

TRUNK = "upper_body"
SMALLEST = 50  # vertices; what is smaller is a speck of paint in the labels, no limb
JOINT = (-0.04, 0.06)  # [m] A limb's turn grows from nothing to all of it between these distances from the joint


@dataclass(frozen=True)
class Limbs:
    """Limbs, L of them.

    Attributes:
        joints: Where each meets the trunk, canonical pose [m], shape (L, 3).
        carriers: The trunk's seed nearest to the joint, which carries it, shape (L,).
        shares: How much of a limb's turn each seed takes part in, in [0, 1], shape (L, N).
    """

    joints: np.ndarray
    carriers: np.ndarray
    shares: np.ndarray


def find_limbs(body: Body, seeds: SeedPoints) -> Limbs:
    """Connected regions of a body that are not its trunk and have seeds; none where no part is called the trunk."""
    found = []
    if TRUNK in body.part_names:
        off_trunk = body.labels != body.part_names.index(TRUNK)
        edges = unique_edges(body.faces)
        inner = edges[off_trunk[edges].all(axis=1)]
        graph = sp.csr_matrix((np.ones(len(inner)), inner.T), (len(off_trunk),) * 2)
        region = connected_components(graph, directed=False)[1]
        names, sizes = np.unique(region[off_trunk], return_counts=True)
        regions = [region == name for name in names[sizes >= SMALLEST]]
        found = [_limb(body, seeds, r, ~off_trunk, edges) for r in regions if r[seeds.vertices].any()]
    joints, carriers, shares = zip(*found, strict=True) if found else ((), (), ())
    shape = (len(found), -1) if found else (0, len(seeds.vertices))
    return Limbs(np.reshape(joints, (-1, 3)), np.array(carriers, np.int64), np.reshape(shares, shape))


def _limb(
    body: Body, seeds: SeedPoints, region: np.ndarray, trunk: np.ndarray, edges: np.ndarray
) -> tuple[np.ndarray, int, np.ndarray]:
    """Joint, carrier and shares of the limb whose vertices are `region`, shape (B,), bool."""
    crossing = edges[region[edges].any(axis=1) & ~region[edges].all(axis=1)]
    joint = body.rest[np.unique(crossing)].mean(axis=0)
    along = body.rest[region].mean(axis=0) - joint
    reach = (seeds.rest - joint) @ (along / np.linalg.norm(along))
    step = np.clip((reach - JOINT[0]) / (JOINT[1] - JOINT[0]), 0, 1)
    share = step**2 * (3 - 2 * step) * region[seeds.vertices]
    on_trunk = np.flatnonzero(trunk[seeds.vertices])
    carrier = on_trunk[np.argmin(np.linalg.norm(seeds.rest[on_trunk] - joint, axis=1))]
    return joint, int(carrier), share
