"""Small scenes whose answer can be computed by hand."""

from collections.abc import Sequence

import numpy as np

from garmentbench.evals.crosscheck.match_material import equilateral, sheet
from garmentbench.scenes.material import Material, Settings
from garmentbench.sequence import OBJECT, Body, Garment
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


def floor(half: float = 5.0) -> Body:
    """A square floor at z = 0."""
    points = np.array([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]], np.float32)
    return Body("floor", points, np.array([[0, 1, 2], [0, 2, 3]], np.int32), kind=OBJECT)


def tilt(points: np.ndarray, degrees: float) -> np.ndarray:
    """Points turned about the y axis: what lay on the floor then lies on a slope that falls towards +x."""
    angle = np.radians(degrees)
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    return points.astype(np.float64) @ turn.T


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
