"""Bake the pleated skirt into datasets/garments/pleated_skirt-{smoke,laptop,desktop,paper}.npz.

Only needed to remake the assets: bake the bodies, then `python datasets/bake/bake_pleated_skirt.py`. A plain waistband
lies on the skin, held by pins; below it pleats open within a hand's breadth and hang to the hem, wider and wider. The
skirt is closed by one seam at the back.
"""

import numpy as np
from fitting import body_skin
from garment_file import save
from pleats import Grid, closed_cloth, doubled, even_ring, fan_chart, fold_depth, opened, pleated_row, row_heights
from scipy.ndimage import gaussian_filter
from surface import Skin
from tube import AXIS, WAIST, hull_radius, without_arms

HEM = 0.60  # [m] height, a little above the knees
BAND, OPEN = WAIST - 0.025, WAIST - 0.090  # [m] height: the waistband's lower edge, and where all pleats are open
ON_SKIN = 0.0055  # [m] of the waistband off the skin: the thickness of cloth in contact, and half a millimetre
CLEARANCE = 0.010  # [m] of the folds' inner edges off the hull
FLARE = 0.04  # [m] further off the hull at the hem
PLEATS = 18
WIDTH_WAIST, WIDTH_HEM = 1.35, 2.10  # [m] of the cloth laid flat, if its pleats began at the upper edge
MARGIN = 0.03  # of the UV square
ANGLES = 720
SMOOTHING = 4  # [degrees, cm] of the hull
PROVENANCE = "pleats round the convex hull of the baked base body; made by datasets/bake/bake_pleated_skirt.py"


SIZES = {
    "smoke": Grid(spacing=0.063, edge=0.080),
    "laptop": Grid(spacing=0.0265, edge=0.025),
    "desktop": Grid(spacing=0.0150, edge=0.015),
    "paper": Grid(spacing=0.00785, edge=0.0078),
}


def pleated(grid: Grid, skin: Skin) -> dict[str, np.ndarray]:
    """The arrays of the skirt's file."""
    heights = row_heights([WAIST, BAND, HEM], grid.spacing)
    rings = inner_rings(heights, skin)
    around = np.linalg.norm(np.roll(rings, -1, axis=1) - rings, axis=-1).sum(axis=1)
    width = cloth_width(heights, around)
    cloth = closed_cloth(
        [
            pleated_row(ring, depth, PLEATS, doubled(wide / (2 * PLEATS), grid.edge))
            for ring, depth, wide in zip(rings, fold_depth(around, width, PLEATS), width, strict=True)
        ]
    )
    return {
        **{key: cloth[key] for key in ("rest", "faces", "seams")},
        "uv": fan_chart(cloth, width, MARGIN),
        "pins": np.flatnonzero(cloth["rest"][:, 2] > BAND - 1e-6),
    }


def inner_rings(heights: np.ndarray, skin: Skin) -> np.ndarray:
    """Where the folds' inner edges lie: even points round the body, shape (rows, ANGLES, 3) [m], seen from above
    counterclockwise from the middle of the back. On the skin in the waistband, on the hull further down."""
    angles = np.pi / 2 + np.linspace(0, 2 * np.pi, ANGLES, endpoint=False)
    fine = np.arange(WAIST, HEM - 0.01, -0.01)
    radius = hull_radius(*without_arms(), fine, angles)
    radius = gaussian_filter(radius, (SMOOTHING, SMOOTHING * ANGLES / 360), mode=("nearest", "wrap"))
    radius += CLEARANCE + FLARE * ((WAIST - fine) / (WAIST - HEM))[:, None]
    toward = np.column_stack([np.cos(angles), np.sin(angles)])
    rings = []
    for z in heights:
        hull, share = np.array([np.interp(-z, -fine, r) for r in radius.T]), opened(z, BAND, OPEN)
        reach = hull if share == 1 else (1 - share) * skin_radius(hull, z, toward, skin) + share * hull
        rings.append(np.column_stack([even_ring(AXIS + reach[:, None] * toward, ANGLES), np.full(ANGLES, z)]))
    return np.stack(rings)


def skin_radius(start: np.ndarray, z: float, toward: np.ndarray, skin: Skin) -> np.ndarray:
    """How far from the axis [m] points at height z are `ON_SKIN` off the skin, shape (ANGLES,)."""
    radius = start.copy()
    for _ in range(20):
        points = np.column_stack([AXIS + radius[:, None] * toward, np.full(len(radius), z)])
        radius -= skin.distance(points)[0] - ON_SKIN
    return gaussian_filter(radius, SMOOTHING / 4 * ANGLES / 360, mode="wrap")


def cloth_width(heights: np.ndarray, around: np.ndarray) -> np.ndarray:
    """Width of the cloth laid flat at each row [m]: the ring's own in the waistband, and below it soon the pleats'."""
    pleats = np.interp(heights, [HEM, WAIST], [WIDTH_HEM, WIDTH_WAIST])
    return around + opened(heights, BAND, OPEN) * (pleats - around)


def main() -> None:
    skin = body_skin()
    for size, grid in SIZES.items():
        save(f"pleated_skirt-{size}", pleated(grid, skin), PROVENANCE)


if __name__ == "__main__":
    main()
