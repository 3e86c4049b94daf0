"""Reading ASF and AMC, Acclaim's skeleton and motion: two text files, as CMU's motion capture has them.

A bone has at rest a direction in the world, a length, and axes of its own about which its degrees of freedom turn; it
is taken for the joint at its beginning. Its angles are applied about fixed axes, the first first: with C the rotation
of its axes, M that of its angles and R its parent's, its rotation is R C M C^T (ASF/AMC as described by M. Schafer,
"ASF Skeleton Definition Files and AMC Motion Files", Ohio State University).

An AMC file says no frame rate; CMU's clips have 120 or 60 a second.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from garmentbench.errors import UserError
from garmentbench.importing.motions.recording import Recording
from garmentbench.importing.text import decoded

LARGEST = 80e6  # bytes of a file
_TURNS = ("rx", "ry", "rz")
_MOVES = ("tx", "ty", "tz")
_DO = "copy or export it again, or use the motion's BVH"


@dataclass
class _Bone:
    """Direction times length [the file's unit], rotation of its axes, and its degrees of freedom."""

    along: np.ndarray
    axes: np.ndarray
    dof: tuple[str, ...]
    parent: str = ""


def read_amc(path: Path, fps: float | None = None) -> Recording:
    """Read an AMC file, and the ASF file of its skeleton beside it.

    Args:
        path: The AMC file. Its skeleton is the file beside it of its name, or of its name up to the last "_".
        fps: Frames a second, which the file doesn't say.

    Returns:
        The recording in the files' own unit and axes. The end of a chain below bone "x" is called "x end".

    Raises:
        UserError: A file is missing, can't be read, or doesn't belong to the other; or no rate is given.
    """
    if path.suffix.lower() == ".asf":
        raise UserError(f"{path}: a skeleton without motion; name the motion beside it, an .amc file")
    skeleton = _skeleton_of(path)
    bones, degrees, root_order = _bones(skeleton)
    rows = list(_frames(path, {**{name: len(b.dof) for name, b in bones.items() if b.dof}, "root": len(root_order)}))
    if not rows:
        raise UserError(f"{path}: has no frames, wanted lines such as '1' and 'root ...'; {_DO}")
    if fps is None:
        raise UserError(f"{path}: says no frame rate; give --recording-fps (CMU's clips have 120, some 60)")
    values = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    degrees = _angle_unit(path, degrees)
    note = f"skeleton: {skeleton.name}; {fps:g} frames a second, as --recording-fps says"
    return _recording(bones, values, root_order, degrees, fps, note)


def _skeleton_of(path: Path) -> Path:
    names = [path.stem, path.stem.rpartition("_")[0]]
    beside = sorted(p for p in path.parent.glob("*") if p.suffix.lower() == ".asf")
    found = [p for name in names for p in beside if p.stem.lower() == name.lower()] or (
        beside if len(beside) == 1 else []
    )
    if not found:
        wanted = " or ".join(f"{name}.asf" for name in names if name)
        raise UserError(f"{path}: its skeleton is not beside it; put {wanted} there, or use the motion's BVH")
    return found[0]


def _lines(path: Path) -> list[str]:
    """A text's lines without comments, blank ones left out."""
    try:
        if path.stat().st_size > LARGEST:
            raise UserError(f"{path}: larger than {LARGEST / 1e6:.0f} MB; cut the motion into shorter files")
        text = decoded(path.read_bytes())
    except OSError as e:
        raise UserError(f"{path}: can't be read ({e.strerror or e}); wanted an AMC file with an ASF beside it") from e
    return [line for raw in re.split(r"\r\n|\r|\n", text) if (line := raw.split("#")[0].strip())]


def _sections(path: Path) -> dict[str, list[str]]:
    """An ASF file's lines by the keyword they stand below, the rest of its line first."""
    sections: dict[str, list[str]] = {}
    lines: list[str] = []
    for line in _lines(path):
        if line.startswith(":"):
            key, _, rest = line[1:].partition(" ")
            lines = sections.setdefault(key.lower(), [])
            lines += [rest.strip()] if rest.strip() else []
        else:
            lines.append(line)
    missing = [key for key in ("root", "bonedata", "hierarchy") if key not in sections]
    if missing:
        raise UserError(f"{path}: no ASF skeleton, or cut off: :{missing[0]} is missing; {_DO}")
    return sections


def _bones(path: Path) -> tuple[dict[str, _Bone], bool, tuple[str, ...]]:
    """All bones by name, parents first, the root too; whether angles are degrees; and the root's channels."""
    sections = _sections(path)
    degrees = not any(line.lower().split() == ["angle", "rad"] for line in sections.get("units", []))
    root = {words[0].lower(): words[1:] for line in sections["root"] if (words := line.split())}
    order = tuple(word.lower() for word in root.get("order", []))
    if sorted(order) != sorted((*_MOVES, *_TURNS)):
        raise UserError(
            f"{path}: the root's order is '{' '.join(order)}', wanted TX TY TZ RX RY RZ in some order; {_DO}"
        )
    axes = _rotation(path, "root", [*root.get("orientation", ["0"] * 3), *root.get("axis", ["XYZ"])], degrees)
    bones = {"root": _Bone(np.zeros(3), axes, order)}
    for block in _blocks(sections["bonedata"]):
        name, bone = _bone(path, block, degrees)
        if name in bones:
            raise UserError(f"{path}: two bones are called '{name}'; rename one of them")
        bones[name] = bone
    parents = {}
    for line in sections["hierarchy"]:
        parent, *children = line.split()
        parents |= dict.fromkeys(children, parent)
    return _ordered(path, bones, parents), degrees, order


def _blocks(lines: list[str]) -> Iterator[dict[str, list[str]]]:
    """The words behind each keyword of one bone after another."""
    block: dict[str, list[str]] = {}
    for line in lines:
        words = line.split()
        if words[0].lower() == "end":
            yield block
        elif words[0].lower() == "begin":
            block = {}
        else:
            block[words[0].lower()] = words[1:]


def _bone(path: Path, block: dict[str, list[str]], degrees: bool) -> tuple[str, _Bone]:
    name = " ".join(block.get("name", []))
    if not name or "direction" not in block or "length" not in block:
        raise UserError(f"{path}: bone '{name}' has no name, direction or length; {_DO}")
    direction = _numbers(path, block["direction"], 3, f"the direction of bone '{name}'")
    length = _numbers(path, block["length"], 1, f"the length of bone '{name}'")[0]
    axes = _rotation(path, name, block.get("axis", ["0", "0", "0", "XYZ"]), degrees)
    dof = tuple(word.lower() for word in block.get("dof", []))
    odd = [word for word in dof if word not in _TURNS]
    if odd or len(set(dof)) < len(dof):
        raise UserError(f"{path}: bone '{name}' has the degrees of freedom '{' '.join(dof)}', wanted rx, ry, rz; {_DO}")
    return name, _Bone(length * direction / max(float(np.linalg.norm(direction)), 1e-12), axes, dof)


def _rotation(path: Path, name: str, words: list[str], degrees: bool) -> np.ndarray:
    """Three angles about fixed axes in the order behind them, as a matrix, shape (3, 3)."""
    order = words[3].lower() if len(words) > 3 else "xyz"
    if sorted(order) != ["x", "y", "z"]:
        raise UserError(
            f"{path}: the axis of bone '{name}' is of order '{order[:20]}', wanted XYZ in some order; {_DO}"
        )
    angles = _numbers(path, words[:3], 3, f"the axis of bone '{name}'")
    return Rotation.from_euler(order, angles[["xyz".index(axis) for axis in order]], degrees=degrees).as_matrix()


def _numbers(path: Path, words: list[str], count: int, what: str) -> np.ndarray:
    try:
        values = np.array([float(word) for word in words[:count]])
    except ValueError:
        values = np.array([np.nan])
    if len(values) < count or not np.isfinite(values).all():
        raise UserError(f"{path}: '{' '.join(words)[:40]}' where {what} should be; {_DO}")
    return values


def _ordered(path: Path, bones: dict[str, _Bone], parents: dict[str, str]) -> dict[str, _Bone]:
    """The bones that hang from the root, each after its parent."""
    out = {"root": bones["root"]}
    while len(out) < len(bones):
        ready = [n for n, parent in parents.items() if parent in out and n in bones and n not in out]
        if not ready:
            lost = next(name for name in bones if name not in out)
            raise UserError(f"{path}: bone '{lost}' doesn't hang from the root; wanted it in :hierarchy; {_DO}")
        for name in ready:
            bones[name].parent = parents[name]
            out[name] = bones[name]
    return out


def _angle_unit(path: Path, degrees: bool) -> bool:
    """Are an AMC file's angles degrees? As it says, else as its skeleton does."""
    said = [line.lower() for line in _lines(path)[:20] if line.startswith(":")]
    return degrees if not {":degrees", ":radians"} & set(said) else ":degrees" in said


def _frames(path: Path, widths: dict[str, int]) -> Iterator[dict[str, list[float]]]:
    """The numbers of each bone, frame after frame; all bones with degrees of freedom have some in each."""
    frame: dict[str, list[float]] | None = None
    number = 0
    for line in _lines(path):
        words = line.split()
        if line.startswith(":"):
            continue
        if len(words) == 1 and words[0].isdecimal():
            if frame is not None:
                yield _whole(path, number, frame, widths)
            frame, number = {}, int(words[0])
            continue
        name, *rest = words
        if frame is None or name not in widths:
            found = "before the first frame" if frame is None else f"in frame {number}, of no bone of the skeleton"
            raise UserError(f"{path}: '{line[:40]}' {found}; wanted the AMC of this skeleton; {_DO}")
        frame[name] = _numbers(
            path, rest, widths[name], f"{widths[name]} numbers of '{name}' in frame {number}"
        ).tolist()
    if frame is not None:
        yield _whole(path, number, frame, widths)


def _whole(path: Path, number: int, frame: dict[str, list[float]], widths: dict[str, int]) -> dict[str, list[float]]:
    missing = [name for name in widths if name not in frame]
    if missing:
        raise UserError(f"{path}: frame {number} has nothing of '{missing[0]}': cut off, or of another skeleton; {_DO}")
    return frame


def _recording(
    bones: dict[str, _Bone],
    values: dict[str, np.ndarray],
    root_order: tuple[str, ...],
    degrees: bool,
    fps: float,
    note: str,
) -> Recording:
    """Bones as joints at their beginnings, and the ends of chains."""
    names = list(bones)
    ends = [name for name in names if name not in {bone.parent for bone in bones.values()}]
    frames = len(values["root"])
    joints = [*names, *(f"{name} end" for name in ends)]
    above = [bones[name].parent for name in names] + ends
    parents = np.array([names.index(parent) if parent else -1 for parent in above])
    offsets = np.array([bones[parent].along if parent else np.zeros(3) for parent in above])
    rotations = np.tile(np.eye(3), (frames, len(joints), 1, 1))
    for i, name in enumerate(names):
        axes, dof = bones[name].axes, bones[name].dof
        turns = [k for k, channel in enumerate(dof) if channel in _TURNS]
        if turns:
            order = "".join(dof[k][1] for k in turns)  # small letters: about fixed axes
            own = Rotation.from_euler(order, values[name][:, turns], degrees=degrees).as_matrix().reshape(-1, 3, 3)
            rotations[:, i] = axes @ own @ axes.T
    root = values["root"][:, [root_order.index(channel) for channel in _MOVES]]
    return Recording(tuple(joints), parents, offsets, rotations, root, fps, (note,))
