"""When a foot stands on the ground, seen from how high and how fast ankle and toes are."""

import numpy as np
from scipy.ndimage import binary_closing, binary_opening

_SLOW = 0.35  # [m/s]
_REST = 0.15  # [m/s] of ankle and toes while a foot is flat; in rolling one of them is faster
_LOW = 0.05  # above the height at which it stands [m]
_SHORTEST = 0.1  # of a contact, and of a gap between two [s]


def standing_feet(ankles: np.ndarray, toes: np.ndarray | None, fps: float) -> np.ndarray:
    """Contact phases.

    Args:
        ankles: Left and right ankle [m, of a body of our size], shape (T, 2, 3).
        toes: Left and right toes; None where the recording has none.
        fps: Frames a second.

    Returns:
        Is the left, right foot on the ground? Shape (T, 2), bool.
    """
    points = [ankles] if toes is None else [ankles, toes]
    still = np.any([_still(p, fps, _SLOW) for p in points], axis=0)
    length = max(2, round(_SHORTEST * fps))
    window = np.ones((length, 1), bool)
    closed = binary_closing(np.pad(still, ((length, length), (0, 0)), mode="edge"), window)
    return binary_opening(closed, window)[length : len(closed) - length]


def flat_feet(ankles: np.ndarray, toes: np.ndarray | None, fps: float) -> np.ndarray:
    """When the whole foot is at rest on the ground, not rolling; as `standing_feet`."""
    points = [ankles] if toes is None else [ankles, toes]
    return np.all([_still(p, fps, _REST) for p in points], axis=0)


def _still(points: np.ndarray, fps: float, speed: float) -> np.ndarray:
    """Is a point slow, and near the height at which its slow moments are lowest? Shape (T, 2)."""
    slow = np.linalg.norm(np.gradient(points, 1 / fps, axis=0), axis=-1) < speed
    return slow & (points[..., 2] < standing_height(points, slow) + _LOW)


def standing_height(points: np.ndarray, standing: np.ndarray) -> np.ndarray:
    """The low end of the heights that a left and right point, shape (T, 2, 3), have while they stand [m], shape (2,).

    Each foot its own: in motion captured from video one may stand 20 cm above the other.
    """
    heights = np.where(standing | ~standing.any(axis=0), points[..., 2], np.nan)
    return np.nanpercentile(heights, 10, axis=0)
