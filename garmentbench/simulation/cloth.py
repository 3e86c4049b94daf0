"""The solver: a fabric and a collider on one device, advanced frame by frame."""

import math

import numpy as np
import warp as wp
from jaxtyping import Float

from garmentbench.scenes.material import Material, Settings
from garmentbench.simulation.assembly import Fabric
from garmentbench.simulation.collider import Collider
from garmentbench.simulation.contacts.contact_set import ContactSet
from garmentbench.simulation.damping import BendDamping
from garmentbench.simulation.integrate import accelerate_pass, advance_serial, area_pass, force_pass, move_pass
from garmentbench.simulation.kernels import Cloth, Contact, Physics
from garmentbench.simulation.recording import Recorded
from garmentbench.simulation.time_step import damping_stages, stretch_damping


class Solver:
    """Particles under way.

    Args:
        fabric: What is simulated.
        start: First particle positions [m], local axes, shape (P, 3).
        touched: Surfaces, faces (K, 3) each, and first positions [m], local axes, (B, 3), of what it touches; or None.
        substeps: A frame, a multiple of `settings.queries`.
        frame_time: Of one frame [s].
        device: Warp device.
        serial: One launch of one thread for all substeps between two queries, or passes of parallel threads in each
            substep. The result is the same. None: serial on a CPU (no launch storm), parallel on CUDA.
    """

    LAG = 0.5  # substeps that velocities are behind positions

    def __init__(
        self,
        fabric: Fabric,
        start: Float[np.ndarray, "particles 3"],
        touched: tuple[tuple[np.ndarray, ...], np.ndarray] | None,
        material: Material,
        settings: Settings,
        substeps: int,
        frame_time: float,
        device: str = "cpu",
        serial: bool | None = None,
    ) -> None:
        self.device = device
        self.serial = not wp.get_device(device).is_cuda if serial is None else serial
        self.queries, self.frame_time = settings.queries, frame_time
        self.steps = substeps // settings.queries
        self.cloth = _cloth(fabric, start, device)
        self.contact = _contact(start, device)
        stretch, bend = fabric.squared_frequencies
        self.physics = _physics(material, settings, frame_time / substeps, stretch_damping(material, stretch))
        interval = frame_time / settings.queries
        self.damping = None
        if stages := damping_stages(material.bend_damping, bend, interval):
            lag = self.LAG * self.physics.dt
            self.damping = BendDamping(
                self.cloth, self.physics, material.bend_damping, interval, lag, stages, device, self.serial
            )
        self.collider = None if touched is None else Collider(*touched, self.cloth, device)
        self.shared = ContactSet(fabric, self.cloth, self.contact, self.collider, self.physics, settings, device)
        self._recorded = [(Recorded(device), Recorded(device)) for _ in range(self.queries)]

    @property
    def positions(self) -> Float[np.ndarray, "particles 3"]:
        """Particle positions [m], local axes, shape (P, 3), float32."""
        return self.cloth.x.numpy()

    @property
    def velocities(self) -> Float[np.ndarray, "particles 3"]:
        """Particle velocities [m/s], shape (P, 3), float32."""
        return self.cloth.v.numpy()

    def shift(self, offset: Float[np.ndarray, "3"]) -> None:
        """Move the origin by `offset` [m], shape (3,), so that positions stay small and float32 precise."""
        self.cloth.x.assign(self.positions - offset.astype(np.float32))

    def push(self, offsets: Float[np.ndarray, "particles 3"]) -> None:
        """Move each particle by its offset [m], shape (P, 3), without a change of its velocity."""
        self.cloth.x.assign(self.positions + offsets.astype(np.float32))

    def advance(self) -> None:
        """One frame. The collider must hold that frame already."""
        for q, (move, go_on) in enumerate(self._recorded):
            if self.collider is not None:
                move.run(self._move, q)
                self.collider.refit()
            go_on.run(self._go_on, q)

    def _move(self, query: int) -> None:
        """Bring the collider to the time of a query, but for its meshes' boxes."""
        assert self.collider is not None
        self.collider.move_to(query / self.queries, (query + 1) / self.queries, self.frame_time / self.queries)

    def _go_on(self, query: int) -> None:
        """From a query to the next."""
        if self.collider is not None:
            self.collider.touch(self.contact, self.frame_time / self.queries)
        self.shared.update(query, self.frame_time)
        self._launch(area_pass, len(self.cloth.x), [self.cloth])
        if self.damping is not None:
            self.damping.apply()
        self._integrate()

    def _integrate(self) -> None:
        """All substeps up to the next query."""
        cloth, contact, physics, particles = self.cloth, self.contact, self.physics, len(self.cloth.x)
        if self.serial:
            inputs = [cloth, contact, self.shared.contacts.constraints, physics, self.steps]
            self._launch(advance_serial, 1, inputs)
        else:
            for s in range(self.steps):
                self._launch(force_pass, max(len(cloth.ends), len(cloth.crease), particles), [cloth, physics])
                self._launch(accelerate_pass, particles, [cloth, contact, physics])
                self.shared.contacts.resolve(cloth, physics, s)
                self._launch(move_pass, particles, [cloth, contact, physics, s])

    def _launch(self, kernel: wp.Kernel, dim: int, inputs: list) -> None:
        wp.launch(kernel, dim=dim, inputs=inputs, device=self.device)


def _cloth(fabric: Fabric, start: np.ndarray, device: str) -> Cloth:
    count, edges = len(fabric.mass), len(fabric.edges)
    first, second = fabric.edges.T
    edge_start, order = _rows(np.concatenate([first, second]), count)
    creases = fabric.stencils[fabric.creased]
    length = np.linalg.norm(fabric.rest[creases[:, 1]] - fabric.rest[creases[:, 0]], axis=1)
    crease_start, crease_index = _rows(creases.ravel(), count)
    face_start, corner = _rows(fabric.faces.ravel(), count)
    c = Cloth()
    for name, values, kind in (
        ("x", start, wp.vec3),
        ("v", np.zeros((count, 3)), wp.vec3),
        ("y", start, wp.vec3),
        ("inverse_mass", 1 / fabric.mass, float),
        ("pinned", fabric.pinned, int),
        ("ends", fabric.edges, wp.vec2i),
        ("length", fabric.length, float),
        ("stiffness", fabric.stiffness, float),
        ("force", np.zeros((edges, 3)), wp.vec3),
        ("edge_start", edge_start, int),
        ("edge_index", order % edges, int),
        ("edge_sign", np.where(order < edges, 1.0, -1.0), float),
        ("bend_start", fabric.bending.indptr, int),
        ("bend_column", fabric.bending.indices, int),
        ("bend_value", fabric.bending.data, float),
        ("crease", creases, wp.vec4i),
        # The same stiffness against small bends as the flat stencil's, whose sum is length times angle.
        ("crease_stiffness", fabric.bend_stiffness[fabric.creased] * length**2, float),
        ("crease_angle", fabric.rest_angle[fabric.creased], float),
        ("crease_square", _squares(fabric.rest, creases), wp.vec2),
        ("crease_force", np.zeros((4 * len(creases), 3)), wp.vec3),
        ("crease_start", crease_start, int),
        ("crease_index", crease_index, int),
        ("faces", fabric.faces, wp.vec3i),
        ("face_start", face_start, int),
        ("face_index", corner // 3, int),
        ("area", np.zeros((count, 3)), wp.vec3),
    ):
        setattr(c, name, device_array(values, kind, device))
    return c


def _rows(particle: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """For each particle where its entries start, shape (count + 1,), and the entries in that order."""
    order = np.argsort(particle, kind="stable")
    return np.searchsorted(particle[order], np.arange(count + 1)), order


def _squares(rest: np.ndarray, creases: np.ndarray) -> np.ndarray:
    x0, x1, x2, x3 = rest[creases].transpose(1, 0, 2)
    normals = np.stack([np.cross(x2 - x0, x2 - x1), np.cross(x3 - x1, x3 - x0)], axis=1)
    return (normals**2).sum(axis=2)


def _contact(start: np.ndarray, device: str) -> Contact:
    count, h = len(start), Contact()
    for name in ("normal", "velocity", "air"):
        setattr(h, name, wp.zeros(count, dtype=wp.vec3, device=device))
    h.point = device_array(start, wp.vec3, device)  # where a pinned particle stays if there is no collider
    h.active = wp.zeros(count, dtype=int, device=device)
    h.distance = wp.zeros(count, dtype=float, device=device)
    return h


def _physics(material: Material, settings: Settings, dt: float, stretch_damping: float) -> Physics:
    p = Physics()
    p.dt, p.stretch_damping = dt, stretch_damping
    p.drag, p.drag_along = (0.5 * settings.air_density * d for d in (material.drag, material.drag_along))
    p.settle_keep = math.exp(-settings.settling * dt)
    for source, names in (
        (material, ("compression", "friction", "thickness")),
        (settings, ("gravity", "contact_frequency", "contact_damping", "contact_depth")),
    ):
        for name in names:
            setattr(p, name, getattr(source, name))
    return p


def device_array(values: np.ndarray, kind: type, device: str) -> wp.array:
    """A Warp array of scalars or small vectors."""
    number = np.float32 if kind in (float, wp.vec2, wp.vec3, wp.vec4) else np.int32
    return wp.array(np.ascontiguousarray(values, number), dtype=kind, device=device)
