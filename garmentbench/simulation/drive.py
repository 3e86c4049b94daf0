"""Drive the solver through a motion, frame by frame, and watch the cloth's strain."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import Body, Garment
from garmentbench.simulation.assembly import Fabric, assemble
from garmentbench.simulation.cloth import Solver
from garmentbench.simulation.ensemble import Push
from garmentbench.simulation.obstacle import Obstacle
from garmentbench.simulation.time_step import substeps
from garmentbench.simulation.xpbd import XpbdSolver

OK, UNSTABLE = "ok", "unstable"
# 99th percentile of edge strain; an unstable run shows so, it does not become NaN. A bodysuit over raised arms: 0.2.
STRAIN_LIMIT = 0.30
GRID = 0.25  # [m] the local origin follows the body in such steps, which float32 subtracts without loss


@dataclass
class Simulated:
    """The result of a simulation, over all T frames including the warm-up.

    Attributes:
        fabric: What was simulated.
        positions: Garment vertices [m], world axes, shape (T, V, 3), float64 (float32 digits round a local origin).
        strain: Mean and 99th percentile of |edge strain| of each frame, shape (T, 2).
        kinetic: Kinetic energy of each frame [J], shape (T,).
        substeps: A frame.
        ms_per_frame: Wall time [ms], without the first frame (which may compile).
        first_bad_frame: The first that is not finite or strained beyond `STRAIN_LIMIT`, or None.
    """

    fabric: Fabric = field(repr=False)
    positions: Float[np.ndarray, "frames vertices 3"]
    strain: Float[np.ndarray, "frames 2"]
    kinetic: Float[np.ndarray, " frames"]
    substeps: int
    ms_per_frame: float = 0.0
    first_bad_frame: int | None = None

    @property
    def status(self) -> str:
        """`OK` or `UNSTABLE`."""
        return OK if self.first_bad_frame is None else UNSTABLE

    def note(self, t: int, solver: Solver, origin: np.ndarray) -> None:
        """Take frame t from the solver, whose local origin is `origin` [m]."""
        x, v = solver.positions, solver.velocities.astype(np.float64)
        self.positions[t] = x[self.fabric.particle] + origin
        self.strain[t] = _strain(self.fabric, x)
        self.kinetic[t] = 0.5 * self.fabric.mass @ (v**2).sum(axis=1)
        if self.first_bad_frame is None and not self.strain[t, 1] <= STRAIN_LIMIT:
            self.first_bad_frame = t


def drive(
    garment: Garment,
    start: Float[np.ndarray, "vertices 3"],
    body: Body | None,
    frames: Float[np.ndarray, "frames body_vertices 3"] | int,
    fps: float,
    material: Material,
    settings: Settings,
    device: str = "cpu",
    serial: bool | None = None,
    budget: int | None = None,
    inner: tuple[Body, Float[np.ndarray, "frames inner_vertices 3"]] | None = None,
    push: Push | None = None,
    step: Callable[[], None] = lambda: None,
) -> Simulated:
    """Simulate a garment on a moving body.

    Args:
        garment: Template; its rest shape is the fabric's.
        start: First positions [m], world axes, shape (V, 3); it starts at rest.
        body: Template of what it is worn by, or None.
        frames: Body positions [m], shape (T, B, 3), float64; without a body, the number of frames.
        fps: Frames a second.
        material, settings: As resolved for the scene.
        device, serial: See `Solver`.
        budget: Use XPBD with this many substeps a frame instead of the reference solver with as many as it needs.
        inner: The garment beneath as a body, and its positions [m], shape (T, B', 3), float64.
        push: The cloth is pushed in that frame.
        step: Called after each frame.
    """
    fabric = assemble(garment, material, settings)
    obstacle, origins = _surroundings(start, body, frames, inner)
    count = len(origins)
    first = _first(fabric, start - origins[0], settings, push)
    touched = None if obstacle is None else (obstacle.surfaces, obstacle.positions[0] - origins[0])
    if budget is None:
        kind, n = Solver, substeps(fabric, material, settings, 1 / fps)
    else:
        kind, n = XpbdSolver, budget
        settings = replace(settings, queries=math.gcd(settings.queries, budget))
    solver = kind(fabric, first, touched, material, settings, n, 1 / fps, device, serial)
    out = Simulated(fabric, np.zeros((count, *garment.rest.shape)), np.zeros((count, 2)), np.zeros(count), n)
    out.positions[0] = first[fabric.particle] + origins[0]
    begin = time.perf_counter()
    for t in range(1, count):
        if obstacle is not None and solver.collider is not None:
            solver.collider.set_frame(*obstacle.between(t - 1, origins[t - 1], fps))
        solver.advance()
        if push is not None and push.frame == t:
            solver.push(push.offsets(solver.positions, fabric.pinned))
        out.note(t, solver, origins[t - 1])
        if np.any(origins[t] != origins[t - 1]):
            solver.shift(origins[t] - origins[t - 1])
        if t == 1:
            begin = time.perf_counter()
        step()
    out.ms_per_frame = 1e3 * (time.perf_counter() - begin) / max(count - 2, 1)
    return out


def _surroundings(
    start: np.ndarray, body: Body | None, frames: np.ndarray | int, inner: tuple[Body, np.ndarray] | None
) -> tuple[Obstacle | None, np.ndarray]:
    """What the garment touches, as `drive` is given it, and the local origin of each frame, shape (T, 3), float64."""
    if isinstance(frames, int):
        return None, np.tile(start.astype(np.float64).mean(axis=0), (frames, 1))
    assert body is not None, "positions without a body's template"
    obstacle = Obstacle.of(body, frames, inner)
    return obstacle, _origins(obstacle)


def _first(fabric: Fabric, start: np.ndarray, settings: Settings, push: Push | None) -> np.ndarray:
    """First positions of the particles [m], shape (P, 3), of those of the garment's vertices, local axes, (V, 3)."""
    first = np.zeros_like(fabric.rest)
    first[fabric.particle] = start + _noise(fabric, settings)[fabric.particle]
    if push is not None and push.frame == 0:
        first += push.offsets(first, fabric.pinned)
    return first


def _origins(obstacle: Obstacle) -> np.ndarray:
    """A local origin for each frame, shape (T, 3), float64: follows the body's centre on a grid."""
    centres = np.array([f.mean(axis=0) for f in obstacle.positions[:, : obstacle.skin]])
    return centres[0] + GRID * np.round((centres - centres[0]) / GRID)


def _noise(fabric: Fabric, settings: Settings) -> np.ndarray:
    """A push of length `start_noise` for each particle, in random directions, shape (P, 3). Pinned ones stay where they
    are: they would be held there for ever, and the scene would be another."""
    push = np.random.default_rng(settings.noise_seed).standard_normal(fabric.rest.shape)
    push *= settings.start_noise / np.linalg.norm(push, axis=1, keepdims=True)
    return np.where(fabric.pinned[:, None], 0.0, push)


def _strain(fabric: Fabric, x: np.ndarray) -> tuple[float, float]:
    a, b = fabric.edges.T
    strain = np.abs(np.linalg.norm(x[b] - x[a], axis=1) / fabric.length - 1)
    return float(strain.mean()), float(np.percentile(strain, 99))
