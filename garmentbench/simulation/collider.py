"""The motion of what a garment touches, on the device: frames in, Warp meshes that follow them out."""

import numpy as np
import warp as wp
from jaxtyping import Float

from garmentbench.geometry.mesh import border_vertices
from garmentbench.simulation.contact import Surface, find_contacts, forget_contacts, move_surface
from garmentbench.simulation.holding import Holding, attach, hold
from garmentbench.simulation.kernels import Cloth, Contact


class Collider:
    """Surfaces that move from frame to frame.

    Args:
        surfaces: Triangles of each, from the skin outwards, shape (K, 3) each, outward orientation.
        points: First positions [m], local axes, shape (B, 3).
        cloth: What it holds and touches; its pinned particles are fastened where they are now.
        device: Warp device.
    """

    def __init__(self, surfaces: tuple[np.ndarray, ...], points: np.ndarray, cloth: Cloth, device: str) -> None:
        self.device, self.cloth = device, cloth
        count, particles = len(points), len(cloth.x)
        self.count = count
        s = self.surface = Surface()
        for name in ("p0", "p1", "m0", "m1", "velocities"):
            setattr(s, name, wp.zeros(count, dtype=wp.vec3, device=device))
        s.points = wp.array(points.astype(np.float32), dtype=wp.vec3, device=device)
        s.wind = wp.zeros(1, dtype=wp.vec3, device=device)
        border = np.zeros(count, np.int32)
        for faces in surfaces:
            border[border_vertices(faces)] = 1
        s.border = wp.array(border, dtype=int, device=device)
        self.faces, everything = self._mesh(np.concatenate(surfaces))
        self.holding = _holding(cloth, device)
        inputs = [everything.id, s, self.faces, len(surfaces[0]), cloth, self.holding]
        wp.launch(attach, dim=len(self.holding.pin), inputs=inputs, device=device)
        self.meshes = [self._mesh(faces)[1] for faces in surfaces]
        self.closed = [len(border_vertices(faces)) == 0 for faces in surfaces]
        self.near = self.nothing_near(particles)

    def _mesh(self, faces: np.ndarray) -> tuple[wp.array, wp.Mesh]:
        """The indices and the mesh of some of the faces, over all points."""
        indices = wp.array(faces.astype(np.int32).ravel(), dtype=int, device=self.device)
        return indices, wp.Mesh(points=self.surface.points, indices=indices, velocities=self.surface.velocities)

    def set_frame(
        self,
        p0: Float[np.ndarray, "points 3"],
        p1: Float[np.ndarray, "points 3"],
        m0: Float[np.ndarray, "points 3"],
        m1: Float[np.ndarray, "points 3"],
        wind: Float[np.ndarray, "3"],
    ) -> None:
        """Positions at the two ends of a frame, tangents there [m a frame], each (B, 3); the wind [m/s], shape (3,)."""
        s = self.surface
        for array, values in ((s.p0, p0), (s.p1, p1), (s.m0, m0), (s.m1, m1), (s.wind, wind[None])):
            array.assign(values.astype(np.float32))

    def move_to(self, u0: float, u1: float, interval: float) -> None:
        """Bring the points to the fraction u0 of the frame; their velocities lead to u1. `refit` has to follow."""
        wp.launch(move_surface, dim=self.count, inputs=[self.surface, u0, u1, interval], device=self.device)

    def refit(self) -> None:
        """Bring the meshes to where their points are now."""
        for mesh in self.meshes:
            mesh.refit()

    def touch(self, contact: Contact, interval: float) -> None:
        """Find where each particle touches, for the next `interval` seconds.

        The outermost surface comes first: it mostly is the nearest, and then bounds the search of the others.
        """
        wp.launch(forget_contacts, len(self.cloth.x), [self.surface, self.cloth, contact], device=self.device)
        inputs = [self.surface, self.faces, self.holding, contact, interval]
        wp.launch(hold, len(self.holding.pin), inputs, device=self.device)
        self.find(self.cloth.x, self.cloth.pinned, self.near, contact)

    def nothing_near(self, points: int) -> list[wp.array]:
        """The nearest face of each surface to each point, before any is known."""
        return [wp.full(points, -1, dtype=int, device=self.device) for _ in self.meshes]

    def find(self, points: wp.array, skip: wp.array, near: list[wp.array], contact: Contact) -> None:
        """Find where each point touches that is not skipped; `near` is kept for the next time."""
        for k in reversed(range(len(self.meshes))):
            inputs = [self.meshes[k].id, self.closed[k], self.surface, near[k], points, skip, contact]
            wp.launch(find_contacts, len(points), inputs, device=self.device)


def _holding(cloth: Cloth, device: str) -> Holding:
    h, pins = Holding(), np.flatnonzero(cloth.pinned.numpy())
    h.pin = wp.array(pins, dtype=int, device=device)
    for name, kind in (("face", int), ("at", wp.vec3), ("start", wp.vec3), ("corners", wp.mat33), ("banded", int)):
        setattr(h, name, wp.zeros(len(pins), dtype=kind, device=device))
    return h
