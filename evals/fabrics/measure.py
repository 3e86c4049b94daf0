"""What is measured of a fabric: drape at two mesh sizes, droop, and what it costs."""

import math
import time
from dataclasses import replace

import numpy as np

from garmentbench.evals.fabrics.table import OVERHANG
from garmentbench.evals.validation.drape import Drape, drape
from garmentbench.evals.validation.strips import FPS, balanced, run
from garmentbench.scenes.fabrics import fabric
from garmentbench.scenes.garments import load_garment
from garmentbench.scenes.material import Material, Settings
from garmentbench.scenes.presets import MESH_SIZES
from garmentbench.simulation.drive import drive

EDGES = {"coarse": 0.0113, "fine": 0.008}  # [m] of the drape test's triangles
STARTS = 3  # discs, each pushed in its own way: how many folds form is chance, and laboratories take means, too
TIMED = "tshirt"  # laptop size, hanging in the air: what its substeps cost without what it touches
TIMED_FRAMES = 3


def droop(material: Material) -> float:
    """Angle [degrees] below level of the chord of a strip that hangs over a table's edge by `OVERHANG`."""
    cloth, end = balanced(10)
    cloth = replace(cloth, rest=(OVERHANG * cloth.rest).astype(np.float32))
    last = run(cloth, 2.0, material, settle=10.0).positions[-1]
    tip, middle = end @ last, last[cloth.pins].mean(axis=0)
    return math.degrees(math.atan2(middle[2] - tip[2], tip[0]))


def cost(material: Material) -> tuple[int, float]:
    """Substeps a frame of a T-shirt at laptop size, and their milliseconds."""
    garment = load_garment(TIMED, MESH_SIZES["laptop"].name)
    start = garment.rest.astype(np.float64)
    marks: list[float] = []
    settings = Settings(self_contact=False)
    out = drive(
        garment, start, None, TIMED_FRAMES + 2, FPS, material, settings, step=lambda: marks.append(time.process_time())
    )
    return out.substeps, 1e3 * (marks[-1] - marks[0]) / (len(marks) - 1)


def measure(name: str) -> tuple[dict[str, float], Drape]:
    """All numbers of a fabric by name, and its drape on the fine mesh."""
    material = Material(**fabric(name).material)
    draped = {label: [drape(material, edge, seed) for seed in range(STARTS)] for label, edge in EDGES.items()}
    found = {f"drape_{label}": _mean(made) for label, made in draped.items()}
    found["droop"] = droop(material)
    substeps, ms = cost(material)
    return found | {"substeps": substeps, "ms_per_frame": ms}, draped["fine"][0]


def _mean(made: list[Drape]) -> float:
    """Mean coefficient [%]; NaN where a disc has not come to rest."""
    return float(np.mean([d.coefficient if d.at_rest else math.nan for d in made]))
