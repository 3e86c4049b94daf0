"""A garment in Newton's VBD solver (vertex block descent, Chen et al. 2024): implicit, other elements, other contact.

What it shares with the reference is what is given: rest shape, masses, start, the body's motion and the air. Its own
are the elements (neo-Hookean triangles, dihedral bending), the integrator (implicit Euler) and the contact (a penalty
at the nearest point, smoothed friction; where cloth touches itself a bound on how far it goes in a substep, which too
few substeps turn into drag).
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from garmentbench.errors import UserError
from garmentbench.evals.crosscheck.hold import fasten, hermite
from garmentbench.evals.crosscheck.model import VbdSettings, newton_model
from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import Garment
from garmentbench.simulation.assembly import Fabric, assemble
from garmentbench.simulation.obstacle import Obstacle

AIR_REACH = 0.06  # [m] as in the reference: from here on the air moves with the body as a whole


@dataclass(frozen=True)
class VbdRun:
    """The result: garment positions [m], shape (T, V, 3), float32, and wall time a frame [ms] but the first's."""

    positions: np.ndarray
    ms_per_frame: float


def require_newton() -> None:
    """Raises `UserError` with what to do where Newton isn't installed."""
    from importlib.util import find_spec

    if find_spec("newton") is None:
        raise UserError(
            "the cross-check needs the package newton, which is not installed; `make crosscheck` brings it, or "
            "pip install -c constraints.txt -e '.[crosscheck]'"
        )


def drive_vbd(
    garment: Garment,
    start: np.ndarray,
    obstacle: Obstacle | None,
    frames: int,
    fps: float,
    material: Material,
    settings: Settings,
    vbd: VbdSettings,
    step: Callable[[], None] = lambda: None,
) -> VbdRun:
    """Simulate a garment on what it touches with VBD, on the CPU.

    Args:
        garment: Template; its rest shape is the fabric's. Its pinned vertices are held by the obstacle, or where they
            are.
        start: First positions [m], world axes, shape (V, 3); it starts at rest.
        obstacle: What it touches, or None.
        frames: How many, the first included.
        fps: Frames a second.
        material, settings: As of the reference.
        vbd: The other engine's own.
        step: Called after each frame.

    Raises `UserError` without Newton.
    """
    require_newton()
    fabric = assemble(garment, material, settings)
    world = _World(fabric, fabric.particle[garment.faces], _particles(fabric, start), obstacle, material, settings, vbd)
    positions = np.empty((frames, *garment.rest.shape), np.float32)
    positions[0] = start
    begin = time.perf_counter()
    for t in range(1, frames):
        world.advance(t - 1, fps)
        positions[t] = world.state.particle_q.numpy()[fabric.particle]
        if t == 1:
            begin = time.perf_counter()  # the first frame may compile
        step()
    return VbdRun(positions, 1e3 * (time.perf_counter() - begin) / max(frames - 2, 1))


def _particles(fabric: Fabric, start: np.ndarray) -> np.ndarray:
    """First particle positions [m], shape (P, 3), of vertex positions, shape (V, 3)."""
    first = np.zeros_like(fabric.rest)
    first[fabric.particle] = start
    return first


class _World:
    """Newton's model, its solver, and two states in turn."""

    def __init__(
        self,
        fabric: Fabric,
        faces: np.ndarray,
        start: np.ndarray,
        obstacle: Obstacle | None,
        material: Material,
        settings: Settings,
        vbd: VbdSettings,
    ) -> None:
        import newton
        import warp as wp

        self.vbd, self.faces, self.mass = vbd, faces, fabric.mass.astype(np.float32)
        self.drag = [0.5 * settings.air_density * d for d in (material.drag, material.drag_along)]
        self.settling = settings.settling
        self.obstacle = obstacle
        self.contacts: Any = None
        self.pins = np.flatnonzero(fabric.pinned)
        with wp.ScopedDevice("cpu"):
            self.model, self.meshes = newton_model(fabric, faces, obstacle, material, settings, vbd)
            near = {"particle_self_contact_margin": material.thickness, "particle_self_contact_gap": material.thickness}
            touches = {"particle_enable_self_contact": True, **near} if settings.self_contact else {}
            self.solver = newton.solvers.SolverVBD(self.model, iterations=vbd.iterations, **touches)
            self.control = self.model.control()
            self.state: Any = self.model.state()  # whose arrays are all typed as perhaps absent
            self.next: Any = self.model.state()
            for state in (self.state, self.next):
                state.particle_q.assign(start.astype(np.float32))
            if obstacle is not None:
                self.held = fasten(start[self.pins], np.concatenate(obstacle.surfaces), obstacle.positions[0])
                self.pipeline = newton.CollisionPipeline(self.model, soft_contact_gap=AIR_REACH)
                self.contacts = self.pipeline.contacts()

    def advance(self, frame: int, fps: float) -> None:
        """One frame, from `frame` to the next."""
        import warp as wp

        n, wind = self.vbd.substeps, np.zeros(3)
        dt = 1 / fps / n
        if self.obstacle is not None:
            p0, p1, v0, v1, wind = self.obstacle.between(frame, np.zeros(3), fps)
            way = [hermite(p0, p1, v0, v1, s / n) for s in range(n + 1)]
        with wp.ScopedDevice("cpu"):
            for s in range(n):
                if self.obstacle is not None:
                    self._move_obstacle(way[s], way[s + 1], dt)
                self.state.particle_f.assign(self._drag(wind))
                self.solver.step(self.state, self.next, self.control, self.contacts, dt)
                self.state, self.next = self.next, self.state

    def _move_obstacle(self, before: np.ndarray, after: np.ndarray, dt: float) -> None:
        """The obstacle where it is at the end of the substep (VBD is implicit), what it holds, and the contacts
        there."""
        mesh: Any
        for mesh in self.meshes:
            mesh.points.assign(after.astype(np.float32))
            mesh.velocities.assign(((after - before) / dt).astype(np.float32))
            mesh.refit()
        if len(self.pins):
            q = self.state.particle_q.numpy()
            q[self.pins] = self.held.at(after)
            self.state.particle_q.assign(q)
        self.pipeline.collide(self.state, self.contacts)

    def _drag(self, wind: np.ndarray) -> np.ndarray:
        """Force of the air [N], shape (P, 3).

        It moves with the skin at the skin and with the wind [m/s] away from it.
        """
        x, v = self.state.particle_q.numpy(), self.state.particle_qd.numpy()
        air = np.tile(wind.astype(np.float32), (len(x), 1))
        if self.contacts is not None:
            c, count = self.contacts, int(self.contacts.soft_contact_count.numpy()[0])
            near = c.soft_contact_particle.numpy()[:count]
            skin = c.soft_contact_body_vel.numpy()[:count]
            distance = np.linalg.norm(x[near] - c.soft_contact_body_pos.numpy()[:count], axis=1, keepdims=True)
            air[near] = skin + np.minimum(distance / AIR_REACH, 1) * (wind.astype(np.float32) - skin)
        area = _areas(x, self.faces)
        size = np.linalg.norm(area, axis=1, keepdims=True)
        normal, u = area / np.maximum(size, 1e-12), air - v
        across = (u * normal).sum(axis=1, keepdims=True)
        along = u - across * normal
        force = self.drag[0] * np.abs(across) * across * normal
        force += self.drag[1] * np.linalg.norm(along, axis=1, keepdims=True) * along
        return (size * force + self.settling * self.mass[:, None] * u).astype(np.float32)


def _areas(x: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """A third of the areas of the faces round each particle, times their normals [m^2], shape (P, 3)."""
    a, b, c = x[faces].transpose(1, 0, 2)
    out = np.zeros_like(x)
    np.add.at(out, faces.ravel(), np.repeat(np.cross(b - a, c - a) / 6, 3, axis=0))
    return out
