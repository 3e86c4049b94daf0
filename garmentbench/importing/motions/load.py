"""From a recording's file to a clip on a body: what kind of file it is, and the steps in between."""

from dataclasses import dataclass, field
from pathlib import Path

from garmentbench.errors import UserError
from garmentbench.importing.motions.acclaim import read_amc
from garmentbench.importing.motions.amass import ARRAYS, amass_recording, is_amass
from garmentbench.importing.motions.bvh import read_bvh
from garmentbench.importing.motions.names import NameMap, map_names
from garmentbench.importing.motions.recording import Recording
from garmentbench.importing.motions.retarget import retarget
from garmentbench.importing.motions.skeleton import Upright, bring_upright
from garmentbench.motion.arms import turn_out
from garmentbench.motion.clip import Clip
from garmentbench.motion.clip_animation import load_clip
from garmentbench.motion.planting import plant
from garmentbench.scenes.bodies import BakedBody
from garmentbench.storage.npz import read_arrays


@dataclass(frozen=True)
class Choices:
    """What the user says of a recording.

    Attributes:
        start, stop: Only this part of it [s]; None: to its end.
        arm_space: Hanging arms are turned outward by this [degrees].
        names: The recording's joint -> ours, where its names are unknown.
        recording_fps: Frames a second of the recording, in place of what its file says; None: as it says.
    """

    start: float = 0.0
    stop: float | None = None
    arm_space: float = 0.0
    names: dict[str, str] = field(default_factory=dict)
    recording_fps: float | None = None


@dataclass(frozen=True)
class ImportedClip:
    """A clip with where it came from.

    Attributes:
        clip: On the body, its feet planted.
        choices: What was chosen for it.
        unplanted: The same before planting; None of a clip's own file.
        recording: As it was in the file; None of a clip's own file.
        names: Whose joints are whose; None of a clip's own file.
        upright: What was found out of the skeleton; None of a clip's own file.
    """

    clip: Clip
    choices: Choices
    unplanted: Clip | None = None
    recording: Recording | None = None
    names: NameMap | None = None
    upright: Upright | None = None


def import_clip(path: Path, baked: BakedBody, fps: float, choices: Choices = Choices()) -> ImportedClip:
    """The clip of a file (.bvh, .amc, AMASS's .npz, or a clip's .npz) on a body, at `fps` frames a second.

    A stop beyond its end is its end. Raises `UserError` for a file that is none of these, cut off or malformed, and for
    a start outside it; `UsageError` for wrong names in the map.
    """
    found = _read(path, choices.recording_fps)
    if found is None:
        clip = load_clip(path, baked, fps, choices.start, choices.stop, choices.arm_space, to_end=True)
        return ImportedClip(clip, choices)
    _check_length(path, found, fps)
    names = map_names(found.names, choices.names, str(path))
    joints = {ours: found.names.index(theirs) for ours, theirs in names.joints.items()}
    upright = bring_upright(found, joints, baked, path, choices.start, choices.stop)
    _check_length(path, upright.recording, fps)
    unplanted = turn_out(retarget(upright.at_rate(fps), baked), choices.arm_space, baked)
    return ImportedClip(plant(unplanted, baked), choices, unplanted, found, names, upright)


def _check_length(path: Path, recording: Recording, fps: float) -> None:
    if recording.seconds * fps < 1 - 0.01:
        raise UserError(
            f"{path}: {len(recording)} frames at {recording.fps:.4g} a second; wanted two or more at {fps:g} a second"
        )


def _read(path: Path, fps: float | None) -> Recording | None:
    """The recording in a file; None where that is not one of another program's, as a clip's own."""
    if not path.is_file():
        raise UserError(f"{path}: no such file; wanted a motion (.bvh, .amc or .npz)")
    if path.suffix.lower() == ".bvh":
        return read_bvh(path, fps)
    if path.suffix.lower() in (".amc", ".asf"):
        return read_amc(path, fps)
    if path.suffix.lower() != ".npz":
        raise UserError(f"{path}: wanted a motion as .bvh, .amc (its .asf beside it) or .npz; export it as BVH")
    arrays = read_arrays(path, "a motion", "copy or make it again", (*ARRAYS, "kind"))
    return amass_recording(arrays, path, fps) if "kind" not in arrays or is_amass(arrays) else None
