"""A clip: a motion on our skeleton."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation, Slerp


@dataclass(frozen=True)
class Clip:
    """A motion of the baked body.

    Attributes:
        rotations: World-oriented bone rotations, shape (T, J, 3, 3), float64.
        root: Pelvis joint [m], shape (T, 3).
        standing: Is the left, right foot on the ground? Shape (T, 2), bool.
        fps: Frames a second.
        leg: Length of the legs [m] that `root` fits.
    """

    rotations: np.ndarray
    root: np.ndarray
    standing: np.ndarray
    fps: float
    leg: float

    def __len__(self) -> int:
        return len(self.root)

    def frames(self, start: int, stop: int) -> "Clip":
        """Frames start to stop only."""
        return replace(
            self, rotations=self.rotations[start:stop], root=self.root[start:stop], standing=self.standing[start:stop]
        )

    def at(self, frame: np.ndarray, fps: float) -> "Clip":
        """The clip at these frames, shape (N,), which need not be whole numbers: rotations by spherical interpolation."""
        whole = np.arange(len(self))
        frame = np.clip(frame, 0, len(self) - 1)
        rotations = np.empty((len(frame),) + self.rotations.shape[1:])
        for joint in range(rotations.shape[1]):
            rotations[:, joint] = Slerp(whole, Rotation.from_matrix(self.rotations[:, joint]))(frame).as_matrix()
        root = np.stack([np.interp(frame, whole, self.root[:, axis]) for axis in range(3)], axis=1)
        return replace(
            self, rotations=rotations, root=root, standing=self.standing[np.round(frame).astype(int)], fps=fps
        )

    def from_origin(self, frame: int) -> "Clip":
        """The clip turned about the vertical and moved, so that at `frame` its hips are over the origin and face -y."""
        x, y, _ = self.rotations[frame, 0, :, 0]  # where the pelvis' left points
        c, s = np.array([x, y]) / max(np.hypot(x, y), 1e-9)
        turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        root = (self.root - [*self.root[frame, :2], 0.0]) @ turn.T
        return replace(self, rotations=turn @ self.rotations, root=root)
