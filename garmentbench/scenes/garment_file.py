"""A garment of the user's own, from an .npz file by `garmentbench check --fix` or an OBJ file.

In metres, z up, as worn by the base body in its rest pose. `garmentbench check` says everything that is wrong with a
mesh; here the first thing that makes it useless is enough.
"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from garmentbench.errors import UserError, unknown_name
from garmentbench.geometry.unwrap import in_order, split_corners, unwrap
from garmentbench.geometry.weld import TOGETHER, sewing_pairs, touching_borders
from garmentbench.scenes.roles import are_two_things, role_of
from garmentbench.scenes.scene import MeshFile
from garmentbench.sequence import Garment
from garmentbench.storage.npz import read_arrays

ENDINGS = (".npz", ".obj")
_SIZES = 0.05, 10.0  # [m] the diagonal of a garment's bounding box, least and most
_SHAPES = {"rest": ("f", (3,)), "faces": ("iu", (3,)), "uv": ("f", (2,)), "seams": ("iu", (2,)), "pins": ("iu", ())}
_CUT = ("f", (2,))
_TOP = re.compile(r"top (\d+(?:\.\d+)?) cm")


def garment_name(file: str) -> str:
    """What a garment is called after its file."""
    return re.sub(r"[^a-z0-9_]+", "_", Path(file).stem.lower()).strip("_") or "garment"


def read_garment(name: str, mesh: MeshFile) -> Garment:
    """The garment of a file, with its pins and seams. Raises `UserError`, one line, for what can't be worn."""
    path = Path(mesh.file)
    if path.suffix.lower() not in ENDINGS:
        raise UserError(f"{path}: wanted a mesh as {' or '.join(ENDINGS)}; `garmentbench check {path} --fix OUT.npz`")
    garment, groups = (_npz if path.suffix.lower() == ".npz" else _obj)(name, path)
    _refuse(path, garment)
    seams = [garment.seams.astype(np.int64)]
    if mesh.seams == "weld":
        seams.append(touching_borders(garment.rest, garment.faces, TOGETHER))
    elif not isinstance(mesh.seams, str):
        seams.append(_indices(path, "seams", mesh.seams, (-1, 2), len(garment.rest)))
    pairs = sewing_pairs(np.concatenate(seams), len(garment.rest))
    pins = garment.pins if mesh.pins is None else _pins(path, mesh.pins, garment, groups)
    return replace(garment, seams=pairs, pins=np.unique(pins).astype(np.int32))


def _pins(path: Path, pins: str | tuple[int, ...], garment: Garment, groups: dict[str, np.ndarray]) -> np.ndarray:
    if not isinstance(pins, str):
        return _indices(path, "pins", pins, (-1,), len(garment.rest))
    top = _TOP.fullmatch(pins)
    if top:
        height = garment.rest[:, 2]
        return np.flatnonzero(height >= height.max() - float(top[1]) / 100)
    if pins not in groups:
        raise UserError(f'{path}: {unknown_name("group of faces to pin", pins, groups)}; or pins = "top 3 cm"')
    return groups[pins]


def _indices(path: Path, key: str, given: tuple, shape: tuple[int, ...], count: int) -> np.ndarray:
    """Numbers of vertices as an array. Raises `UserError` for one that is not there."""
    numbers = np.array(given, np.int64).reshape(shape)
    if numbers.size and not 0 <= numbers.min() <= numbers.max() < count:
        found = f"{key} name vertices {numbers.min()} to {numbers.max()}"
        raise UserError(f"{path}: {found}; wanted 0 to {count - 1}, in the file's order")
    return numbers


def _refuse(path: Path, garment: Garment) -> None:
    """Raises `UserError` where no cloth can be made of it."""
    ask = f"`garmentbench check {path} --fix OUT.npz` says what is wrong and repairs it"
    faces, rest = garment.faces, garment.rest
    if not len(faces) or not 0 <= faces.min() <= faces.max() < len(rest):
        raise UserError(f"{path}: its faces are missing, or name vertices that are not there; {ask}")
    flat = () if garment.cut is None else (garment.cut,)
    if not all(np.isfinite(array).all() for array in (rest, garment.uv, *flat)):
        raise UserError(f"{path}: positions, UV or the cut are not finite; {ask}")
    size = float(np.linalg.norm(np.ptp(rest[faces.ravel()], axis=0)))
    if not _SIZES[0] < size < _SIZES[1]:
        raise UserError(f"{path}: {size:.3g} m across, is it in another unit? {ask}")
    if len(np.unique(faces)) < len(rest):
        raise UserError(f"{path}: {len(rest) - len(np.unique(faces))} vertices belong to no face; {ask}")
    if garment.uv.min() < 0 or garment.uv.max() > 1:
        raise UserError(f"{path}: its UV map leaves the unit square; {ask}")


def _npz(name: str, path: Path) -> tuple[Garment, dict[str, np.ndarray]]:
    wanted = "a garment's rest (V, 3), faces (F, 3), uv (V, 2), and any seams (S, 2), pins (P,), cut (V, 2)"
    again = "`garmentbench check` makes one of an OBJ file with --fix OUT.npz"
    arrays = {"seams": np.zeros((0, 2), np.int32), "pins": np.zeros(0, np.int32)}
    arrays |= read_arrays(path, wanted, again, _SHAPES | {"cut": _CUT})
    shapes = _SHAPES | ({"cut": _CUT} if "cut" in arrays else {})
    for key, (kinds, width) in shapes.items():
        array = arrays.get(key)
        if array is None or array.dtype.kind not in kinds or array.ndim < 1 or array.shape[1:] != width:
            raise UserError(f"{path}: {key} is missing or of another shape, wanted {wanted}; {again}")
    for key in sorted({"uv", "cut"} & set(arrays)):
        if len(arrays[key]) != len(arrays["rest"]):
            raise UserError(f"{path}: {key} has {len(arrays[key])} rows, rest {len(arrays['rest'])}; {again}")
    for key in ("seams", "pins"):
        _indices(path, key, arrays[key], (-1, *_SHAPES[key][1]), len(arrays["rest"]))
    kinds = {"f": np.float32, "iu": np.int32}
    return Garment(name, **{key: arrays[key].astype(kinds[kind]) for key, (kind, _) in shapes.items()}), {}


def _obj(name: str, path: Path) -> tuple[Garment, dict[str, np.ndarray]]:
    """An OBJ file, its UV map made where it has none; and the vertices of each group of faces (g, o)."""
    vertices, uvs, corners, corner_uv, groups = _obj_lines(path)
    _refuse_several(path)
    if not vertices or not corners:
        raise UserError(f"{path}: no vertices or no faces, wanted an OBJ mesh; export it again")
    rest, faces, uv = np.array(vertices), np.array(corners), np.array(corner_uv)
    if not 0 <= faces.min() <= faces.max() < len(rest) or uv.max() >= len(uvs):
        raise UserError(f"{path}: a face names a vertex or UV that is not there; export it again")
    has_uv = (uv >= 0).all()
    cut = in_order(len(rest), *split_corners(faces, np.array(uvs)[uv])) if has_uv else unwrap(rest, faces)
    copies = {group: np.flatnonzero(np.isin(cut.source, members)) for group, members in groups.items()}
    none = np.zeros(0, np.int32)
    return Garment(name, rest[cut.source].astype(np.float32), cut.faces, cut.uv, cut.seams, none), copies


def _refuse_several(path: Path) -> None:
    """Raises `UserError` where a file holds more than one garment: objects, or groups that say garment and body."""
    names: dict[str, dict[str, None]] = {"o": {}, "g": {}}
    now = {"o": "", "g": ""}
    for line in _text(path).splitlines():
        key, _, rest = line.strip().partition(" ")
        if key in names:
            now[key] = rest.strip()
        elif key == "f":
            for kind in names:
                names[kind].setdefault(now[kind])
    objects, groups = (tuple(names[kind]) for kind in ("o", "g"))
    several: list[str] = list(objects if len(objects) > 1 else groups if are_two_things(groups) else ())
    if several:
        listed = ", ".join(name or "(without a name)" for name in several[:8]) + (" ..." if len(several) > 8 else "")
        one = next((name for name in several if role_of(name) == "garment"), several[0])
        raise UserError(
            f"{path}: holds {len(several)} objects ({listed}), wanted one garment; `garmentbench check {path} --mesh "
            f"'{one}' --fix OUT.npz` takes one, or all of them (--mesh all)"
        )


def _obj_lines(path: Path) -> tuple[list, list, list, list, dict[str, np.ndarray]]:
    """Positions, UV coordinates, triangles, the UV number at their corners (-1: none), and the groups' vertices."""
    points, uvs, corners, corner_uv = [], [], [], []
    members: dict[str, set[int]] = {}
    open_groups: list[str] = []
    lines = _text(path).splitlines()
    for number, line in enumerate(lines, start=1):
        key, *words = line.split() or [""]
        try:
            if key in ("v", "vt"):
                x, y, *z = map(float, words)
                (points if key == "v" else uvs).append([x, y, z[0]] if key == "v" else [x, y])
            elif key in ("g", "o"):
                open_groups = words
            elif key == "f":
                at, uv = zip(*(_corner(word, len(points), len(uvs)) for word in words), strict=True)
                for k in range(1, len(at) - 1):
                    corners.append([at[0], at[k], at[k + 1]])
                    corner_uv.append([uv[0], uv[k], uv[k + 1]])
                for group in open_groups:
                    members.setdefault(group, set()).update(at)
        except (ValueError, IndexError) as e:
            raise UserError(f"{path}: line {number} is '{line.strip()[:60]}', wanted OBJ; export it again") from e
    return points, uvs, corners, corner_uv, {group: np.array(sorted(at)) for group, at in members.items()}


def _corner(word: str, points: int, uvs: int) -> tuple[int, int]:
    """Vertex and UV of a face's corner from 0 (-1: no UV); negative numbers count from the last one so far."""
    vertex, _, rest = word.partition("/")
    v, t = int(vertex), int(rest.partition("/")[0] or 0)
    return (v - 1 if v > 0 else points + v), (t - 1 if t >= 0 else uvs + t)


def _text(path: Path) -> str:
    try:
        return path.read_text("utf-8-sig").replace("\\\n", " ")  # lines may go on
    except OSError as e:
        raise UserError(f"{path}: {e.strerror}; wanted an OBJ mesh") from e
    except UnicodeDecodeError as e:
        raise UserError(f"{path}: no text, wanted an OBJ mesh; export it again") from e
