"""Tension: strips that hang, swing, and lose what the air takes."""

import math
from dataclasses import replace

import numpy as np

from garmentbench.evals.validation import exact
from garmentbench.evals.validation.beams import WEIGHT
from garmentbench.evals.validation.case import Case
from garmentbench.evals.validation.strips import DENSITY, FPS, run, squared_frequency, strip, vacuum
from garmentbench.simulation.drive import Simulated

LIMP = 1e-8  # [N m]
TAUT = 1000.0  # [N/m]
CHAIN = 0.6  # [m]
CHAINS = {"4 cm": 15, "2 cm": 30, "1 cm": 60}
SPANS = {"1/10": 10, "1/20": 20, "1/40": 40}
SHEET = 0.6, 100.0  # length [m], E t [N/m]
SWUNG = 0.5, 0.4  # length [m], top speed of its end [m/s]
DRAG = 1.2
SWINGS = {"5 cm": 10, "2.5 cm": 20, "1.25 cm": 40}


def hung(along: np.ndarray, across: np.ndarray, deflection: np.ndarray, young: float = math.inf) -> np.ndarray:
    """Positions [m], shape (V, 3), of a strip that hangs and is deflected by so much [m], its length kept."""
    length = along.max()
    order = np.argsort(along, kind="stable")
    s, x = along[order], deflection[order]
    steps = np.diff(s) ** 2 - np.diff(x) ** 2
    depth = np.empty_like(s)
    depth[order] = np.concatenate([[0.0], np.cumsum(np.sqrt(np.maximum(steps, 0)))]) + s[0]
    depth += WEIGHT * (length * along - along**2 / 2) / young
    return np.column_stack([deflection, across, -depth])


def chain(mode: int, edges: float) -> float:
    """Angular frequency [rad/s] of a hanging strip's swing in a mode of the chain."""
    cloth, along = strip(round(edges), CHAIN, clamped=(0,))
    shape, young = exact.chain_shape(mode, 1 - along / CHAIN), 1000.0
    start = hung(along, cloth.rest[:, 1], 2e-3 * shape, young)
    return math.sqrt(squared_frequency(run(cloth, 2.0, vacuum(LIMP, young), start), shape, axis=0))


def catenary(ratio: float, edges: float) -> float:
    """Sag over span of a strip `ratio` times as long as its ends are apart."""
    cloth, along = strip(round(edges), 1.0, clamped=(0, -1))
    span = 1 / ratio
    x = along * span
    start = np.column_stack([x, cloth.rest[:, 1], -np.minimum(along, 1 - along) * math.sqrt(1 - span**2)])
    last = run(cloth, 3.0, vacuum(LIMP, TAUT, stretch_damping=1e-4), start, settle=6.0).positions[-1]
    near = np.abs(last[:, 0] - span / 2) < 0.15 * span
    return -float(np.polyfit(last[near, 0] - span / 2, last[near, 2], 2)[2]) / span


def extension(edges: float) -> float:
    """How far a sheet that hangs by its own weight is stretched [mm]."""
    length, young = SHEET
    cloth, along = strip(round(edges), length, clamped=(0,), rows=4)
    start = hung(along, cloth.rest[:, 1], 0 * along)
    out = run(cloth, 2.0, vacuum(1e-5, young, stretch_damping=1e-3), start, settle=20.0)
    end = along > length - 1e-6 - length / edges
    lever = np.polyfit(along[end], (out.positions[0] - out.positions[-1])[end, 2], 1)
    return 1e3 * float(np.polyval(lever, length))


def energy_drift(edges: float) -> float:
    """Change of the energy of a strip that swings undamped, a second, over the energy of its swing [%]."""
    cloth, along = strip(round(edges), CHAIN, clamped=(0,))
    start = hung(along, cloth.rest[:, 1], 0.15 * exact.chain_shape(1, 1 - along / CHAIN), 300.0)
    out = run(cloth, 5.0, vacuum(1e-5, 300.0), start)
    total, t = energy(out), np.arange(len(out.kinetic)) / FPS
    return 100 * float(np.polyfit(t[1:], total[1:], 1)[0]) / float(out.kinetic.max())


def energy(out: Simulated) -> np.ndarray:
    """Kinetic energy, weight's, springs' and bending's [J], shape (T,)."""
    cloth = out.fabric
    first = np.unique(cloth.particle, return_index=True)[1]
    x = out.positions[:, first]
    a, b = cloth.edges.T
    stretch = np.linalg.norm(x[:, b] - x[:, a], axis=-1) - cloth.length
    bent = np.array([np.sum(frame * (cloth.bending @ frame)) for frame in x])
    return out.kinetic + exact.GRAVITY * x[..., 2] @ cloth.mass + (stretch**2 @ cloth.stiffness + bent) / 2


def swing_lost(edges: float) -> float:
    """What the air takes of a strip's swing in half a swing [%]."""
    length, speed = SWUNG
    cloth, along = strip(round(edges), length, clamped=(0,))
    shape = exact.chain_shape(1, 1 - along / length)
    start = hung(along, cloth.rest[:, 1], speed / exact.chain_frequency(1, length) * shape, 300.0)
    out = run(cloth, 0.9, replace(vacuum(LIMP, 300.0), drag=DRAG), start)
    mass = out.fabric.mass[out.fabric.particle]
    part = out.positions[..., 0] @ (mass * shape)
    k = int(np.argmin(part))
    a, b, c = np.polyfit([-1, 0, 1], part[k - 1 : k + 2], 2)
    return 100 * (1 + (c - b**2 / (4 * a)) / part[0])


def terminal(edges: float) -> float:
    """Speed of a sheet that falls flat in air [m/s]."""
    cloth, _ = strip(round(edges), 0.2, rows=round(edges))
    out = run(cloth, 2.0, replace(vacuum(1e-4, 300.0), drag=DRAG))
    return float(np.mean(out.positions[-2, :, 2] - out.positions[-1, :, 2])) * FPS


def swing_loss() -> float:
    """The exact value of `swing_lost`."""
    length, speed = SWUNG
    return 100 * (1 - exact.swing_left(DENSITY, DRAG, length, speed / exact.chain_frequency(1, length)))


def _chain(mode: int) -> Case:
    return Case(
        name=f"chain_mode_{mode}",
        title=f"hanging strip, {100 * CHAIN:g} cm: swing in its mode {mode}",
        unit="rad/s",
        wanted=lambda: exact.chain_frequency(mode, CHAIN),
        simulate=lambda edges: chain(mode, edges),
        sizes=CHAINS,
        tolerance=0.005 * mode,
        relative=True,
        source="hanging chain, D. Bernoulli 1733",
        fast=mode == 1,
    )


def _catenary(ratio: float) -> Case:
    return Case(
        name=f"catenary_{ratio:g}",
        title=f"limp strip {ratio:g} times as long as its span: sag over span",
        unit="1",
        wanted=lambda: exact.catenary_sag(ratio, WEIGHT, TAUT),
        simulate=lambda edges: catenary(ratio, edges),
        sizes=SPANS,
        tolerance=0.005,
        relative=True,
        source="elastic catenary, Irvine 1981",
        fast=ratio == 1.5,
    )


CASES = (
    *map(_chain, (1, 2)),
    *map(_catenary, (1.05, 1.2, 1.5, 2.0)),
    Case(
        name="hanging_sheet",
        title="sheet that hangs by its own weight, 60 cm, E t 100 N/m: extension",
        unit="mm",
        wanted=lambda: 1e3 * exact.hanging_extension(WEIGHT, *SHEET),
        simulate=extension,
        sizes={"6 cm": 10, "3 cm": 20, "1.5 cm": 40},
        tolerance=0.03,
        relative=True,
        source="w L² / (2 E t)",
    ),
    Case(
        name="energy_drift",
        title="strip that swings by 15 cm, undamped, without air: energy gained a second, of the swing's",
        unit="%",
        wanted=lambda: 0.0,
        simulate=energy_drift,
        sizes=CHAINS,
        tolerance=0.1,
        source="energy is kept",
    ),
    Case(
        name="swing_in_air",
        title="half-metre strip of 0.2 kg/m² that swings at 0.4 m/s, drag 1.2: amplitude lost in half a swing",
        unit="%",
        wanted=swing_loss,
        simulate=swing_lost,
        sizes=SWINGS,
        tolerance=3.0,
        source="hanging chain with quadratic drag along its normal, 20 modes integrated",
    ),
    Case(
        name="terminal_speed",
        title="sheet that falls flat in air, drag 1.2: speed in the end",
        unit="m/s",
        wanted=lambda: exact.terminal_speed(DENSITY, DRAG),
        simulate=terminal,
        sizes={"5 cm": 4, "2.5 cm": 8},
        tolerance=0.01,
        relative=True,
        source="sqrt(2 rho g / (drag air))",
    ),
)
