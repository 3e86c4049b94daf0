"""From a garment's template to particles, springs and bending: numpy arrays, made once a simulation."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from jaxtyping import Bool, Float, Int
from scipy.sparse.linalg import eigsh

from garmentbench.geometry.cloth_rest import cloth_at_rest, rest_areas, rest_lengths
from garmentbench.geometry.weld import weld
from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import Garment

# [rad] An edge that the rest shape bends by more is a crease. Below, what a coarse mesh of a smooth surface has.
CREASE = np.radians(15.0)


@dataclass(frozen=True)
class Fabric:
    """A garment ready for integration, seam copies welded into one particle each (P particles, E edges).

    Attributes:
        particle: Particle of each garment vertex, shape (V,).
        rest: Positions as it is put on [m], shape (P, 3), float64.
        mass: [kg], shape (P,).
        edges: Particle pairs, shape (E, 2).
        length: Lengths without load [m], shape (E,).
        stiffness: Spring constants after the cap [N/m], shape (E,).
        stencils: Particles of each bending stencil, shape (S, 4): an inner edge's ends, then the corners beside it.
        curvature: Their coefficients; the sum of coefficient times position is 0 where the cloth is flat, shape (S, 4).
        bend_stiffness: Stiffness after the cap [N/m], shape (S,).
        rest_angle: Angle by which the rest shape is bent at each stencil's edge [rad], shape (S,); see
            `hinge.hinge_angle`.
        pinned: Whether a particle is held by the collider, shape (P,), bool.
        faces: Particles of each triangle, shape (F, 3).
        corners: The triangles without load, each in a place of its own [m], shape (F, 3, 3).
    """

    particle: Int[np.ndarray, " vertices"]
    rest: Float[np.ndarray, "particles 3"]
    mass: Float[np.ndarray, " particles"]
    edges: Int[np.ndarray, "edges 2"]
    length: Float[np.ndarray, " edges"]
    stiffness: Float[np.ndarray, " edges"]
    stencils: Int[np.ndarray, "stencils 4"]
    curvature: Float[np.ndarray, "stencils 4"]
    bend_stiffness: Float[np.ndarray, " stencils"]
    rest_angle: Float[np.ndarray, " stencils"]
    pinned: Bool[np.ndarray, " particles"]
    faces: Int[np.ndarray, "faces 3"]
    corners: Float[np.ndarray, "faces 3 3"]

    @cached_property
    def creased(self) -> Bool[np.ndarray, " stencils"]:
        """Whether a stencil keeps its angle as a hinge does, shape (S,). The others are flat at rest, near enough."""
        return np.abs(self.rest_angle) > CREASE

    @cached_property
    def bending(self) -> sp.csr_matrix:
        """The matrix that takes positions to minus the bending force of all stencils but the creased ones [N/m], shape
        (P, P); rows sum to 0."""
        return self.bending_of(np.where(self.creased, 0.0, self.bend_stiffness))

    @cached_property
    def squared_frequencies(self) -> tuple[float, float]:
        """Upper bounds of the squared angular frequencies [1/s^2] of stretch and of bending.

        Stretch is bounded for every shape the cloth can take, by letting each spring act in all directions at once.
        """
        count, (a, b), k = len(self.mass), self.edges.T, self.stiffness
        springs = sp.csr_matrix(
            (np.concatenate([k, k, -k, -k]), (np.r_[a, b, a, b], np.r_[a, b, b, a])), shape=(count, count)
        )
        return _largest(springs, self.mass), _largest(self.bending_of(self.bend_stiffness), self.mass)

    def bending_of(self, stiffness: Float[np.ndarray, " stencils"]) -> sp.csr_matrix:
        """The same for these stiffnesses of the stencils [N/m], shape (S,)."""
        count, shape = len(self.stencils), (len(self.stencils), len(self.mass))
        rows = np.repeat(np.arange(count), 4)
        curvature = sp.csr_matrix((self.curvature.ravel(), (rows, self.stencils.ravel())), shape=shape)
        matrix = (curvature.T @ sp.diags(stiffness) @ curvature).tocsr()
        matrix.sort_indices()
        return matrix


def assemble(garment: Garment, material: Material, settings: Settings) -> Fabric:
    """The fabric of a garment. Lengths, areas, masses and cotangents are those of its cloth without load."""
    particle, count = weld(len(garment.rest), garment.seams)
    rest = np.zeros((count, 3))
    np.add.at(rest, particle, garment.rest.astype(np.float64))
    rest /= np.bincount(particle)[:, None]
    faces = particle[garment.faces]
    area, corners = rest_areas(garment), cloth_at_rest(garment)[garment.faces]
    mass = np.zeros(count)
    np.add.at(mass, faces.ravel(), np.repeat(material.density * area / 3, 3))
    mass = np.maximum(mass, settings.mass_floor * np.median(mass))
    edges, edge_area, stencils, halves = _edges(faces, area)
    length = _lengths(garment, particle)
    stiffness = material.stretch * edge_area / length**2
    pair = 1 / mass[edges]
    stiffness = _cap(stiffness, 1 / pair.sum(axis=1), settings.stretch_cap)
    pinned = np.zeros(count, bool)
    pinned[particle[garment.pins]] = True
    curvature = _curvature(corners, faces, stencils, halves)
    around = area[halves % len(faces)].sum(axis=1)
    bend_stiffness = _cap(material.bending / around, 1 / (curvature**2 / mass[stencils]).sum(axis=1), settings.bend_cap)
    angle = np.zeros(len(stencils)) if garment.cut is not None else _angles(rest, stencils)
    return Fabric(
        particle,
        rest,
        mass,
        edges,
        length,
        stiffness,
        stencils,
        curvature,
        bend_stiffness,
        angle,
        pinned,
        faces,
        corners,
    )


def _lengths(garment: Garment, particle: np.ndarray) -> np.ndarray:
    """Length without load of each edge between particles [m], shape (E,), the edges in the order of `_edges`."""
    edges, lengths = rest_lengths(garment)
    _, first = np.unique(np.sort(particle[edges], axis=1), axis=0, return_index=True)
    return lengths[first]


def _edges(faces: np.ndarray, area: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Edges (E, 2), their areas (E,) [m^2] (a third of each triangle beside it), and stencils (S, 4) for bending.

    A stencil is an inner edge's two ends, then the two corners opposite to it. Last, the two triangles' sides that meet
    there, shape (S, 2): side k F + f goes from corner k of triangle f to the next.
    """
    corners = np.concatenate([faces[:, [0, 1, 2]], faces[:, [1, 2, 0]], faces[:, [2, 0, 1]]])
    ends = np.sort(corners[:, :2], axis=1)
    edges, index = np.unique(ends, axis=0, return_inverse=True)
    index = index.ravel()
    edge_area = np.bincount(index, np.tile(area / 3, 3))
    order = np.argsort(index, kind="stable")
    same = index[order][1:] == index[order][:-1]
    first, second = order[:-1][same], order[1:][same]
    stencils = np.column_stack([edges[index[first]], corners[first, 2], corners[second, 2]])
    return edges.astype(np.int32), edge_area, stencils, np.column_stack([first, second])


def _cap(stiffness: np.ndarray, inertia: np.ndarray, multiple: float) -> np.ndarray:
    """Stiffness lowered so that no squared frequency stiffness / inertia passes (multiple x median frequency)^2."""
    if len(stiffness) == 0:
        return stiffness
    return np.minimum(stiffness, multiple**2 * np.median(stiffness / inertia) * inertia)


def _curvature(corners: np.ndarray, faces: np.ndarray, stencils: np.ndarray, halves: np.ndarray) -> np.ndarray:
    """Isometric bending from cotangents without load (Bergou et al. 2006): coefficients, shape (S, 4).

    What divides the flexural rigidity is the area of both triangles. Bergou's factor 3 is left out: with it,
    equilateral triangles bent to a cylinder are three times too stiff.
    """
    following, before = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cotangents = _cot(following, before)
    side, face = np.divmod(halves, len(faces))
    forward = faces[face, side] == stencils[:, :1]  # does the triangle's side go from the stencil's first end?
    begin, end = cotangents[face, side], cotangents[face, (side + 1) % 3]
    (at0, other0), (at1, other1) = np.where(forward, begin, end).T, np.where(forward, end, begin).T
    return np.column_stack([at1 + other1, at0 + other0, -at0 - at1, -other0 - other1])


def _angles(rest: np.ndarray, stencils: np.ndarray) -> np.ndarray:
    """Signed angle between the two faces of each stencil [rad], shape (S,): 0 where they lie in one plane."""
    x0, x1, x2, x3 = rest[stencils].transpose(1, 0, 2)
    first, second, edge = np.cross(x2 - x0, x2 - x1), np.cross(x3 - x1, x3 - x0), x1 - x0
    length = np.linalg.norm(edge, axis=1)
    return np.arctan2((np.cross(first, second) * edge).sum(axis=1), length * (first * second).sum(axis=1))


def _cot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return (a * b).sum(axis=-1) / np.maximum(np.linalg.norm(np.cross(a, b), axis=-1), 1e-12)


def _largest(matrix: sp.csr_matrix, mass: np.ndarray) -> float:
    """Largest eigenvalue of M^-1 K."""
    if matrix.nnz == 0:
        return 0.0
    root = sp.diags(1 / np.sqrt(mass))
    start = np.random.default_rng(0).standard_normal(len(mass))
    options: dict = {"which": "LA", "v0": start, "tol": 1e-3, "return_eigenvectors": False}
    return float(eigsh(root @ matrix @ root, k=1, **options)[0])
