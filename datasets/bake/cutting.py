"""Garments cut out of MakeHuman's body-hugging surface with planes, and made loose."""

from dataclasses import dataclass

import numpy as np
from surface import Skin, averaging, clip, largest_part, normals, push_out

# The collar is cut with a ball before and above the neck's first joint: lower in front, or it would hit the chin.
COLLAR_BALL, COLLAR_RADIUS = (0.0, -0.035, 0.045), 0.105  # [m], against that joint
TIGHTS_EASE = 0.006  # [m], by which the tights are off the skin already
EASE_INSEAM = 0.010  # [m] off the skin where the legs begin, more further out
LEG_TOP = 0.10  # [m] below the hip joints


@dataclass(frozen=True)
class Pattern:
    """Where a garment ends and how loose it is.

    Attributes:
        sleeve: The joints between which the left sleeve is cut off, and the part of the way from one to the other [1].
        hem: Height of the lower edge [m].
        ease_top, ease_hem, ease_sleeve: Off the skin at the shoulders, from the belly down, in the sleeves [m].
        ease_armpit: More of it, before smoothing, where sleeve and side meet [m].
        rounds: How often it is smoothed and pushed off the skin again; cloth spans hollows.
    """

    sleeve: tuple[str, str, float]
    hem: float
    ease_top: float
    ease_hem: float
    ease_sleeve: float
    ease_armpit: float
    rounds: int = 8


def cut(
    points: np.ndarray, faces: np.ndarray, arm: np.ndarray, joints: dict[str, np.ndarray], pattern: Pattern
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cut a garment out of the tights.

    Args:
        points: Tights [m], shape (V, 3); faces: shape (F, 3).
        arm: How far a vertex belongs to an arm by its skin weights, 0 to 1, shape (V,).
        joints: Positions [m] of the joints.
        pattern: Where.

    Returns:
        Points, faces and `arm` of the garment.
    """
    start, end = (joints[name] for name in pattern.sleeve[:2])
    cuff = start + pattern.sleeve[2] * (end - start)
    neck = joints["neck"]
    ball = neck + COLLAR_BALL

    def of_arm(x: np.ndarray, level: np.ndarray, wanted: bool) -> np.ndarray:
        # Only faces of that limb, or the sleeve's plane slices the waist and the hem's the hands.
        return np.where((x[:, 3] > 0.5) == wanted, level, 1.0)

    table = np.column_stack([points, arm])
    for level in (  # sleeves, hem, neck, collar
        lambda x: of_arm(x, (cuff - x[:, :3]) @ (end - start), True),
        lambda x: of_arm(x, x[:, 2] - pattern.hem, False),
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
    points: np.ndarray,
    faces: np.ndarray,
    arm: np.ndarray,
    joints: dict[str, np.ndarray],
    pattern: Pattern,
    skin: Skin,
) -> np.ndarray:
    """Widen what `cut` gave, as the pattern says. Shape (V, 3) [m]."""
    shoulder, hip = joints["upper_arm.L"], joints["thigh.L"]
    down = np.clip((shoulder[2] - points[:, 2]) / (shoulder[2] - hip[2]), 0, 1)
    out = np.clip((np.abs(points[:, 0]) - shoulder[0] + 0.02) / 0.06, 0, 1)
    torso = pattern.ease_top + (pattern.ease_hem - pattern.ease_top) * np.minimum(1, 1.6 * down)
    sleeve = pattern.ease_top + (pattern.ease_sleeve - pattern.ease_top) * out
    mean = averaging(faces, len(points))
    ease = (1 - arm) * torso + arm * sleeve
    facing = normals(points, faces)
    ease += pattern.ease_armpit * np.maximum(-facing[:, 2], 0) * 4 * arm * (1 - arm)  # armholes reach below the armpits
    between = points[:, 2] < hip[2] - LEG_TOP  # the thighs there is little room
    ease[between] = np.minimum(ease, EASE_INSEAM + 0.1 * np.abs(points[:, 0]))[between]
    for _ in range(20):
        ease, facing = mean @ ease, mean @ facing
    facing /= np.linalg.norm(facing, axis=1, keepdims=True)
    points = points + np.maximum(ease - TIGHTS_EASE, 0)[:, None] * facing
    for _ in range(pattern.rounds):
        for _ in range(10):
            points = mean @ points
        points = push_out(points, faces, skin, 0.7 * ease, rounds=5)
    return points


def grown(points: np.ndarray, faces: np.ndarray, by: np.ndarray | float) -> np.ndarray:
    """The garment for a body that is larger on all sides by so much [m], shape (V,), evened out; shape (V, 3) [m]."""
    facing, mean = normals(points, faces), averaging(faces, len(points))
    by = np.broadcast_to(by, len(points))
    for _ in range(40):
        by, facing = mean @ by, mean @ facing
    return points + (by / np.linalg.norm(facing, axis=1))[:, None] * facing


def frontness(points: np.ndarray, joints: dict[str, np.ndarray]) -> np.ndarray:
    """Positive before the side seams, the shoulder seams and the lines along sleeves and legs; shape (V,)."""
    shoulder, elbow, wrist = joints["upper_arm.L"], joints["fore_arm.L"], joints["hand.L"]
    hip, knee, ankle = joints["thigh.L"], joints["calf.L"], joints["foot.L"]
    along_arm = np.interp(np.abs(points[:, 0]), *np.array([shoulder, elbow, wrist])[:, :2].T)
    along_leg = np.interp(points[:, 2], [ankle[2], knee[2], hip[2] - LEG_TOP], [ankle[1], knee[1], shoulder[1]])
    return np.where(points[:, 2] < hip[2] - LEG_TOP, along_leg, along_arm) - points[:, 1]
