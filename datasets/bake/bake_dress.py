"""Bake the dress into datasets/garments/dress-{smoke,laptop,desktop,paper}.npz.

Only needed to remake the assets: `pip install -e .[bake]`, bake the bodies, then `python datasets/bake/bake_dress.py`.
Its top, with short sleeves, is cut like the T-shirt; from the waist a cone hangs to the knees.
"""

import gpytoolbox
import numpy as np
from cutting import Pattern, cut, frontness, loosen
from fitting import Cloth, body_skin
from garment_file import save
from scipy.ndimage import gaussian_filter1d
from sizes import VERTICES
from surface import Skin, border_loops
from tights import SOURCE, fine_tights
from tube import AXIS, WAIST, grid_faces, hull_radius, without_arms

HEM = 0.50  # [m] height, at the knees
ROWS = 48  # of the cone
CLEARANCE = 0.015  # [m] of the cone off the hull
SLOPE = 0.24  # of the cone: outwards over down


def fine_dress(skin: Skin) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The dress's shape, finely meshed: points [m], faces, and which side of the seam (positive: front)."""
    points, faces, arm, joints = fine_tights()
    pattern = Pattern(
        sleeve=("upper_arm.L", "fore_arm.L", 0.40),
        hem=WAIST,
        ease_top=0.007,
        ease_hem=0.015,
        ease_sleeve=0.018,
        ease_armpit=0.10,
    )
    points, faces, arm = cut(points, faces, arm, joints, pattern)
    points = loosen(points, faces, arm, joints, pattern, skin)
    points, faces = hang(points, faces, lower_border(points, faces))
    points, faces = gpytoolbox.subdivide(points, faces, method="loop")[:2]
    return points, faces, frontness(points, joints)


def lower_border(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """The lowest of the borders, in the faces' direction, shape (B,)."""
    return min(border_loops(faces), key=lambda loop: points[loop, 2].mean())


def hang(points: np.ndarray, faces: np.ndarray, border: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Go on from a border round the waist down to the hem with a cone that keeps off the body's hull."""
    offset = points[border, :2] - AXIS
    start, angles = np.linalg.norm(offset, axis=1), np.arctan2(*offset.T[::-1])
    heights = np.linspace(points[border, 2].mean(), HEM, ROWS + 1)
    hull = hull_radius(*without_arms(), heights, angles) + CLEARANCE
    cone = start + SLOPE * (heights[0] - heights)[:, None]
    radius = gaussian_filter1d(np.maximum(cone, hull), 1.5, axis=0, mode="nearest")
    toward = offset / start[:, None]
    rings = np.empty((ROWS, len(border), 3))
    rings[..., :2] = AXIS + radius[1:, :, None] * toward
    # The border itself is not quite level.
    share = np.linspace(0, 1, ROWS + 1)[1:, None]
    rings[..., 2] = (1 - share) * points[border, 2] + share * HEM
    number = np.concatenate([border[None], len(points) + np.arange(ROWS * len(border)).reshape(ROWS, -1)])
    tube = grid_faces(np.concatenate([number, number[:, :1]], axis=1))
    return np.concatenate([points, rings.reshape(-1, 3)]), np.concatenate([faces, tube])


def main() -> None:
    skin = body_skin()
    cloth = Cloth(*fine_dress(skin))
    for size, wanted in VERTICES["dress"].items():
        save(f"dress-{size}", cloth.fit(skin, wanted), f"{SOURCE}; made by datasets/bake/bake_dress.py")


if __name__ == "__main__":
    main()
