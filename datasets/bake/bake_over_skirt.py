"""Bake the over-skirt into datasets/garments/over_skirt-{smoke,laptop,desktop,paper}.npz.

Only needed to remake the assets: bake the bodies and the dress, then `python datasets/bake/bake_over_skirt.py`. It is
worn over the dress: a wider cone from the waist to above the knees.
"""

import numpy as np
from fitting import Cloth, body_skin
from garment_file import save
from scipy.ndimage import gaussian_filter
from sizes import VERTICES
from tube import AXIS, WAIST, grid_faces, hull_radius, without_arms

from garmentbench.scenes.garments import load_garment

TOP = WAIST + 0.02  # [m] height, above the dress's narrowest place
HEM = 0.66  # [m] height, a hand above the dress's hem
CLEARANCE = 0.008  # [m] off the dress
FLARE = 0.04  # [m] further off the dress at the hem
WAISTBAND = 0.029  # [m] below the upper edge, held by pins
ROWS, ANGLES = 60, 240  # of the fine tube
PROVENANCE = "a cone round the baked dress; made by datasets/bake/bake_over_skirt.py"


def fine_over_skirt(size: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The skirt's shape over the dress of that size, finely meshed: points [m], faces, and which side of the side seams
    (positive: front)."""
    dress = load_garment("dress", size)
    heights = np.linspace(TOP, HEM, ROWS)
    angles = np.linspace(0, 2 * np.pi, ANGLES, endpoint=False)
    beneath = np.maximum(
        hull_radius(*without_arms(), heights, angles),
        hull_radius(dress.rest.astype(float), dress.faces, heights, angles),
    )
    radius = gaussian_filter(beneath, (1.5, 4), mode=("nearest", "wrap"))
    radius += CLEARANCE + FLARE * ((TOP - heights) / (TOP - HEM))[:, None]
    rings = np.empty((ROWS, ANGLES, 3))
    rings[..., :2] = AXIS + radius[..., None] * np.column_stack([np.cos(angles), np.sin(angles)])
    rings[..., 2] = heights[:, None]
    number = np.arange(ROWS * ANGLES).reshape(ROWS, ANGLES)
    points = rings.reshape(-1, 3)
    return points, grid_faces(np.concatenate([number, number[:, :1]], axis=1)), AXIS[1] - points[:, 1]


def held(rest: np.ndarray) -> np.ndarray:
    """The waistband's vertices."""
    return np.flatnonzero(rest[:, 2] > TOP - WAISTBAND)


def main() -> None:
    skin = body_skin()
    for size, wanted in VERTICES["over_skirt"].items():
        arrays = Cloth(*fine_over_skirt(size)).fit(skin, wanted)
        save(f"over_skirt-{size}", arrays | {"pins": held(arrays["rest"])}, PROVENANCE)


if __name__ == "__main__":
    main()
