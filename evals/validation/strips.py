"""Strips of cloth and how they are driven: in a vacuum, without friction, on regular triangles."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import curve_fit

from garmentbench.evals.crosscheck.match_material import equilateral
from garmentbench.evals.validation.exact import GRAVITY
from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import Garment
from garmentbench.simulation.drive import Simulated, drive

FPS = 30.0
FREE_STRIP = 8 / 9  # flexural rigidity of a free strip of equilateral triangles, over `Material.bending`
YOUNG = 3.0  # `Material.stretch` over E t
DENSITY = 0.2  # [kg/m^2]
EARLY = 3  # frames
HEIGHT = math.sqrt(0.75)  # of a triangle of edge 1


def vacuum(rigidity: float, young: float, **changes: float) -> Material:
    """A strip's material without air, of that flexural rigidity of a free strip [N m] and E t [N/m]; undamped but for
    `changes`."""
    calm = {"stretch_damping": 0.0, "bend_damping": 0.0, "drag": 0.0, "drag_along": 0.0}
    return Material(
        **{"density": DENSITY, "stretch": YOUNG * young, "bending": rigidity / FREE_STRIP} | calm | changes  # type: ignore[arg-type]
    )


# Nothing touches, and border vertices weigh what they weigh.
EXACT = Settings(queries=1, mass_floor=0.0, self_contact=False)


def run(
    garment: Garment,
    seconds: float,
    material: Material,
    start: np.ndarray | None = None,
    settle: float = 0.0,
    gravity: float = GRAVITY,
) -> Simulated:
    """Let a strip go from `start` [m] (as it lies, where None); `settle`: rate at which its velocity decays [1/s]."""
    settings = replace(EXACT, gravity=gravity, settling=settle)
    start = garment.rest.astype(np.float64) if start is None else start
    return drive(garment, start, None, 1 + round(seconds * FPS), FPS, material, settings)


def strip(columns: int, length: float, clamped: tuple[int, ...] = (), rows: int = 2) -> tuple[Garment, np.ndarray]:
    """A strip along x, and where along it its vertices are [m], shape (V,): 0 and `length` at its ends, which are
    ragged by half an edge.

    columns: Edges along it.
    clamped: Columns of vertices that are held, negative ones from the far end.
    """
    count = columns + 1
    pins = [j * count + i % count for j in range(rows + 1) for i in clamped]
    made = equilateral(columns, rows, length / columns, pins)
    return made, made.rest[:, 0].astype(np.float64) - length / columns / 4


def balanced(half: int, rows: int = 2) -> tuple[Garment, np.ndarray]:
    """A strip that is held at its middle, so that both halves are clamped there by symmetry, and nothing bends a real
    clamp or keeps the strip from curling across.

    Its rows have 2 half + 1 and 2 half vertices in turn. Each half is 1 m long, to the mean of its ragged end. Also the
    weights that take vertices to the mean of the far end, shape (V,).
    """
    edge = 1 / (half - 0.25)  # of a row that ends half an edge short, and one that does not
    points, starts = [], []
    for j in range(rows + 1):
        starts.append(len(points))
        xs = np.arange(-half, half + 1) if j % 2 == 0 else np.arange(-half, half) + 0.5
        points += [(edge * x, edge * HEIGHT * j, 0.0) for x in xs]
    faces = []
    for j in range(rows):
        a, b = starts[j], starts[j + 1]
        for i in range(2 * half):
            even = j % 2 == 0
            faces.append((a + i, a + i + 1, b + i) if even else (a + i, b + i + 1, b + i))
            if i < 2 * half - 1:
                faces.append((a + i + 1, b + i + 1, b + i) if even else (a + i, a + i + 1, b + i + 1))
    rest = np.array(points, np.float32)
    end = np.zeros(len(rest))
    end[[*(s - 1 for s in starts[1:]), len(rest) - 1]] = [0.5, *[1.0] * (rows - 1), 0.5]
    pins = np.flatnonzero(np.abs(rest[:, 0]) < 1e-9).astype(np.int32)
    made = Garment("strip", rest, np.array(faces, np.int32), rest[:, :2], np.zeros((0, 2), np.int32), pins)
    return made, end / end.sum()


def squared_frequency(out: Simulated, shape: np.ndarray, axis: int = 2) -> float:
    """Square of the angular frequency [1/s^2] at which deflection along an axis in a mode's shape, (V,), moves from
    rest; negative where it grows.
    """
    mass = out.fabric.mass[out.fabric.particle]
    part = out.positions[..., axis] @ (mass * shape) / (mass @ shape**2)
    part /= part[0]
    t = np.arange(len(part)) / FPS

    def motion(t: np.ndarray, square: float, size: float) -> np.ndarray:
        w = math.sqrt(abs(square))
        return size * (np.cos(w * t) if square > 0 else np.cosh(w * t))

    bent = 2 * (part[EARLY] - 1) / t[EARLY] ** 2  # x'' = -square x, at the beginning
    fitted: Any = curve_fit(motion, t, part, p0=(-bent, 1.0))[0]
    return float(fitted[0])
