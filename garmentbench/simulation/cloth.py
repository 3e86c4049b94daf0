"""The solver: a fabric and a collider on one device, advanced frame by frame."""

import math

import numpy as np
import warp as wp
from jaxtyping import Float

from garmentbench.scenes.material import Material, Settings
from garmentbench.simulation.assembly import Fabric
from garmentbench.simulation.collider import Collider
from garmentbench.simulation.kernels import Cloth, Contact, Physics, advance_serial, force_pass, particle_pass
from garmentbench.simulation.self_contact import SelfContact


class Solver:
    """Particles under way.

    Args:
        fabric: What is simulated.
        start: First particle positions [m], local axes, shape (P, 3).
        touched: Surfaces, faces (K, 3) each, and first positions [m], local axes, (B, 3), of what it touches; or None.
        substeps: A frame, a multiple of `settings.queries`.
        frame_time: Of one frame [s].
        device: Warp device.
        serial: One launch of one thread for all substeps between two queries, or two passes of parallel threads a
            substep. The result is the same. None: serial on a CPU (no launch storm), parallel on CUDA.
    """

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
        self.contact, self.own_contact = _contact(start, device), _contact(start, device)
        self.physics = _physics(material, settings, frame_time / substeps)
        self.collider = None if touched is None else Collider(*touched, self.cloth, device)
        self.self_contact = None
        if settings.self_contact:
            self.self_contact = SelfContact(fabric, self.cloth, self.own_contact, self.physics, device)
        self._graph = None

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
        if not wp.get_device(self.device).is_cuda:
            self._frame()
        elif self._graph is None:
            self._frame()  # loads the modules, which can't be done while recording
            with wp.ScopedCapture(self.device) as capture:
                self._frame()
            self._graph = capture.graph
        else:
            wp.capture_launch(self._graph)

    def _frame(self) -> None:
        interval = self.frame_time / self.queries
        for q in range(self.queries):
            if self.collider is not None:
                self.collider.move_to(q / self.queries, (q + 1) / self.queries, interval)
                self.collider.touch(self.contact, interval)
            if self.self_contact is not None:
                self.self_contact.find()
            self._integrate()

    def _integrate(self) -> None:
        """All substeps up to the next query."""
        contacts = [self.contact, self.own_contact]
        if self.serial:
            self._launch(advance_serial, 1, [self.cloth, *contacts, self.physics, self.steps])
        else:
            for s in range(self.steps):
                self._launch(force_pass, max(len(self.cloth.ends), len(self.cloth.x)), [self.cloth, self.physics])
                self._launch(particle_pass, len(self.cloth.x), [self.cloth, *contacts, self.physics, s])

    def _launch(self, kernel: wp.Kernel, dim: int, inputs: list) -> None:
        wp.launch(kernel, dim=dim, inputs=inputs, device=self.device)


def _cloth(fabric: Fabric, start: np.ndarray, device: str) -> Cloth:
    count, edges = len(fabric.mass), len(fabric.edges)
    first, second = fabric.edges.T
    end = np.concatenate([first, second])
    order = np.argsort(end, kind="stable")
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
        ("edge_start", np.searchsorted(end[order], np.arange(count + 1)), int),
        ("edge_index", order % edges, int),
        ("edge_sign", np.where(order < edges, 1.0, -1.0), float),
        ("bend_start", fabric.bending.indptr, int),
        ("bend_column", fabric.bending.indices, int),
        ("bend_value", fabric.bending.data, float),
    ):
        setattr(c, name, device_array(values, kind, device))
    return c


def _contact(start: np.ndarray, device: str) -> Contact:
    count, h = len(start), Contact()
    for name in ("normal", "velocity", "air"):
        setattr(h, name, wp.zeros(count, dtype=wp.vec3, device=device))
    h.point = device_array(start, wp.vec3, device)  # where a pinned particle stays if there is no collider
    h.active = wp.zeros(count, dtype=int, device=device)
    h.distance = wp.zeros(count, dtype=float, device=device)
    return h


def _physics(material: Material, settings: Settings, dt: float) -> Physics:
    p = Physics()
    p.dt = dt
    p.air_keep = math.exp(-material.air * dt)
    for source, names in (
        (material, ("compression", "stretch_damping", "bend_damping", "friction", "thickness")),
        (settings, ("gravity", "contact_frequency", "contact_damping", "contact_depth")),
    ):
        for name in names:
            setattr(p, name, getattr(source, name))
    return p


def device_array(values: np.ndarray, kind: type, device: str) -> wp.array:
    """A Warp array of scalars or small vectors."""
    number = np.float32 if kind in (float, wp.vec3, wp.vec4) else np.int32
    return wp.array(np.ascontiguousarray(values, number), dtype=kind, device=device)
