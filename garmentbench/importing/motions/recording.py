"""A recording of a skeleton, as motion capture gives it: any joints, any rest pose, any unit, any axes."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation, Slerp

_SHARPEST = 0.4  # width of the low-pass before a recording is thinned out [frames of the new rate]


@dataclass(frozen=True)
class Recording:
    """A moving skeleton in its own unit and axes.

    Attributes:
        names: Of the joints, a parent before its children; the first is the root. Ends of chains count as joints.
        parents: Parent of each joint, -1 for the root, shape (J,).
        offsets: Place of each joint in its parent's frame [the recording's unit], shape (J, 3).
        rotations: Of each joint against its parent's frame, shape (T, J, 3, 3), float64.
        root: World position of the root joint [the recording's unit], shape (T, 3).
        fps: Frames a second.
        own_rest: Are rotations of zero a pose of the file's own, in its axes?
        notes: What was found and done while reading, for the user.
    """

    names: tuple[str, ...]
    parents: np.ndarray
    offsets: np.ndarray
    rotations: np.ndarray
    root: np.ndarray
    fps: float
    notes: tuple[str, ...] = ()
    own_rest: bool = True

    def __len__(self) -> int:
        return len(self.root)

    @property
    def seconds(self) -> float:
        """Time from the first frame to the last [s]."""
        return (len(self) - 1) / self.fps

    def frames(self, start: int, stop: int) -> "Recording":
        """The same recording, frames start to stop only."""
        return replace(self, rotations=self.rotations[start:stop], root=self.root[start:stop])

    def rest_pose(self) -> "Recording":
        """One frame: all rotations zero, the root at the origin."""
        identity = np.broadcast_to(np.eye(3), (1, len(self.names), 3, 3))
        return replace(self, rotations=identity, root=np.zeros((1, 3)))

    def in_axes(self, turn: np.ndarray, unit: float = 1.0) -> "Recording":
        """The same motion seen from other axes, which `turn`, shape (3, 3), takes the old ones to, and in another
        unit."""
        rotations = turn @ self.rotations @ turn.T
        return replace(self, rotations=rotations, root=unit * self.root @ turn.T, offsets=unit * self.offsets @ turn.T)


def world(recording: Recording) -> tuple[np.ndarray, np.ndarray]:
    """Forward kinematics.

    Returns:
        World rotations of the joints, shape (T, J, 3, 3), and their positions [the recording's unit], shape (T, J, 3).
    """
    rotations = recording.rotations.copy()
    positions = np.empty(rotations.shape[:2] + (3,))
    positions[:, 0] = recording.root
    for joint, parent in enumerate(recording.parents[1:], start=1):
        positions[:, joint] = positions[:, parent] + rotations[:, parent] @ recording.offsets[joint]
        rotations[:, joint] = rotations[:, parent] @ rotations[:, joint]
    return rotations, positions


def resample(recording: Recording, fps: float) -> Recording:
    """A recording of two frames or more at another frame rate: rotations by spherical interpolation, from the first
    frame on.

    The last frame is kept where rounded times make it fall short by a hundredth of a frame.

    What is faster than the new rate can show is filtered out first, so that it does not come back as jitter.
    """
    width = _SHARPEST * recording.fps / fps
    old = np.arange(len(recording)) / recording.fps
    new = np.arange(int(recording.seconds * fps + 0.01) + 1) / fps
    new = np.minimum(new, old[-1])
    rotations = np.empty((len(new),) + recording.rotations.shape[1:])
    for joint in range(len(recording.names)):
        turning = smooth_rotations(recording.rotations[:, joint], width)
        rotations[:, joint] = Slerp(old, Rotation.from_matrix(turning))(new).as_matrix()
    path = gaussian_filter1d(recording.root, width, axis=0, mode="nearest") if width > 0.5 else recording.root
    root = np.stack([np.interp(new, old, path[:, axis]) for axis in range(3)], axis=1)
    return replace(recording, rotations=rotations, root=root, fps=fps)


def smooth_rotations(rotations: np.ndarray, width: float) -> np.ndarray:
    """Rotations over time, shape (T, 3, 3), low-passed by a Gaussian of `width` frames on their quaternions; as they
    are where the width is below half a frame."""
    if width <= 0.5:
        return rotations
    quaternions = Rotation.from_matrix(rotations).as_quat()
    steps = np.sum(quaternions[1:] * quaternions[:-1], axis=1)
    quaternions[1:] *= np.cumprod(np.where(steps < 0, -1.0, 1.0))[:, None]  # q and -q are the same rotation
    return Rotation.from_quat(gaussian_filter1d(quaternions, width, axis=0, mode="nearest")).as_matrix()
