"""A clip: a recorded motion on our skeleton, and its file (.npz), which `garmentbench import-motion` writes."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from garmentbench.errors import UserError
from garmentbench.scenes.bodies import BakedBody
from garmentbench.storage.atomic import written_whole
from garmentbench.storage.npz import read_arrays

KIND = "garmentbench clip"
_ARRAYS = {"rotations": 4, "root": 2, "standing": 2, "fps": 0, "leg": 0}  # and their dimensions
_REMAKE = "make it again with `garmentbench import-motion`"


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
        """The clip at these frames, shape (N,), which need not be whole numbers.

        Rotations by spherical interpolation.
        """
        known = np.arange(len(self))
        frame = np.clip(frame, 0, len(self) - 1)
        rotations = np.empty((len(frame), *self.rotations.shape[1:]))
        for joint in range(self.rotations.shape[1]):
            rotations[:, joint] = Slerp(known, Rotation.from_matrix(self.rotations[:, joint]))(frame).as_matrix()
        root = np.stack([np.interp(frame, known, self.root[:, axis]) for axis in range(3)], axis=1)
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


def part(
    path: Path, seconds: float, fps: float, start: float, stop: float | None, to_end: bool = False
) -> tuple[int, int]:
    """First and last frame of the part from `start` to `stop` [s] (None: the end) of a motion that lasts `seconds`.

    `to_end`: a later stop is taken for the end. Raises `UserError` where the part isn't inside, or is no two frames
    long.
    """
    end = seconds if stop is None or (to_end and stop > seconds) else stop
    first, last, count = round(start * fps), round(end * fps), round(seconds * fps)
    if start < 0 or first >= count or last > count or end <= start:
        raise UserError(
            f"{path}: from {start:g} to {end:g} s asked for, it has 0 to {seconds:.2f} s; change start or stop"
        )
    if last == first:
        raise UserError(
            f"{path}: from {start:g} to {end:g} s is less than one of {fps:.4g} frames a second; wanted two frames or "
            "more; change start or stop"
        )
    return first, last


def save_clip(clip: Clip, joint_names: tuple[str, ...], notes: str, path: Path) -> None:
    """Write a clip: its arrays (as in `Clip`; rotations and root in float32), joint names and provenance.

    Raises `UserError`.
    """
    with written_whole(path) as partial, partial.open("wb") as file:
        np.savez_compressed(
            file,
            kind=np.array(KIND),
            rotations=clip.rotations.astype(np.float32),
            root=clip.root.astype(np.float32),
            standing=clip.standing,
            fps=np.array(clip.fps),
            leg=np.array(clip.leg),
            joint_names=np.array(joint_names),
            notes=np.array(notes),
        )


def read_clip(path: Path, baked: BakedBody) -> Clip:
    """The clip in a file of `save_clip`, at its own rate. Raises `UserError`."""
    if path.suffix.lower() != ".npz":
        raise UserError(
            f"{path}: not a clip (.npz); make one of the recording: garmentbench import-motion {path} "
            f"--out {path.with_suffix('.npz')}"
        )
    arrays = read_arrays(path, "a clip", _REMAKE)
    if "kind" not in arrays or str(arrays["kind"]) != KIND:
        raise UserError(
            f"{path}: not a clip; make one of the recording: garmentbench import-motion {path} --out clip.npz"
        )
    joints = len(baked.joint_names)
    for key, dimensions in _ARRAYS.items():
        if key not in arrays or arrays[key].ndim != dimensions or arrays[key].dtype.kind not in "fib":
            raise UserError(f"{path}: its array '{key}' is missing or wrong; {_REMAKE}")
        if not np.isfinite(arrays[key]).all():
            raise UserError(f"{path}: its array '{key}' is not finite; {_REMAKE}")
    frames = len(arrays["root"])
    shapes = {"rotations": (frames, joints, 3, 3), "root": (frames, 3), "standing": (frames, 2)}
    for key, shape in shapes.items():
        if arrays[key].shape != shape or frames == 0:
            raise UserError(
                f"{path}: '{key}' has shape {arrays[key].shape}, wanted {shape}, at least one frame; {_REMAKE}"
            )
    if tuple(arrays.get("joint_names", ())) != baked.joint_names:
        raise UserError(f"{path}: its joints are not the body's; {_REMAKE}")
    if not (0 < arrays["fps"] <= 1000 and 0.1 < arrays["leg"] < 10):
        raise UserError(f"{path}: {arrays['fps']:g} frames a second, legs of {arrays['leg']:g} m; {_REMAKE}")
    numbers = {key: arrays[key].astype(np.float64) for key in ("rotations", "root")}
    return Clip(**numbers, standing=arrays["standing"].astype(bool), fps=float(arrays["fps"]), leg=float(arrays["leg"]))
