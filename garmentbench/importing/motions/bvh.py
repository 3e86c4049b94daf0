"""Reading BVH, the Biovision hierarchy: joints with offsets and channels in any order, then one line of numbers a
frame.

Angles are in degrees and applied in the order of the channels (the first outermost). Position channels take the place
of the joint's offset, as in Blender. Where almost the whole skeleton hangs from a joint that moves below the root (hips
below an armature), that joint becomes the root; other joints have bones of constant length, so the median of theirs
counts.

Read are also, as other programs do: rows beyond `Frames:`, and fewer (more than half) if each is a whole line, byte
order marks, keywords in any case, comments (# or //).
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from garmentbench.errors import UserError
from garmentbench.importing.motions.moving_joint import from_moving_joint
from garmentbench.importing.motions.recording import Recording
from garmentbench.importing.text import decoded

LARGEST = 80e6  # bytes of a file: some eight minutes, which take 2 GB of memory
_REMAKE = "export the motion as BVH again"
_CHANNELS = {f"{axis}{kind}".lower(): f"{axis}{kind}" for axis in "XYZ" for kind in ("position", "rotation")}
_FASTEST = 1000.0  # frames a second
_HEAD = re.compile(r"\s*Frames:\s*(\S+)\s+Frame\s+Time:\s*(\S+)", re.IGNORECASE)
_COMMENT = re.compile(r"(?:^|(?<=\s))(?:#|//).*$", re.MULTILINE)
_RATES = (24, 25, 30, 48, 50, 60, 72, 90, 100, 120, 125, 144, 200, 240)  # of which frame times are the rounded inverse
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


def read_bvh(path: Path, fps: float | None = None) -> Recording:
    """Read a BVH file.

    Args:
        path: The file.
        fps: Frames a second, in place of what the file says; None: as it says.

    Returns:
        The recording in the file's own unit and axes. The end of a chain below joint "X" is called "X end".

    Raises:
        UserError: The file can't be read, is cut off, or has text, too few or too many numbers somewhere.
    """
    text = _text(path)
    split = re.search(r"^\s*MOTION\b", text, re.IGNORECASE | re.MULTILINE)
    head = (text if split is None else text[: split.start()]).lstrip()
    if head[:9].upper() != "HIERARCHY" or split is None:
        missing = "MOTION" if head[:9].upper() == "HIERARCHY" else "HIERARCHY"
        raise UserError(f"{path}: no BVH file, or cut off: {missing} is missing; {_REMAKE}")
    joints = _hierarchy(_Words(path, head[9:]))
    values, rate, notes = _motion(path, text[split.end() :], sum(len(j.channels) for j in joints), fps)
    return _recording(joints, values, rate, notes)


def _text(path: Path) -> str:
    try:
        if path.stat().st_size > LARGEST:
            raise UserError(f"{path}: larger than {LARGEST / 1e6:.0f} MB; cut the motion into shorter files")
        data = path.read_bytes()
        text = decoded(data)
        return _COMMENT.sub("", text) if "#" in text or "//" in text else text
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
    if (word := words.next("ROOT")).upper() != "ROOT":
        raise UserError(f"{words.path}: '{word[:40]}' where ROOT should be; {_REMAKE}")
    joints = [_Joint(words.until_brace("the root's name"), -1)]
    above = [0]  # the joints whose braces are open
    while above:
        joint = joints[above[-1]]
        word = words.next(f"}} after joint '{joint.name}'")
        match word.upper():
            case "OFFSET":
                joint.offset = [words.number(f"an offset of joint '{joint.name}'") for _ in range(3)]
            case "CHANNELS":
                joint.channels = _channels(words, joint)
            case "JOINT":
                joints.append(_Joint(words.until_brace("a joint's name"), above[-1]))
                above.append(len(joints) - 1)
            case "END":
                words.until_brace("Site")
                joints.append(_Joint(f"{joint.name} end", above[-1]))
                above.append(len(joints) - 1)
            case "}":
                above.pop()
            case _:
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
    channels = [_CHANNELS.get(c.lower(), c) for c in channels]
    bad = [c for c in channels if c.lower() not in _CHANNELS] + [c for c in set(channels) if channels.count(c) > 1]
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


def _motion(path: Path, text: str, channels: int, fps: float | None) -> tuple[np.ndarray, float, list[str]]:
    """The numbers of all frames, shape (T, channels), the frame rate, and notes on both."""
    head = _HEAD.match(text)
    if head is None:
        raise UserError(f"{path}: MOTION does not begin with 'Frames:' and 'Frame Time:'; {_REMAKE}")
    frames, period = _number(path, head[1], "the number of frames"), _number(path, head[2], "the frame time")
    if frames < 1 or frames != int(frames):
        raise UserError(f"{path}: {head[1][:40]} frames; wanted at least one; {_REMAKE}")
    if fps is None and (period < 1 / _FASTEST or period > 10):
        raise UserError(
            f"{path}: frame time is {period:g} s; wanted {1 / _FASTEST:g} to 10 s"
            + (" (is it a rate, or milliseconds?)" if period > 10 else "")
            + "; say how many frames a second it has with --recording-fps"
        )
    values, rows = _numbers(path, text[head.end() :], channels)
    whole = (
        rows is not None
        and rows * channels == len(values)
        and (rows > frames or (rows > 1 and 2 * rows > frames and text[-1] == "\n"))
    )
    if channels == 0 or (len(values) != frames * channels and not whole):
        raise UserError(
            f"{path}: {len(values)} numbers where {int(frames)} frames of {channels} channels want "
            f"{int(frames) * channels}: cut off, or the hierarchy is another's; {_REMAKE}"
        )
    values = values.reshape(-1, channels)
    notes = _row_note(len(values), int(frames))
    if fps is not None:
        stated = f"{1 / period:.4g}" if period > 0 else head[2]
        return values, fps, [*notes, f"{fps:g} frames a second, as --recording-fps says; the file says {stated}"]
    rate = _rate(head[2], period)
    if abs(rate * period - 1) > 1e-4:
        notes.append(f"frame time {head[2]} s: taken as 1/{rate:g} s, rounded")
    return values, rate, notes


def _row_note(rows: int, said: int) -> list[str]:
    """A line where there are more or fewer whole rows than a file says."""
    if rows < said:
        return [f"warning: {rows} rows where 'Frames:' says {said}: cut off behind them? All that are there are read"]
    return [f"{rows} rows where 'Frames:' says {said}: all of them read"] if rows > said else []


def _rate(word: str, period: float) -> float:
    """Frames a second of a frame time [s] as it is written: of 0.033 and .0333332 30, though 1/0.033 is 30.3."""
    nearest = round(1 / period)
    if nearest and abs(1 / period - nearest) < 1e-9 * nearest:
        return 1 / period
    decimals = len(word.partition(".")[2]) if "e" not in word.lower() else 0
    half = 0.5 * 10.0**-decimals if decimals >= 3 else 0.0
    for rate in (*_RATES, nearest):
        if rate and abs(period - 1 / rate) <= max(half * (rate in _RATES), 1e-5 / rate):
            return float(rate)
    return 1 / period


def _numbers(path: Path, text: str, channels: int) -> tuple[np.ndarray, int | None]:
    """All numbers of a text, line by line, so that never more than a line is there as words; and the number of lines,
    None where not every line is a whole frame."""
    rows, count, lines, even = [np.zeros(0)], 0, 0, True
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
        lines += bool(words)
        even &= len(row) in (0, channels)
    return np.concatenate(rows), lines if even else None


def _recording(joints: list[_Joint], values: np.ndarray, fps: float, notes: list[str]) -> Recording:
    frames = len(values)
    notes += _radians(joints, values)
    offsets = np.array([j.offset for j in joints])
    rotations = np.tile(np.eye(3), (frames, len(joints), 1, 1))
    paths: dict[int, np.ndarray] = {}  # of joints with position channels, in the parent's frame, shape (T, 3)
    column = 0
    for i, joint in enumerate(joints):
        own = values[:, column : column + len(joint.channels)]
        column += len(joint.channels)
        turns = [c for c, channel in enumerate(joint.channels) if channel.endswith("rotation")]
        moves = [c for c, channel in enumerate(joint.channels) if channel.endswith("position")]
        if moves or i == 0:
            paths[i] = np.tile(offsets[i], (frames, 1))
            paths[i][:, ["XYZ".index(joint.channels[c][0]) for c in moves]] = own[:, moves]
            offsets[i] = offsets[i] if i == 0 else np.median(paths[i], axis=0)
        if turns:
            axes = "".join(joint.channels[c][0] for c in turns)  # capitals: each about the axes as already turned
            rotations[:, i] = Rotation.from_euler(axes, own[:, turns], degrees=True).as_matrix()
    parents = np.array([j.parent for j in joints])
    complete = Recording(tuple(j.name for j in joints), parents, offsets, rotations, paths[0], fps)
    return from_moving_joint(complete, paths, notes)


def _radians(joints: list[_Joint], values: np.ndarray) -> list[str]:
    """A warning where no angle is ever larger than half a turn in radians."""
    angles = values[:, [channel.endswith("rotation") for joint in joints for channel in joint.channels]]
    if not angles.size or not 0.1 < np.abs(angles).max() < 3.15:  # a pose of zeros has none
        return []
    most = f"{np.abs(angles).max():.3g}"
    return [f"warning: no angle is above {most} degrees: are they radians? BVH has degrees; convert them"]
