"""Bake the bodysuit into datasets/garments/bodysuit-{smoke,laptop,desktop,paper}.npz.

Only needed to remake the assets: `pip install -e .[bake]`, bake the bodies, then
`python datasets/bake/bake_bodysuit.py`.
"""

import gpytoolbox
import numpy as np
from cutting import Pattern, cut, frontness, loosen
from fitting import Cloth, body_skin
from garment_file import save
from sizes import VERTICES
from surface import Skin
from tights import SOURCE, fine_tights

LEGS = 0.93, 0.83  # [m] heights between which the legs are turned outwards, before they are laid flat
SPREAD = np.radians(22)  # round the hip joints
ABOVE_ANKLES = 0.06  # [m], against the ankle joints


def fine_bodysuit(skin: Skin) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The bodysuit's shape, finely meshed: points [m], faces, which side of the seam (positive: front), and points with
    the legs spread."""
    points, faces, arm, joints = fine_tights()
    pattern = Pattern(
        sleeve=("fore_arm.L", "hand.L", 0.9),
        hem=joints["foot.L"][2] + ABOVE_ANKLES,
        ease_top=0.008,
        ease_hem=0.008,
        ease_sleeve=0.008,
        ease_armpit=0.02,
        rounds=4,
    )
    points, faces, arm = cut(points, faces, arm, joints, pattern)
    points = loosen(points, faces, arm, joints, pattern, skin)
    points, faces = gpytoolbox.subdivide(points, faces, method="loop")[:2]
    return points, faces, frontness(points, joints), spread(points, joints["thigh.L"])


def spread(points: np.ndarray, hip: np.ndarray) -> np.ndarray:
    """Points with the legs further apart, turned round the hip joints; hip: the left one; shape (V, 3) [m]."""
    below = np.clip((LEGS[0] - points[:, 2]) / (LEGS[0] - LEGS[1]), 0, 1)
    angle = SPREAD * below**2 * (3 - 2 * below) * np.tanh(np.abs(points[:, 0]) / 0.03)
    x, z = np.abs(points[:, 0]) - hip[0], points[:, 2] - hip[2]
    turned = hip[0] + np.cos(angle) * x - np.sin(angle) * z
    height = hip[2] + np.sin(angle) * x + np.cos(angle) * z
    return np.column_stack([np.sign(points[:, 0]) * turned, points[:, 1], height])


def main() -> None:
    skin = body_skin()
    cloth = Cloth(*fine_bodysuit(skin))
    for size, wanted in VERTICES["bodysuit"].items():
        save(f"bodysuit-{size}", cloth.fit(skin, wanted), f"{SOURCE}; made by datasets/bake/bake_bodysuit.py")


if __name__ == "__main__":
    main()
