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

LEGS = 0.92  # [m] height from which they are spread before they are laid flat
SPREAD = 0.4  # sideways over down
ABOVE_ANKLES = 0.06  # [m], against the ankle joints


def fine_bodysuit(skin: Skin) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The bodysuit's shape, finely meshed: points [m], faces, which side of the seam (positive: front), and points with
    the legs spread."""
    points, faces, arm, joints = fine_tights()
    pattern = Pattern(
        sleeve=("fore_arm.L", "hand.L", 0.9),
        hem=joints["foot.L"][2] + ABOVE_ANKLES,
        ease_top=0.012,
        ease_hem=0.020,
        ease_sleeve=0.022,
        ease_armpit=0.08,
        rounds=6,
    )
    points, faces, arm = cut(points, faces, arm, joints, pattern)
    points = loosen(points, faces, arm, joints, pattern, skin)
    points, faces = gpytoolbox.subdivide(points, faces, method="loop")[:2]
    return points, faces, frontness(points, joints), spread(points)


def spread(points: np.ndarray) -> np.ndarray:
    """Points with the legs further apart, shape (V, 3) [m]."""
    aside = SPREAD * np.maximum(LEGS - points[:, 2], 0) * np.tanh(points[:, 0] / 0.03)
    return points + aside[:, None] * [1, 0, 0]


def main() -> None:
    skin = body_skin()
    cloth = Cloth(*fine_bodysuit(skin))
    for size, wanted in VERTICES["bodysuit"].items():
        save(f"bodysuit-{size}", cloth.fit(skin, wanted), f"{SOURCE}; made by datasets/bake/bake_bodysuit.py")


if __name__ == "__main__":
    main()
