"""Bake the over-skirt into datasets/garments/over_skirt-{smoke,laptop,desktop,paper}.npz.

Only needed to remake the assets: bake the bodies and the dress, then `python datasets/bake/bake_over_skirt.py`. It is
worn over the dress, from the waist to above the knees: a plain waistband that lies on the dress, and wide pleats below
it.
"""

import numpy as np
from garment_file import save
from pleats import Grid, closed_cloth, doubled, even_ring, fan_chart, opened, pleated_row, row_heights
from scipy.ndimage import gaussian_filter, maximum_filter
from tube import AXIS, WAIST, hull_radius, without_arms

from garmentbench.scenes.garments import load_garment

TOP = WAIST + 0.02  # [m] height, above the dress's narrowest place
HEM = 0.66  # [m] height, a hand above the dress's hem
CLEARANCE = 0.006  # [m] off the hull of dress and body
# [m] off the dress: the waistband's lower edge, and its upper one, which is pinned and can give way to no fold.
ON_DRESS = 0.007, 0.010
BAND, OPEN = TOP - 0.025, TOP - 0.085  # [m] height: the waistband's lower edge, and where all pleats are open
FREE = BAND - 0.03  # [m] height, from which on the folds lie off the hull and no more off the dress itself
PLEATS = 14
DEPTH_WAIST, DEPTH_HEM = 0.024, 0.050  # [m] of the folds, if they began at the upper edge
MARGIN = 0.03  # of the UV square
ANGLES = 720
PROVENANCE = "pleats over the baked dress; made by datasets/bake/bake_over_skirt.py"
SIZES = {
    "smoke": Grid(spacing=0.0417, edge=0.080),
    "laptop": Grid(spacing=0.0217, edge=0.028),
    "desktop": Grid(spacing=0.0111, edge=0.015),
    "paper": Grid(spacing=0.0061, edge=0.0076),
}


def over_skirt(size: str) -> dict[str, np.ndarray]:
    """The arrays of the skirt's file, over the dress of that size."""
    grid = SIZES[size]
    heights = row_heights([TOP, BAND, HEM], grid.spacing)
    rings = inner_rings(size, heights)
    depth = opened(heights, BAND, OPEN) * np.interp(heights, [HEM, TOP], [DEPTH_HEM, DEPTH_WAIST])
    along = np.linalg.norm(np.roll(rings, -1, axis=1) - rings, axis=-1).sum(axis=1) / (2 * PLEATS)
    side = np.hypot(along + np.pi * depth / (2 * PLEATS), depth)
    columns = [doubled(wide, grid.edge) for wide in side]
    cloth = closed_cloth([pleated_row(r, d, PLEATS, c) for r, d, c in zip(rings, depth, columns, strict=True)])
    return {
        **{key: cloth[key] for key in ("rest", "faces", "seams")},
        "uv": fan_chart(cloth, side, MARGIN),
        "pins": np.flatnonzero(cloth["rest"][:, 2] > TOP - 1e-6),
    }


def inner_rings(size: str, heights: np.ndarray) -> np.ndarray:
    """Where the folds' inner edges lie: even points on the dress at the waistband and round the hull of dress and body
    below it, shape (rows, ANGLES, 3) [m], seen from above counterclockwise from the middle of the back."""
    dress = load_garment("dress", size)
    worn = dress.rest.astype(float), dress.faces
    angles = np.pi / 2 + np.linspace(0, 2 * np.pi, ANGLES, endpoint=False)
    fine = np.arange(TOP, HEM - 0.01, -0.01)
    beneath = np.maximum(hull_radius(*without_arms(), fine, angles), hull_radius(*worn, fine, angles))
    beneath = maximum_filter(beneath, (5, 25), mode=("nearest", "wrap"))  # so that smoothing doesn't bring it nearer
    radius = gaussian_filter(beneath, (1.5, 12), mode=("nearest", "wrap"))
    toward = np.column_stack([np.cos(angles), np.sin(angles)])
    rings = []
    for z, free in zip(heights, opened(heights, BAND, FREE), strict=True):
        hanging = np.array([np.interp(-z, -fine, r) for r in radius.T])
        lying = hull_radius(*worn, np.array([z]), angles)[0]
        reach = (1 - free) * (lying + np.interp(z, [BAND, TOP], ON_DRESS)) + free * (hanging + CLEARANCE)
        rings.append(np.column_stack([even_ring(AXIS + reach[:, None] * toward, ANGLES), np.full(ANGLES, z)]))
    return np.stack(rings)


def main() -> None:
    for size in SIZES:
        save(f"over_skirt-{size}", over_skirt(size), PROVENANCE)


if __name__ == "__main__":
    main()
