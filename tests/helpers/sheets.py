"""Small scenes whose answer can be computed by hand."""

from collections.abc import Sequence

import numpy as np

from garmentbench.evals.crosscheck.match_material import equilateral, sheet
from garmentbench.evals.validation.touching import floor, tilt
from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import Body, Garment
from garmentbench.simulation.drive import Simulated, drive

__all__ = ["FPS", "HARD", "TO_REST", "equilateral", "floor", "grid", "run", "tilt"]

FPS = 30.0
HARD = Material(drag=0.0, drag_along=0.0)  # the default fabric in a vacuum
DEFAULTS = Settings()
TO_REST = Settings(settling=40.0)  # brings cloth to rest quickly, and does not change where


def grid(columns: int, rows: int, width: float, height: float, pins: Sequence[int] = ()) -> Garment:
    """A flat sheet in the plane z = 0 with its first corner at 0, (columns + 1) x (rows + 1) vertices, row by row."""
    x, y = np.meshgrid(np.linspace(0, width, columns + 1), np.linspace(0, height, rows + 1))
    return sheet(np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3), columns, rows, pins)


def run(
    garment: Garment,
    frames: int | np.ndarray,
    material: Material = HARD,
    body: Body | None = None,
    start: np.ndarray | None = None,
    settings: Settings = DEFAULTS,
    **options: object,
) -> Simulated:
    """Drive a sheet from `start` (its rest shape, where None); `options` as of `drive`."""
    start = garment.rest.astype(np.float64) if start is None else start
    return drive(garment, start, body, frames, FPS, material, settings, **options)
