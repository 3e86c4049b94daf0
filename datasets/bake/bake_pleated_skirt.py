"""Bake the pleated skirt into datasets/garments/pleated_skirt-{smoke,laptop,desktop,paper}.npz.

Only needed to remake the assets: bake the bodies, then `python datasets/bake/bake_pleated_skirt.py`. It is a rectangle
of cloth in accordion pleats round the body's hull, closed by one seam at the back.
"""

from dataclasses import dataclass

import numpy as np
from garment_file import save
from scipy.ndimage import gaussian_filter
from tube import AXIS, WAIST, grid_faces, hull_radius, without_arms

HEM = 0.60  # [m] height, a little above the knees
CLEARANCE = 0.008  # [m] of the folds' inner edges off the hull
FLARE = 0.05  # [m] further off the hull at the hem
PLEATS = 18
WIDTH_WAIST, WIDTH_HEM = 1.40, 2.10  # [m] of the cloth laid flat
WAISTBAND = 0.029  # [m] below the upper edge, held by pins
MARGIN = 0.03  # of the UV square
ANGLES = 720
PROVENANCE = (
    "accordion pleats round the convex hull of the baked base body; made by datasets/bake/bake_pleated_skirt.py"
)
SMOOTHING = 4  # [degrees, cm] of the hull


@dataclass(frozen=True)
class Grid:
    """How the cloth is meshed.

    Attributes:
        columns: Of faces on one side of a pleat, of which each goes out and back once.
        rows: Of vertices.
    """

    columns: int
    rows: int


SIZES = {  # near `sizes.VERTICES`
    "smoke": Grid(columns=1, rows=11),
    "laptop": Grid(columns=2, rows=21),
    "desktop": Grid(columns=4, rows=34),
    "paper": Grid(columns=6, rows=82),
}


def pleated(grid: Grid) -> dict[str, np.ndarray]:
    """The arrays of the skirt's file.

    In each row the folds are as deep as the cloth's width leaves them: deep at the narrow waist, wide at the hem. So
    the cloth is a rectangle and its edges are even, and no edge at the waist is so short as to set the time step.
    """
    columns = 2 * PLEATS * grid.columns
    heights = np.linspace(WAIST, HEM, grid.rows)
    rings = inner_rings(heights, columns)
    step = np.roll(rings, -1, axis=1) - np.roll(rings, 1, axis=1)
    outward = np.stack([step[..., 1], -step[..., 0]], axis=-1)
    outward /= np.linalg.norm(outward, axis=-1, keepdims=True)
    around = np.linalg.norm(np.roll(rings, -1, axis=1) - rings, axis=-1).sum(axis=1)
    wave = 1 - np.abs(np.arange(columns) % (2 * grid.columns) / grid.columns - 1)  # 0 inside, 1 outside
    rings = (
        rings
        + fold_depth(around, np.linspace(WIDTH_WAIST, WIDTH_HEM, grid.rows))[:, None, None] * wave[:, None] * outward
    )
    rings = np.concatenate([rings, rings[:, :1]], axis=1)  # the seam's other copy
    rest = np.concatenate([rings, np.broadcast_to(heights[:, None, None], (*rings.shape[:2], 1))], axis=-1)
    number = np.arange(rest[..., 0].size).reshape(grid.rows, columns + 1)
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(1, 0, grid.rows))
    return {
        "rest": rest.reshape(-1, 3),
        "faces": grid_faces(number),
        "uv": MARGIN + (1 - 2 * MARGIN) * np.column_stack([u.ravel(), v.ravel()]),
        "seams": number[:, [0, -1]],
        "pins": number[heights >= WAIST - WAISTBAND - 1e-6].ravel(),
    }


def inner_rings(heights: np.ndarray, columns: int) -> np.ndarray:
    """Where the folds' inner edges would lie: even points round the hull, shape (rows, columns, 2) [m], seen from above
    counterclockwise from the middle of the back."""
    angles = np.pi / 2 + np.linspace(0, 2 * np.pi, ANGLES, endpoint=False)
    fine = np.arange(WAIST, HEM - 0.01, -0.01)
    radius = hull_radius(*without_arms(), fine, angles)
    radius = gaussian_filter(radius, (SMOOTHING, SMOOTHING * ANGLES / 360), mode=("nearest", "wrap"))
    radius += CLEARANCE + FLARE * ((WAIST - fine) / (WAIST - HEM))[:, None]
    toward = np.column_stack([np.cos(angles), np.sin(angles)])
    rings = np.empty((len(heights), columns, 2))
    for row, z in enumerate(heights):
        r = np.array([np.interp(-z, -fine, column) for column in radius.T])
        ring = AXIS + r[:, None] * toward
        closed = np.concatenate([ring, ring[:1]])
        length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
        at = np.linspace(0, length[-1], columns, endpoint=False)
        rings[row] = np.column_stack([np.interp(at, length, axis) for axis in closed.T])
    return rings


def fold_depth(around: np.ndarray, width: np.ndarray) -> np.ndarray:
    """Depth of the folds [m], shape (rows,), of cloth so wide [m] on rings so long [m] at the inner edges of the folds.

    One side of a pleat, as long as width / 2P, goes out by d and along by (around + pi d) / 2P, the ring's length half
    way out: d^2 + ((around + pi d) / 2P)^2 = (width / 2P)^2.
    """
    sides = 2 * PLEATS
    a = 1 + (np.pi / sides) ** 2
    b = np.pi * around / sides**2
    c = (around**2 - width**2) / sides**2
    return (np.sqrt(b**2 - a * c) - b) / a


def main() -> None:
    for size, grid in SIZES.items():
        save(f"pleated_skirt-{size}", pleated(grid), PROVENANCE)


if __name__ == "__main__":
    main()
