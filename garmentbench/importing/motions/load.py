"""From a file to a clip on a body: what kind of file it is, and the steps in between."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from garmentbench.errors import UserError
from garmentbench.importing.motions.amass import amass_recording, is_amass
from garmentbench.importing.motions.bvh import read_bvh
from garmentbench.importing.motions.names import NameMap, map_names
from garmentbench.importing.motions.recording import Recording
from garmentbench.importing.motions.retarget import retarget
from garmentbench.importing.motions.skeleton import Upright, bring_upright
from garmentbench.motion.arms import turn_out
from garmentbench.motion.clip import Clip
from garmentbench.motion.clip_file import clip_of, load_arrays
from garmentbench.motion.planting import plant
from garmentbench.scenes.bodies import BakedBody
from garmentbench.scenes.scene import Motion


@dataclass(frozen=True)
class Loaded:
    """A clip with where it came from.

    Attributes:
        clip: On the body, its feet planted.
        unplanted: The same before planting; None of a clip's own file.
        recording: As it was in the file; None of a clip's own file.
        names: Whose joints are whose; None of a clip's own file.
        upright: What was found out of the skeleton; None of a clip's own file.
    """

    clip: Clip
    unplanted: Clip | None = None
    recording: Recording | None = None
    names: NameMap | None = None
    upright: Upright | None = None


def load_clip(motion: Motion, baked: BakedBody, fps: float) -> Loaded:
    """The clip of `motion.file` (.bvh, AMASS's .npz, or a clip's .npz) on a body, at `fps` frames a second.

    Of the motion its file, map, start, stop and arm space count. Raises `UserError` for a file that is none of these, cut
    off or malformed, and for times outside it; `UsageError` for wrong names in the map.
    """
    path = Path(motion.file)
    found = _read(path, baked)
    if (len(found) - 1) / found.fps * fps < 1 - 1e-6:
        raise UserError(
            f"{path}: {len(found)} frames at {found.fps:.4g} a second; wanted two or more at {fps:g} a second"
        )
    if isinstance(found, Clip):
        clip = _at_rate(found, fps)
        return Loaded(plant(turn_out(_part(clip, motion, path), motion.arm_space, baked), baked))
    names = map_names(found.names, motion.map, str(path))
    joints = {ours: found.names.index(theirs) for ours, theirs in names.joints.items()}
    upright = bring_upright(found, joints, baked, str(path))
    unplanted = retarget(upright.at_rate(fps), baked)
    unplanted = turn_out(_part(unplanted, motion, path), motion.arm_space, baked)
    return Loaded(plant(unplanted, baked), unplanted, found, names, upright)


def _read(path: Path, baked: BakedBody) -> Recording | Clip:
    if not path.is_file():
        raise UserError(f"{path}: no such file; wanted a motion (.bvh or .npz)")
    if path.suffix.lower() == ".bvh":
        return read_bvh(path)
    if path.suffix.lower() != ".npz":
        raise UserError(f"{path}: wanted a motion as .bvh or .npz; export it as BVH")
    arrays = load_arrays(path)
    return amass_recording(arrays, path) if is_amass(arrays) else clip_of(arrays, baked, path)


def _at_rate(clip: Clip, fps: float) -> Clip:
    if clip.fps == fps:
        return clip
    frames = np.arange(int((len(clip) - 1) * fps / clip.fps + 1e-6) + 1) * clip.fps / fps
    return clip.at(frames, fps)


def _part(clip: Clip, motion: Motion, path: Path) -> Clip:
    """The part of a clip from `start` to `stop`."""
    seconds = (len(clip) - 1) / clip.fps
    stop = seconds if motion.stop is None else motion.stop
    first, last = round(motion.start * clip.fps), round(stop * clip.fps)
    if not (0 <= motion.start and first < last < len(clip)):
        raise UserError(
            f"{path}: from {motion.start:g} to {stop:g} s asked for, it has 0 to {seconds:.2f} s; change start or stop"
        )
    return clip.frames(first, last + 1)
