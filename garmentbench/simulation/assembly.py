"""From a garment's template to particles, springs and bending: numpy arrays, made once a simulation."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from jaxtyping import Bool, Float, Int

from garmentbench.geometry.weld import weld
from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import Garment


@dataclass(frozen=True)
class Fabric:
    """A garment ready for integration, seam copies welded into one particle each (P particles, E edges).

    Attributes:
        particle: Particle of each garment vertex, shape (V,).
        rest: Rest positions [m], shape (P, 3), float64.
        mass: [kg], shape (P,).
        edges: Particle pairs, shape (E, 2).
        length: Rest lengths [m], shape (E,).
        stiffness: Spring constants after the cap [N/m], shape (E,).
        stencils: Particles of each bending stencil, shape (S, 4): an inner edge's ends, then the corners beside it.
        curvature: Their coefficients; the sum of coefficient times position is 0 where the cloth is flat, shape (S, 4).
        bend_stiffness: Stiffness after the cap [N/m], shape (S,).
        pinned: Whether a particle is held by the collider, shape (P,), bool.
        faces: Particles of each triangle, shape (F, 3).
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
    pinned: Bool[np.ndarray, " particles"]
    faces: Int[np.ndarray, "faces 3"]

    @cached_property
    def bending(self) -> sp.csr_matrix:
        """The matrix that takes positions to minus the bending force [N/m], shape (P, P); rows sum to 0."""
        count, shape = len(self.stencils), (len(self.stencils), len(self.mass))
        rows = np.repeat(np.arange(count), 4)
        curvature = sp.csr_matrix((self.curvature.ravel(), (rows, self.stencils.ravel())), shape=shape)
        matrix = (curvature.T @ sp.diags(self.bend_stiffness) @ curvature).tocsr()
        matrix.sort_indices()
        return matrix


def assemble(garment: Garment, material: Material, settings: Settings) -> Fabric:
    """The fabric of a garment."""
    particle, count = weld(len(garment.rest), garment.seams)
    rest = np.zeros((count, 3))
    np.add.at(rest, particle, garment.rest.astype(np.float64))
    rest /= np.bincount(particle)[:, None]
    faces = particle[garment.faces]
    area = _areas(rest, faces)
    mass = np.zeros(count)
    np.add.at(mass, faces.ravel(), np.repeat(material.density * area / 3, 3))
    mass = np.maximum(mass, settings.mass_floor * np.median(mass))
    edges, edge_area, stencils = _edges(faces, area)
    length = np.linalg.norm(rest[edges[:, 0]] - rest[edges[:, 1]], axis=1)
    stiffness = material.stretch * edge_area / length**2
    pair = 1 / mass[edges]
    stiffness = _cap(stiffness, 1 / pair.sum(axis=1), settings.stretch_cap)
    pinned = np.zeros(count, bool)
    pinned[particle[garment.pins]] = True
    curvature, area = _curvature(rest, stencils)
    bend_stiffness = _cap(material.bending / area, 1 / (curvature**2 / mass[stencils]).sum(axis=1), settings.bend_cap)
    return Fabric(particle, rest, mass, edges, length, stiffness, stencils, curvature, bend_stiffness, pinned, faces)


def _areas(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    a, b, c = points[faces].transpose(1, 0, 2)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def _edges(faces: np.ndarray, area: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Edges (E, 2), their areas (E,) [m^2] (a third of each triangle beside it), and stencils (S, 4) for bending.

    A stencil is an inner edge's two ends, then the two corners opposite to it.
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
    return edges.astype(np.int32), edge_area, stencils


def _cap(stiffness: np.ndarray, inertia: np.ndarray, multiple: float) -> np.ndarray:
    """Stiffness lowered so that no squared frequency stiffness / inertia passes (multiple x median frequency)^2."""
    if len(stiffness) == 0:
        return stiffness
    return np.minimum(stiffness, multiple**2 * np.median(stiffness / inertia) * inertia)


def _curvature(rest: np.ndarray, stencils: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Isometric bending from cotangents of the rest shape (Bergou et al. 2006).

    Coefficients, shape (S, 4), and areas [m^2], shape (S,), that divide the flexural rigidity. Bergou's factor 3 is
    left out: with it, equilateral triangles bent to a cylinder are three times too stiff.
    """
    x0, x1, x2, x3 = rest[stencils].transpose(1, 0, 2)
    at0, other0 = _cot(x1 - x0, x2 - x0), _cot(x1 - x0, x3 - x0)
    at1, other1 = _cot(x0 - x1, x2 - x1), _cot(x0 - x1, x3 - x1)
    coefficients = np.column_stack([at1 + other1, at0 + other0, -at0 - at1, -other0 - other1])
    return coefficients, _areas(rest, stencils[:, [0, 1, 2]]) + _areas(rest, stencils[:, [0, 1, 3]])


def _cot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return (a * b).sum(axis=1) / np.maximum(np.linalg.norm(np.cross(a, b), axis=1), 1e-12)
