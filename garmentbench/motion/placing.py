"""What a scene changes in any motion: its speed, where it stops, and where the whole of it stands."""

import numpy as np

from garmentbench.scene import Motion


def frame_times(motion: Motion, frames: int, fps: float, warm_up: int) -> np.ndarray:
    """The time within the motion [s] of every frame, the warm-up's first (negative), shape (warm_up + frames,)."""
    frame = np.arange(-warm_up, frames)
    if motion.freeze_after is not None:
        frame = np.minimum(frame, motion.freeze_after)
    return frame * motion.speed / fps


def place(points: np.ndarray, motion: Motion) -> np.ndarray:
    """Turn points about the vertical axis, then move them, as the scene asks; shape (..., 3), float64.

    A garment's rest positions must go through this too before it is put on a placed body.
    """
    if motion.turn == 0 and not any(motion.translate):
        return np.asarray(points, np.float64)
    c, s = np.cos(np.radians(motion.turn)), np.sin(np.radians(motion.turn))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(points, np.float64) @ turn.T + np.array(motion.translate)
