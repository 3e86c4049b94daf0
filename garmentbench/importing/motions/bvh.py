"""Reading BVH, the Biovision hierarchy: joints with offsets and channels in any order, then one line of numbers a frame.

Angles are in degrees and applied in the order of the channels (the first outermost). Position channels take the place of
the joint's offset, as in Blender; joints below the root have bones of constant length, so of theirs the median counts.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from garmentbench.errors import UserError
from garmentbench.importing.motions.recording import Recording

LARGEST = 80e6  # bytes of a file: some eight minutes, which take 2 GB of memory
_REMAKE = "export the motion as BVH again"
_CHANNELS = {f"{axis}{kind}" for axis in "XYZ" for kind in ("position", "rotation")}
_FASTEST = 1000.0  # frames a second
_HEAD = re.compile(r"\s*Frames:\s*(\S+)\s+Frame\s+Time:\s*(\S+)")
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


@dataclass
class _Joint:
    name: str
    parent: int
    offset: list[float] = field(default_factory=list)
    channels: list[str] = field(default_factory=list)


class _Words:
    """The words of a hierarchy, one after the other; complaints name the file."""

    def __init__(self, path: Path, text: str) -> None:
        self.path, self.words, self.at = path, text.split(), 0

    def next(self, wanted: str) -> str:
        if self.at == len(self.words):
            raise UserError(f"{self.path}: the hierarchy ends too early, wanted {wanted}; {_REMAKE}")
        self.at += 1
        return self.words[self.at - 1]

    def number(self, wanted: str) -> float:
        word = self.next(wanted)
        return _number(self.path, word, wanted)

    def until_brace(self, wanted: str) -> str:
        words = []
        while (word := self.next(f"{wanted} and {{")) != "{":
            words.append(word)
        return " ".join(words)


def read_bvh(path: Path) -> Recording:
    """Read a BVH file.

    Returns:
        The recording in the file's own unit and axes. The end of a chain below joint "X" is called "X end".

    Raises:
        UserError: The file can't be read, is cut off, or has text, too few or too many numbers somewhere.
    """
    text = _text(path)
    head, mark, motion = text.partition("MOTION")
    if not head.lstrip().startswith("HIERARCHY") or not mark:
        missing = "MOTION" if head.lstrip().startswith("HIERARCHY") else "HIERARCHY"
        raise UserError(f"{path}: no BVH file, or cut off: {missing} is missing; {_REMAKE}")
    joints = _hierarchy(_Words(path, head.lstrip().removeprefix("HIERARCHY")))
    values, fps = _motion(path, motion, sum(len(j.channels) for j in joints))
    return _recording(joints, values, fps)


def _text(path: Path) -> str:
    try:
        if path.stat().st_size > LARGEST:
            raise UserError(f"{path}: larger than {LARGEST / 1e6:.0f} MB; cut the motion into shorter files")
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError as e:
        raise UserError(f"{path}: can't be read ({e.strerror or e}); wanted a BVH file") from e


def _number(path: Path, word: str, wanted: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise UserError(f"{path}: '{word[:40]}' where {wanted} should be; {_REMAKE}")
    return value


def _hierarchy(words: _Words) -> list[_Joint]:
    """All joints of a hierarchy, parents first; ends of chains are joints without channels."""
    if (word := words.next("ROOT")) != "ROOT":
        raise UserError(f"{words.path}: '{word[:40]}' where ROOT should be; {_REMAKE}")
    joints = [_Joint(words.until_brace("the root's name"), -1)]
    above = [0]  # the joints whose braces are open
    while above:
        joint = joints[above[-1]]
        match words.next(f"}} after joint '{joint.name}'"):
            case "OFFSET":
                joint.offset = [words.number(f"an offset of joint '{joint.name}'") for _ in range(3)]
            case "CHANNELS":
                joint.channels = _channels(words, joint)
            case "JOINT":
                joints.append(_Joint(words.until_brace("a joint's name"), above[-1]))
                above.append(len(joints) - 1)
            case "End":
                words.until_brace("Site")
                joints.append(_Joint(f"{joint.name} end", above[-1]))
                above.append(len(joints) - 1)
            case "}":
                above.pop()
            case word:
                raise UserError(
                    f"{words.path}: '{word[:40]}' in joint '{joint.name}'; wanted OFFSET, CHANNELS, JOINT, "
                    f"End Site or }}; {_REMAKE}"
                )
    if words.at < len(words.words):
        raise UserError(
            f"{words.path}: '{words.words[words.at][:40]}' after the root's last }}; wanted one root; {_REMAKE}"
        )
    _check(words.path, joints)
    return joints


def _channels(words: _Words, joint: _Joint) -> list[str]:
    count = words.number(f"the number of channels of joint '{joint.name}'")
    if count not in range(7):
        raise UserError(f"{words.path}: joint '{joint.name}' has {count:g} channels; wanted 0 to 6; {_REMAKE}")
    channels = [words.next(f"channels of joint '{joint.name}'") for _ in range(int(count))]
    bad = [c for c in channels if c not in _CHANNELS] + [c for c in set(channels) if channels.count(c) > 1]
    if bad:
        raise UserError(
            f"{words.path}: channel '{bad[0][:40]}' of joint '{joint.name}'; wanted {int(count)} different "
            f"ones, such as Xposition or Zrotation; {_REMAKE}"
        )
    return channels


def _check(path: Path, joints: list[_Joint]) -> None:
    names = [j.name for j in joints]
    for joint in joints:
        if not joint.offset:
            raise UserError(f"{path}: joint '{joint.name}' has no OFFSET; {_REMAKE}")
        if not joint.name.endswith(" end") and names.count(joint.name) > 1:
            raise UserError(f"{path}: two joints are called '{joint.name}'; rename one of them")


def _motion(path: Path, text: str, channels: int) -> tuple[np.ndarray, float]:
    """The numbers of all frames, shape (T, channels), and the frame rate."""
    head = _HEAD.match(text)
    if head is None:
        raise UserError(f"{path}: MOTION does not begin with 'Frames:' and 'Frame Time:'; {_REMAKE}")
    frames, period = _number(path, head[1], "the number of frames"), _number(path, head[2], "the frame time")
    if frames < 1 or frames != int(frames):
        raise UserError(f"{path}: {head[1][:40]} frames; wanted at least one; {_REMAKE}")
    if period < 1 / _FASTEST or period > 10:
        raise UserError(
            f"{path}: frame time is {period:g} s; wanted {1 / _FASTEST:g} to 10 s; mend the line 'Frame Time:'"
        )
    values = _numbers(path, text[head.end() :], channels)
    if channels == 0 or len(values) != int(frames) * channels:
        raise UserError(
            f"{path}: {len(values)} numbers where {int(frames)} frames of {channels} channels want "
            f"{int(frames) * channels}: cut off, or the hierarchy is another's; {_REMAKE}"
        )
    return values.reshape(int(frames), channels), 1 / period


def _numbers(path: Path, text: str, channels: int) -> np.ndarray:
    """All numbers of a text, line by line, so that never more than a line is there as words."""
    rows, count = [np.zeros(0)], 0
    for line in text.splitlines():
        words = line.split()
        try:
            row = np.array([float(word) for word in words])
        except ValueError:
            row = np.array([float(word) if _NUMBER.fullmatch(word) else np.nan for word in words])
        bad = np.flatnonzero(~np.isfinite(row))
        if len(bad):
            frame = (count + bad[0]) // max(channels, 1)
            raise UserError(f"{path}: '{words[bad[0]][:40]}' in frame {frame}, where a number should be; {_REMAKE}")
        rows.append(row)
        count += len(row)
    return np.concatenate(rows)


def _recording(joints: list[_Joint], values: np.ndarray, fps: float) -> Recording:
    frames = len(values)
    offsets = np.array([j.offset for j in joints])
    rotations = np.tile(np.eye(3), (frames, len(joints), 1, 1))
    root = np.tile(offsets[0], (frames, 1))
    column = 0
    for i, joint in enumerate(joints):
        own = values[:, column : column + len(joint.channels)]
        column += len(joint.channels)
        turns = [c for c, channel in enumerate(joint.channels) if channel.endswith("rotation")]
        for c, channel in enumerate(joint.channels):
            if channel.endswith("position") and i == 0:
                root[:, "XYZ".index(channel[0])] = own[:, c]
            elif channel.endswith("position"):
                offsets[i, "XYZ".index(channel[0])] = np.median(own[:, c])
        if turns:
            axes = "".join(joint.channels[c][0] for c in turns)  # capitals: each about the axes as already turned
            rotations[:, i] = Rotation.from_euler(axes, own[:, turns], degrees=True).as_matrix()
    parents = np.array([j.parent for j in joints])
    return Recording(tuple(j.name for j in joints), parents, offsets, rotations, root, fps)
