"""Damping of bending, once a query: stable at any strength without shortening the substep.

The force is -t (K v + sum_c k_c g_c (g_c . v)), with the damping time t, the flat stencils' matrix K, and stiffness k_c
and gradient g_c of each crease, frozen. Its rate grows as h^-4 with the edge length h: on fine meshes it would set the
length of the substeps. It is integrated by RKL2, second-order Runge-Kutta with s stages whose stability grows as s^2
(Meyer, Balsara and Aslam 2014, "A stabilized Runge-Kutta-Legendre method for explicit super-time-stepping of
parabolic and mixed equations", eqs. 15 to 17). Momentum stays where nothing is pinned.

The substeps' velocities are those of half a substep ago. Damped there, a mode near the stability limit would gain
energy when its frequency fits; so half a substep's kick is added before and taken away after. Then what the substeps
conserve is even in the velocity, and can only fall.
"""

import warp as wp

from garmentbench.simulation.hinge import firmness, hinge_force, hinge_gradient
from garmentbench.simulation.kernels import Cloth, Physics, edge_force, total_force


@wp.struct
class Damping:
    """What the stages work on: P particles, C creases."""

    kick: wp.array[wp.vec3]  # what half a substep's forces change the velocities by [m/s], shape (P,)
    rate: wp.array[wp.vec3]  # of change at the first stage, times the interval [m/s], shape (P,)
    odd: wp.array[wp.vec3]  # velocities after the last odd stage [m/s], shape (P,)
    even: wp.array[wp.vec3]  # ... after the last even one, shape (P,)
    gradient: wp.array[wp.vec3]  # of the creases' angles [rad/m], shape (4 C,)
    stiffness: wp.array[float]  # of the creases [N m], shape (C,)
    moment: wp.array[float]  # of the creases [N m], shape (C,)
    strength: float  # damping time times interval [s^2]
    kick_time: float  # by which velocities lag behind positions [s]


@wp.func
def b_of(j: int) -> float:
    """The method's b_j."""
    b = float(1.0 / 3.0)
    if j > 2:
        x = float(j)
        b = (x * x + x - 2.0) / (2.0 * x * (x + 1.0))
    return b


@wp.func
def take_gradient(c: Cloth, d: Damping, k: int):
    """Gradient and stiffness of crease k where the cloth is now."""
    q = c.crease[k]
    g = hinge_gradient(c.x[q[0]], c.x[q[1]], c.x[q[2]], c.x[q[3]])
    d.gradient[4 * k] = g.a
    d.gradient[4 * k + 1] = g.b
    d.gradient[4 * k + 2] = g.c
    d.gradient[4 * k + 3] = g.d
    d.stiffness[k] = firmness(c, k) * c.crease_stiffness[k]


@wp.func
def take_moment(c: Cloth, d: Damping, v: wp.array[wp.vec3], k: int):
    """The moment by which crease k resists velocities v, but for the damping time."""
    rate = float(0.0)
    for corner in range(4):
        rate += wp.dot(d.gradient[4 * k + corner], v[c.crease[k][corner]])
    d.moment[k] = d.stiffness[k] * rate


@wp.func
def change(c: Cloth, d: Damping, v: wp.array[wp.vec3], i: int) -> wp.vec3:
    """What damping changes velocities v of particle i by over the interval, to first order [m/s]."""
    f = wp.vec3(0.0)
    if c.pinned[i] == 0:
        for s in range(c.bend_start[i], c.bend_start[i + 1]):
            f += c.bend_value[s] * (v[i] - v[c.bend_column[s]])
        for s in range(c.crease_start[i], c.crease_start[i + 1]):
            at = c.crease_index[s]
            f -= d.moment[at / 4] * d.gradient[at]
    return d.strength * c.inverse_mass[i] * f


@wp.func
def synchronise(c: Cloth, d: Damping, i: int):
    """Bring the velocity of particle i to the time of its position."""
    kick = wp.vec3(0.0)
    if c.pinned[i] == 0:
        kick = d.kick_time * c.inverse_mass[i] * total_force(c, i)
    d.kick[i] = kick
    c.v[i] = c.v[i] + kick


@wp.func
def first_stage(c: Cloth, d: Damping, stages: int, i: int):
    """Stage 1 of particle i. `moment` holds that of the velocities themselves."""
    w = 4.0 / float(stages * stages + stages - 2)
    rate = change(c, d, c.v, i)
    d.rate[i] = rate
    d.even[i] = c.v[i]
    d.odd[i] = c.v[i] + b_of(1) * w * rate


@wp.func
def stage(c: Cloth, d: Damping, last: wp.array[wp.vec3], out: wp.array[wp.vec3], stages: int, j: int, i: int):
    """Stage j >= 2 of particle i, from `last`, stage j - 1, and `out`, stage j - 2, which it replaces."""
    x = float(j)
    w = 4.0 / float(stages * stages + stages - 2)
    m = (2.0 * x - 1.0) / x * b_of(j) / b_of(j - 1)
    n = -(x - 1.0) / x * b_of(j) / b_of(j - 2)
    start = (1.0 - m - n) * c.v[i] - (1.0 - b_of(j - 1)) * m * w * d.rate[i]
    out[i] = m * last[i] + n * out[i] + start + m * w * change(c, d, last, i)


@wp.kernel(enable_backward=False)
def damp_serial(c: Cloth, d: Damping, p: Physics, stages: int):
    """All stages in one launch of one thread: the way on a CPU."""
    creases = c.crease.shape[0]
    for e in range(c.ends.shape[0]):
        c.force[e] = edge_force(c, p, e)
    for k in range(creases):
        hinge_force(c, k)
        take_gradient(c, d, k)
    for i in range(c.x.shape[0]):
        c.y[i] = c.x[i]
    for i in range(c.x.shape[0]):
        synchronise(c, d, i)
    for k in range(creases):
        take_moment(c, d, c.v, k)
    for i in range(c.x.shape[0]):
        first_stage(c, d, stages, i)
    for j in range(2, stages + 1):
        if j % 2 == 0:
            for k in range(creases):
                take_moment(c, d, d.odd, k)
            for i in range(c.x.shape[0]):
                stage(c, d, d.odd, d.even, stages, j, i)
        else:
            for k in range(creases):
                take_moment(c, d, d.even, k)
            for i in range(c.x.shape[0]):
                stage(c, d, d.even, d.odd, stages, j, i)
    for i in range(c.x.shape[0]):
        c.v[i] = d.odd[i] - d.kick[i]  # `stages` is odd


@wp.kernel(enable_backward=False)
def force_pass(c: Cloth, d: Damping, p: Physics):
    """Forces of edges and creases, gradients of these, and the positions that they are of: dim = max(E, C, P)."""
    i = wp.tid()
    if i < c.ends.shape[0]:
        c.force[i] = edge_force(c, p, i)
    if i < c.crease.shape[0]:
        hinge_force(c, i)
        take_gradient(c, d, i)
    if i < c.x.shape[0]:
        c.y[i] = c.x[i]


@wp.kernel(enable_backward=False)
def synchronise_pass(c: Cloth, d: Damping):
    """Velocities at the time of the positions: dim = P."""
    synchronise(c, d, wp.tid())


@wp.kernel(enable_backward=False)
def take_pass(c: Cloth, d: Damping):
    """The damped velocities, half a substep ago again: dim = P."""
    i = wp.tid()
    c.v[i] = d.odd[i] - d.kick[i]


@wp.kernel(enable_backward=False)
def moment_pass(c: Cloth, d: Damping, v: wp.array[wp.vec3]):
    """Moments of the creases: dim = C."""
    take_moment(c, d, v, wp.tid())


@wp.kernel(enable_backward=False)
def first_pass(c: Cloth, d: Damping, stages: int):
    """Stage 1: dim = P."""
    first_stage(c, d, stages, wp.tid())


@wp.kernel(enable_backward=False)
def stage_pass(c: Cloth, d: Damping, last: wp.array[wp.vec3], out: wp.array[wp.vec3], stages: int, j: int):
    """Stage j: dim = P."""
    stage(c, d, last, out, stages, j, wp.tid())


class BendDamping:
    """Damps bending over the time between two queries.

    Args:
        cloth: Whose velocities are damped.
        physics: Of the substeps.
        damping: Damping time [s].
        interval: Between two queries [s].
        lag: Time by which velocities lag behind positions [s].
        stages: See `time_step.damping_stages`; odd.
        device: Warp device.
        serial: See `cloth.Solver`.
    """

    def __init__(
        self,
        cloth: Cloth,
        physics: Physics,
        damping: float,
        interval: float,
        lag: float,
        stages: int,
        device: str,
        serial: bool,
    ) -> None:
        self.cloth, self.physics, self.stages, self.device, self.serial = cloth, physics, stages, device, serial
        d = self.state = Damping()
        count, creases = len(cloth.x), len(cloth.crease)
        for name in ("kick", "rate", "odd", "even"):
            setattr(d, name, wp.zeros(count, dtype=wp.vec3, device=device))
        d.gradient = wp.zeros(4 * creases, dtype=wp.vec3, device=device)
        d.moment, d.stiffness = (wp.zeros(creases, dtype=float, device=device) for _ in range(2))
        d.strength, d.kick_time = damping * interval, lag

    def apply(self) -> None:
        """Damp the velocities."""
        c, d, p, count = self.cloth, self.state, self.physics, len(self.cloth.x)
        if self.serial:
            self._launch(damp_serial, 1, c, d, p, self.stages)
            return
        self._launch(force_pass, max(len(c.ends), len(c.crease), count), c, d, p)
        self._launch(synchronise_pass, count, c, d)
        self._launch(moment_pass, len(c.crease), c, d, c.v)
        self._launch(first_pass, count, c, d, self.stages)
        last, out = d.odd, d.even
        for j in range(2, self.stages + 1):
            self._launch(moment_pass, len(c.crease), c, d, last)
            self._launch(stage_pass, count, c, d, last, out, self.stages, j)
            last, out = out, last
        self._launch(take_pass, count, c, d)

    def _launch(self, kernel: wp.Kernel, dim: int, *inputs: object) -> None:
        if dim:
            wp.launch(kernel, dim=dim, inputs=list(inputs), device=self.device)
