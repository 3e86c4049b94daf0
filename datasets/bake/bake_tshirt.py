"""Bake the T-shirt into datasets/garments/tshirt-{smoke,laptop,desktop,paper}.npz.

Only needed to remake the assets: `pip install -e .[bake]`, bake the bodies, then `python datasets/bake/bake_tshirt.py`.
Front, back and two set-in sleeves are cut wider than the shape in which it is put on: that is its ease.
"""

import gpytoolbox
import numpy as np
from cutting import Pattern, cut, frontness, grown, loosen, mirrored
from fitting import Cloth, body_skin
from garment_file import save
from pattern_pieces import shirt
from scipy.interpolate import RegularGridInterpolator
from scipy.ndimage import gaussian_filter
from sizes import VERTICES
from surface import Skin
from tights import SOURCE, fine_tights
from tube import AXIS, hull_radius

HEM_BELOW_HIPS = 0.01  # [m], against the hip joints
ARMHOLE = 0.19  # [m] from the middle: the end of the shoulder seam
UNDERARM = 1.30  # [m] height, below all of the armholes
# Cut for a body that is so much larger on all sides [m]: 10 % of 0.95 m round the chest, 10 % of 0.38 m round a sleeve.
# Nothing at collar and shoulders, where it fits.
EASE_TORSO, EASE_SLEEVE = 0.0150, 0.0065
SHOULDERS = 1.46, 1.36  # [m] heights between which the torso's ease begins
TUBE = 1.34, 1.27  # [m] heights between which it begins to hang straight
COLUMNS = ((0,), (1,), (2, 3))  # of the UV charts: front, back, the sleeves above one another


def fine_tshirt(skin: Skin) -> Cloth:
    """The T-shirt's panels, finely meshed."""
    points, faces, arm, joints = fine_tights()
    pattern = Pattern(
        sleeve=("upper_arm.L", "fore_arm.L", 0.62),
        hem=joints["thigh.L"][2] - HEM_BELOW_HIPS,
        ease_top=0.007,
        ease_hem=0.030,
        ease_sleeve=0.020,
        ease_armpit=0.10,
    )
    points, faces, arm = cut(points, faces, arm, joints, pattern)
    points = loosen(points, faces, arm, joints, pattern, skin)
    table, faces = gpytoolbox.subdivide(np.column_stack([points, arm]), faces, method="loop")[:2]
    arm = table[:, 3]
    points = straight(table[:, :3], faces, arm)
    beyond = mirrored(points)[:, 0] - ARMHOLE
    sleeve = np.where((points[:, 2] < UNDERARM) & (arm < 0.5), np.minimum(beyond, -0.01), beyond)
    return Cloth.cut(shirt(points, faces, larger(points, faces, arm), frontness(points, joints), sleeve), COLUMNS)


def straight(points: np.ndarray, faces: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """The shirt hanging straight down from chest and shoulder blades, over all hollows; shape (V, 3) [m]."""
    torso = faces[(arm[faces] < 0.3).all(axis=1)]
    heights = np.arange(TUBE[0], points[:, 2].min() + 0.004, -0.01)
    angles = np.linspace(-np.pi, np.pi, 361)
    hull = gaussian_filter(hull_radius(points, torso, heights, angles[:-1]), (3, 6), mode=("nearest", "wrap"))
    offset = points[:, :2] - AXIS
    reach, angle = np.linalg.norm(offset, axis=1), np.arctan2(*offset.T[::-1])
    wide = RegularGridInterpolator((-heights, angles), np.column_stack([hull, hull[:, :1]]), bounds_error=False)
    wanted = wide(np.column_stack([np.clip(-points[:, 2], -heights[0], -heights[-1]), angle]))
    share = (1 - arm) * np.clip((TUBE[0] - points[:, 2]) / (TUBE[0] - TUBE[1]), 0, 1)
    out = share * np.maximum(wanted - reach, 0)
    return points + np.column_stack([offset * (out / reach)[:, None], np.zeros(len(points))])


def larger(points: np.ndarray, faces: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """The size in which it is cut, shape (V, 3) [m]."""
    begins = np.clip((SHOULDERS[0] - points[:, 2]) / (SHOULDERS[0] - SHOULDERS[1]), 0, 1)
    ease = (1 - arm) * EASE_TORSO * begins + arm * EASE_SLEEVE
    return grown(points, faces, ease)


def main() -> None:
    skin = body_skin()
    cloth = fine_tshirt(skin)
    for size, wanted in VERTICES["tshirt"].items():
        save(f"tshirt-{size}", cloth.fit(skin, wanted), f"{SOURCE}; made by datasets/bake/bake_tshirt.py")


if __name__ == "__main__":
    main()
