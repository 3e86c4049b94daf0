"""The file of a clip (npz): a motion that has been retargeted once, for scenes and for others to read."""

import zipfile
from pathlib import Path

import numpy as np

from garmentbench.errors import UserError
from garmentbench.motion.clip import Clip
from garmentbench.scenes.bodies import BakedBody
from garmentbench.storage.atomic import written_whole
from garmentbench.storage.npz import DAMAGED, read_array

KIND = "garmentbench clip"
_ARRAYS = {"rotations": 4, "root": 2, "standing": 2, "fps": 0, "leg": 0}  # and their dimensions
_REMAKE = "make it again with `garmentbench import-motion`"
_MOST_COMPRESSED, _SMALL = 100, 64e6  # what claims to be larger than both [times, bytes] is not believed


def save_clip(clip: Clip, joint_names: tuple[str, ...], notes: str, path: Path) -> None:
    """Write a clip: its arrays (as in `Clip`; rotations and root in float32), joint names and provenance. Raises `UserError`."""
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


def load_arrays(path: Path) -> dict[str, np.ndarray]:
    """All arrays of an npz file, none of them pickled. Raises `UserError` for a file that is no npz, or cut off, or claims
    more than it has."""
    try:
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
            claimed, stored = sum(e.file_size for e in entries), path.stat().st_size
            if claimed > max(_SMALL, _MOST_COMPRESSED * stored):
                raise UserError(
                    f"{path}: {stored} bytes that claim to be {claimed / 1e9:.1f} GB; copy or make it again"
                )
            return {e.filename.removesuffix(".npy"): read_array(archive, e, stored) for e in entries}
    except DAMAGED as e:
        raise UserError(f"{path}: not a whole npz file ({' '.join(str(e).split())}); copy or make it again") from e


def clip_of(arrays: dict[str, np.ndarray], baked: BakedBody, path: Path) -> Clip:
    """The clip in a file's arrays. Raises `UserError` where one is missing, of a wrong shape, or not finite."""
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
