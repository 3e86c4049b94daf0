"""The shape of the T-shirt: MakeHuman's body-hugging surface, cut with planes and made loose."""

import numpy as np
from surface import Skin, averaging, clip, largest_part, normals, push_out

SLEEVE = 0.55  # of the way from the shoulder to the elbow
HEM_BELOW_HIPS = 0.03  # [m], against the hip joints
# The collar is cut with a ball before and above the neck's first joint: lower in front, or it would hit the chin.
COLLAR_BALL, COLLAR_RADIUS = (0.0, -0.035, 0.045), 0.105  # [m], against that joint
EASE_TOP, EASE_HEM, EASE_SLEEVE = 0.007, 0.035, 0.020  # [m] off the skin at the shoulders, the hem, in the sleeves
EASE_ARMPIT = 0.10  # [m] more, before smoothing, where sleeve and side meet
SMOOTHING = 10  # rounds between two times of keeping off the skin
TIGHTS_EASE = 0.006  # [m], by which the tights are off the skin already


def cut(
    points: np.ndarray, faces: np.ndarray, arm: np.ndarray, joints: dict[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cut the T-shirt out of the tights.

    Args:
        points: Tights [m], shape (V, 3); faces: shape (F, 3).
        arm: How far a vertex belongs to an arm by its skin weights, 0 to 1, shape (V,).
        joints: Positions [m] of the joints.

    Returns:
        Points, faces and `arm` of the T-shirt.
    """
    shoulder, elbow = joints["upper_arm.L"], joints["fore_arm.L"]
    cuff = shoulder + SLEEVE * (elbow - shoulder)
    hem = joints["thigh.L"][2] - HEM_BELOW_HIPS
    neck = joints["neck"]
    ball = neck + COLLAR_BALL

    def of_arm(x: np.ndarray, level: np.ndarray, wanted: bool) -> np.ndarray:
        # Only faces of that limb, or the sleeve's plane slices the waist and the hem's the hands.
        return np.where((x[:, 3] > 0.5) == wanted, level, 1.0)

    table = np.column_stack([points, arm])
    for level in (  # sleeves, hem, neck, collar
        lambda x: of_arm(x, (cuff - x[:, :3]) @ (elbow - shoulder), True),
        lambda x: of_arm(x, x[:, 2] - hem, False),
        lambda x: neck[2] - x[:, 2],
        lambda x: np.linalg.norm(x[:, :3] - ball, axis=1) - COLLAR_RADIUS,
    ):
        table, faces, _ = clip(table, faces, level(np.column_stack([mirrored(table[:, :3]), table[:, 3]])))
    table, faces = largest_part(table, faces)
    return table[:, :3], faces, table[:, 3]


def mirrored(points: np.ndarray) -> np.ndarray:
    """All points on the left side, so that one plane serves both."""
    return np.column_stack([np.abs(points[:, 0]), points[:, 1:]])


def loosen(
    points: np.ndarray, faces: np.ndarray, arm: np.ndarray, joints: dict[str, np.ndarray], skin: Skin
) -> np.ndarray:
    """Widen what `cut` gave: close at the shoulders, loose at the belly, the hem and in the sleeves. Shape (V, 3) [m]."""
    shoulder, hip = joints["upper_arm.L"], joints["thigh.L"]
    down = np.clip((shoulder[2] - points[:, 2]) / (shoulder[2] - hip[2]), 0, 1)
    out = np.clip((np.abs(points[:, 0]) - shoulder[0] + 0.02) / 0.06, 0, 1)
    torso = EASE_TOP + (EASE_HEM - EASE_TOP) * np.minimum(1, 1.6 * down)
    sleeve = EASE_TOP + (EASE_SLEEVE - EASE_TOP) * out
    mean = averaging(faces, len(points))
    ease = (1 - arm) * torso + arm * sleeve
    facing = normals(points, faces)
    ease += EASE_ARMPIT * np.maximum(-facing[:, 2], 0) * 4 * arm * (1 - arm)  # armholes reach below the armpits
    for _ in range(20):
        ease, facing = mean @ ease, mean @ facing
    facing /= np.linalg.norm(facing, axis=1, keepdims=True)
    points = points + np.maximum(ease - TIGHTS_EASE, 0)[:, None] * facing
    # Cloth spans hollows: smooth, and keep off the skin.
    for _ in range(8):
        for _ in range(SMOOTHING):
            points = mean @ points
        points = push_out(points, faces, skin, 0.7 * ease, rounds=5)
    return points


def frontness(points: np.ndarray, joints: dict[str, np.ndarray]) -> np.ndarray:
    """Positive before the side seams, the shoulder seams and the lines along the sleeves, negative behind. Shape (V,)."""
    shoulder, elbow = joints["upper_arm.L"], joints["fore_arm.L"]
    middle = np.interp(np.abs(points[:, 0]), [shoulder[0], elbow[0]], [shoulder[1], elbow[1]])
    return middle - points[:, 1]
