"""A fabric in Newton's terms: neo-Hookean triangles and hinges, with the same masses and the stiffness that follows."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from garmentbench.scenes.material import Material, Settings
from garmentbench.simulation.assembly import Fabric
from garmentbench.simulation.obstacle import Obstacle

if TYPE_CHECKING:
    import newton
    import warp as wp


@dataclass(frozen=True)
class VbdSettings:
    """The other engine's numerics, and what the strips found for its material.

    Substeps help more than iterations at the same cost: a strip of 20 triangles hangs 2.6 times too far at 10 x 10, 1.2
    times at 20 x 10 and 1.06 times at 40 x 5.

    Attributes:
        substeps: A frame.
        iterations: Passes over all vertices a substep.
        membrane: Times the Lamé parameters that follow from the material's `stretch`.
        bending: Times the hinge stiffness that follows from the material's `bending`.
    """

    substeps: int = 25
    iterations: int = 4
    membrane: float = 1.0
    bending: float = 1.0


def newton_model(
    fabric: Fabric,
    faces: np.ndarray,
    obstacle: Obstacle | None,
    material: Material,
    settings: Settings,
    vbd: VbdSettings,
) -> tuple["newton.Model", list["wp.Mesh"]]:
    """Newton's model of a fabric at rest, flat at rest in bending as the reference, and the obstacle's Warp meshes.

    Args:
        fabric: Particles, masses and bending of the reference.
        faces: Triangles of particles, shape (F, 3).
        obstacle: What the fabric touches, or None.
        material, settings: As of the reference.
        vbd: Scales the stiffness.
    """
    import newton
    import warp as wp

    # On equilateral triangles springs of modulus s make a sheet with E = s / 3, nu = 1 / 3: both its Lamé parameters
    # are s / 8.
    lame = vbd.membrane * material.stretch / 8
    count = len(fabric.mass)
    stiffness = float(np.median(fabric.mass)) * settings.contact_frequency**2
    damping = 2 * settings.contact_damping * float(np.median(fabric.mass)) * settings.contact_frequency
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, -settings.gravity))
    builder.add_cloth_mesh(
        pos=wp.vec3(0.0),
        rot=wp.quat_identity(),
        scale=1.0,
        vel=wp.vec3(0.0),
        vertices=fabric.rest.tolist(),
        indices=faces.ravel().tolist(),
        density=material.density,
        tri_ke=lame,
        tri_ka=lame,
        tri_kd=material.stretch_damping * lame / 4,  # it damps C = F^T F, about twice the strain
        tri_drag=0.0,
        tri_lift=0.0,
        edge_ke=0.0,
        edge_kd=0.0,
        particle_radius=material.thickness,
    )
    for p, mass in enumerate(fabric.mass):
        builder.particle_mass[p] = float(mass)
    for p in np.flatnonzero(fabric.pinned):
        builder.particle_flags[p] = int(builder.particle_flags[p]) & ~int(newton.ParticleFlags.ACTIVE)
    meshes = []
    for surface, at in [] if obstacle is None else [(s, obstacle.positions[0]) for s in obstacle.surfaces]:
        meshes.append(newton.Mesh(at.astype(np.float32), surface.ravel(), compute_inertia=False))
        contact = newton.ModelBuilder.ShapeConfig(ke=stiffness, kd=damping, mu=material.friction)
        builder.add_shape_mesh(-1, mesh=meshes[-1], cfg=contact)
    builder.color(include_bending=True)
    model: Any = builder.finalize(device="cpu")  # whose arrays are all typed as perhaps absent
    model.soft_contact_ke, model.soft_contact_kd, model.soft_contact_mu = stiffness, damping, material.friction
    _cut_to_pattern(model, fabric)
    hinge = vbd.bending * hinge_stiffness(fabric, model.edge_indices.numpy())
    model.edge_bending_properties.assign(np.stack([hinge, material.bend_damping * hinge], axis=1).astype(np.float32))
    creased = np.isin(
        _edge_key(model.edge_indices.numpy()[:, 2:], count), _edge_key(fabric.stencils[fabric.creased, :2], count)
    )
    model.edge_rest_angle.assign(np.where(creased, model.edge_rest_angle.numpy(), 0.0).astype(np.float32))
    if meshes:
        model.shape_collision_aabb_lower.fill_(-1e3)  # a mesh moves: its first box must not hide it
        model.shape_collision_aabb_upper.fill_(1e3)
    return model, [mesh.mesh for mesh in meshes]


def _cut_to_pattern(model: Any, fabric: Fabric) -> None:
    """Give triangles and hinges their sizes without load; Newton took them from the shape in which cloth is put on."""
    b, c = (fabric.corners[:, k] - fabric.corners[:, 0] for k in (1, 2))
    width, area = np.linalg.norm(b, axis=1), np.linalg.norm(np.cross(b, c), axis=1) / 2
    along = (b * c).sum(axis=1) / width
    sides = np.stack([np.stack([width, along], axis=1), np.stack([0 * width, 2 * area / width], axis=1)], axis=1)
    model.tri_poses.assign(np.linalg.inv(sides).astype(np.float32))
    model.tri_areas.assign(area.astype(np.float32))
    model.edge_rest_length.assign(rest_length(fabric, model.edge_indices.numpy()[:, 2:]).astype(np.float32))


def rest_length(fabric: Fabric, ends: np.ndarray) -> np.ndarray:
    """Lengths without load [m], shape (N,), of edges given by the particles at their ends, shape (N, 2)."""
    count = len(fabric.mass)
    own, asked = (np.sort(pairs, axis=1).astype(np.int64) @ [count, 1] for pairs in (fabric.edges, ends))
    return fabric.length[np.searchsorted(own, asked)]


def hinge_stiffness(fabric: Fabric, edges: np.ndarray) -> np.ndarray:
    """Stiffness of Newton's hinges [N], shape (E,), edges as (corner, corner, end, end), shape (E, 4); 0 at the border.

    A hinge of length l opened by a small angle stores k l angle^2 / 2 there and K l^2 angle^2 / 2 here: k = K l.
    """
    count, ends = len(fabric.mass), fabric.stencils[:, :2]
    own, theirs = _edge_key(ends, count), _edge_key(edges[:, 2:], count)
    length = rest_length(fabric, ends)
    order = np.argsort(own)
    at = np.minimum(np.searchsorted(own[order], theirs), len(own) - 1)
    found = own[order][at] == theirs
    return np.where(found, (fabric.bend_stiffness * length)[order][at], 0.0)


def _edge_key(ends: np.ndarray, count: int) -> np.ndarray:
    """A number for each edge, whichever end comes first; of ends, shape (E, 2), among `count` particles."""
    return np.sort(ends, axis=1).astype(np.int64) @ [count, 1]
