"""What a scene changes in any motion: its speed, where it stops, and where the whole of it stands."""

import numpy as np

from garmentbench.scenes.scene import Motion

FREEZE_TIME = 0.3  # seconds in which a body comes to a standstill


def played_frames(frame: np.ndarray, freeze_after: int | None, fps: float) -> np.ndarray:
    """Frames of a motion that have been played at each frame: as many, until the freeze stops them; C2."""
    if freeze_after is None:
        return frame.astype(np.float64)
    length = FREEZE_TIME * fps
    v = np.clip((frame - freeze_after) / length, 0.0, 1.0)
    return np.minimum(frame, freeze_after) + length * (v - v**3 + v**4 / 2)  # the integral of 1 - (3 v^2 - 2 v^3)


def place(points: np.ndarray, motion: Motion) -> np.ndarray:
    """Turn points about the vertical axis, then move them, as the scene asks; shape (..., 3), float64.

    A garment's rest positions must go through this too before it is put on a placed body.
    """
    if motion.turn == 0 and not any(motion.translate):
        return np.asarray(points, np.float64)
    c, s = np.cos(np.radians(motion.turn)), np.sin(np.radians(motion.turn))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(points, np.float64) @ turn.T + np.array(motion.translate)
