"""The body's motion on the device: frames in, a Warp mesh that follows them out."""

import numpy as np
import warp as wp

from garmentbench.simulation.contact import Surface, attach, move_surface
from garmentbench.simulation.kernels import Cloth


class Collider:
    """A surface that moves from frame to frame.

    Args:
        faces: Triangles, shape (K, 3), outward orientation.
        points: First positions [m], local axes, shape (B, 3).
        cloth: What it holds and touches; its pinned particles are fastened where they are now.
        device: Warp device.
    """

    def __init__(self, faces: np.ndarray, points: np.ndarray, cloth: Cloth, device: str) -> None:
        self.device = device
        count = len(points)
        self.count = count
        s = self.surface = Surface()
        for name in ("p0", "p1", "m0", "m1", "velocities"):
            setattr(s, name, wp.zeros(count, dtype=wp.vec3, device=device))
        s.points = wp.array(points.astype(np.float32), dtype=wp.vec3, device=device)
        s.wind = wp.zeros(1, dtype=wp.vec3, device=device)
        s.hold_face = wp.zeros(len(cloth.x), dtype=int, device=device)
        s.hold_at = wp.zeros(len(cloth.x), dtype=wp.vec3, device=device)
        self.faces = wp.array(faces.astype(np.int32).ravel(), dtype=int, device=device)
        self.mesh = wp.Mesh(points=s.points, indices=self.faces, velocities=s.velocities)
        wp.launch(attach, dim=len(cloth.x), inputs=[self.mesh.id, s, self.faces, cloth], device=device)

    def set_frame(self, p0: np.ndarray, p1: np.ndarray, m0: np.ndarray, m1: np.ndarray, wind: np.ndarray) -> None:
        """Positions at the two ends of a frame, tangents there [m a frame], each (B, 3); the wind [m/s], shape (3,)."""
        s = self.surface
        for array, values in ((s.p0, p0), (s.p1, p1), (s.m0, m0), (s.m1, m1), (s.wind, wind[None])):
            array.assign(values.astype(np.float32))

    def move_to(self, u0: float, u1: float, interval: float) -> None:
        """Bring the mesh to the fraction u0 of the frame; its velocities lead to u1."""
        wp.launch(move_surface, dim=self.count, inputs=[self.surface, u0, u1, interval], device=self.device)
        self.mesh.refit()
