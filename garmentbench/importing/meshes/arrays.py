"""Plain arrays by name, in a NumPy .npz or in anybody's HDF5 file (which may be written by h5py, MATLAB or Julia).

positions (or vertices)   shape (T, V, 3)
faces (or triangles)      shape (F, 3), counted from 0
uv                        shape (V, 2), or (F, 3, 2) by corner; optional
rest                      shape (V, 3); optional
pins                      shape (P,), vertices held fast to the body; optional
times                     shape (T,), when each frame is [s]; optional
fps, metres_per_unit, up  numbers, and "x", "y" or "z"; optional
units                     "m", "cm", "mm", "in" or "ft", in place of metres_per_unit; optional

In HDF5 the last four may be attributes of the file or of the positions too, and everywhere numbers may be text.
"""

import re
import zipfile
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from garmentbench.importing.meshes.conventions import UNITS
from garmentbench.importing.meshes.even_times import are_numbers, evenly_timed
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, checked_faces, refusal, size_of
from garmentbench.storage import hdf5
from garmentbench.storage.atomic import written_whole
from garmentbench.storage.npz import DAMAGED, read_array

_ALIASES = {"vertices": "positions", "triangles": "faces"}
_SHAPES = {"positions": (None, None, 3), "faces": (None, 3), "rest": (None, 3), "pins": (None,), "times": (None,)}
_WORDS = ("fps", "metres_per_unit", "up", "units")
_KNOWN = frozenset({*_SHAPES, *_ALIASES, *_WORDS, "uv"})
_UNIT_NAMES = {  # beside the keys of UNITS
    "met(er|re)s?": "m",
    "centimet(er|re)s?": "cm",
    "millimet(er|re)s?": "mm",
    "inch(es)?": "in",
    "foot|feet": "ft",
}
_UP = re.compile(r"\+?([xyz])([ _-]?(axis|up))?", re.IGNORECASE)
_AGAIN = "write it again; garmentbench import --help names the arrays"
_SAME_RATE = 0.01  # relative difference of two rates that are one


def read_npz(path: Path) -> MeshSequence:
    """An .npz file. Raises `UserError`, one line, for what is damaged, or lacks or has other arrays than these."""
    size = size_of(path, "an .npz file")
    arrays, there = {}, []
    try:
        with zipfile.ZipFile(path) as archive:
            for member in archive.infolist():
                name = member.filename.removesuffix(".npy")
                there.append(_ALIASES.get(name, name))
                if name in _KNOWN:
                    arrays[_ALIASES.get(name, name)] = read_array(archive, member, size)
    except DAMAGED as e:
        raise refusal(path, f"damaged, or no .npz file ({hdf5.reason(e)})", _AGAIN) from e
    return _mesh(path, arrays, there)


def read_hdf5(path: Path) -> MeshSequence:
    """An HDF5 file with these datasets at its root. Raises as `read_npz`.

    Old HDF5 has no checksums, and a damaged file may hang the library: `subprocess_reader.read_isolated` is the safe
    way to call it.
    """
    size_of(path, "an HDF5 file")
    arrays, there = {}, []
    try:
        with h5py.File(path, "r", locking=False) as file:
            there += [_ALIASES.get(name, name) for name in map(str, file)]
            for name in sorted(_KNOWN & set(file)):
                arrays[_ALIASES.get(name, name)] = _stored(file, name)
            for holder in (file, *(file[name] for name in ("positions", "vertices") if name in file)):
                for name in _WORDS:
                    if name not in arrays and name in holder.attrs:
                        arrays[name] = np.asarray(holder.attrs[name])
    except (*hdf5.DAMAGED, TypeError) as e:
        raise refusal(path, f"damaged, or no HDF5 file of a mesh ({hdf5.reason(e)})", _AGAIN) from e
    return _mesh(path, arrays, there)


def _stored(file: h5py.File, name: str) -> np.ndarray:
    """A dataset's array; a text of variable length, as other programs write it, by its own way."""
    link = file.get(name, getlink=True)
    text: Any = file[name] if name in _WORDS and isinstance(link, h5py.HardLink) else None
    if text is not None and h5py.check_string_dtype(text.dtype) is not None:
        return np.asarray(text[()])
    found = hdf5.dataset(file, name)
    assert found is not None  # since the name is there
    return np.asarray(found[()])


def write_npz(path: Path, mesh: MeshSequence) -> None:
    """All arrays as they are, in metres, z up. Raises `UserError` when it can't be written."""
    arrays = {
        "positions": mesh.frames,
        "faces": mesh.faces,
        "rest": mesh.still,
        "pins": mesh.pins,
        "fps": mesh.fps,
        "metres_per_unit": 1.0,
        "up": "z",
    }
    if mesh.corner_uv is not None:
        arrays["uv"] = mesh.corner_uv
    with written_whole(path) as partial, partial.open("wb") as file:
        np.savez(file, **arrays)


def _mesh(path: Path, arrays: dict[str, np.ndarray], there: list[str]) -> MeshSequence:
    """The mesh of the known arrays of a file; `there` are the names of all that is in it."""
    for name in ("positions", "faces"):
        if name not in arrays:
            others = ", ".join(sorted(there)[:10]) + (" ..." if len(there) > 10 else "")
            raise refusal(path, f"has no array '{name}' (found: {others or 'none'})", _AGAIN)
    for name, shape in _SHAPES.items():
        if name in arrays:
            _check(path, name, arrays[name], shape)
    vertices = arrays["positions"].shape[1]
    if "rest" in arrays and len(arrays["rest"]) != vertices:
        raise refusal(path, f"rest has {len(arrays['rest'])} vertices, positions have {vertices}", _AGAIN)
    if arrays["faces"].min() == 1 and arrays["faces"].max() == vertices:
        raise refusal(path, f"faces name vertices 1 to {vertices}, wanted them counted from 0", "subtract 1")
    faces = checked_faces(path, arrays["faces"].astype(np.int64), vertices)
    pins = arrays.get("pins", np.zeros(0)).astype(np.int32)
    if pins.size and not (pins.min() >= 0 and pins.max() < vertices):
        raise refusal(path, f"pins name vertices up to {pins.max()}, there are {vertices}", _AGAIN)
    times = arrays["times"].astype(np.float64) if "times" in arrays else None
    if times is not None and (len(times) != len(arrays["positions"]) or not np.isfinite(times).all()):
        raise refusal(path, f"times are {len(times)}, positions {len(arrays['positions'])} frames", _AGAIN)
    fps, numbered = _number(path, arrays, "fps"), ()
    if fps is not None and are_numbers(times):
        times = times / fps
        numbered = (f"its times are whole numbers, taken as numbers of frames, {fps:g} a second",)
    frames, times, rate, notes = evenly_timed(path, arrays["positions"], times)
    if fps and rate and abs(fps / rate - 1) > _SAME_RATE:
        raise refusal(path, f"fps is {fps:g}, its times are {rate:g} a second", "write only the one that is right")
    rest = arrays["rest"].astype(np.float32) if "rest" in arrays else None
    return MeshSequence(
        path.stem,
        frames,
        faces,
        _corner_uv(path, arrays.get("uv"), faces, vertices),
        rest,
        fps or rate,
        _unit(path, arrays),
        _up(path, arrays),
        times,
        pins=pins,
        notes=numbered + notes,
        files=(path,),
    )


def _check(path: Path, name: str, array: np.ndarray, shape: tuple[int | None, ...]) -> None:
    kinds = "iu" if name in ("faces", "pins") else "f"
    if name == "pins" and array.size == 0:
        return
    fits = array.ndim == len(shape) and all(w in (None, n) for w, n in zip(shape, array.shape, strict=True))
    if not fits or array.dtype.kind not in kinds or array.size == 0:
        wanted = (
            f"{'whole numbers' if kinds == 'iu' else 'floats'} of shape ({', '.join(str(w or 'n') for w in shape)})"
        )
        turned = array.ndim == len(shape) > 1 and array.shape[0] == shape[-1] != array.shape[-1]
        do = "turn its axes round: MATLAB and Julia write the last first" if turned else _AGAIN
        raise refusal(path, f"{name} is {array.dtype} of shape {array.shape}, wanted {wanted}", do)


def _corner_uv(path: Path, uv: np.ndarray | None, faces: np.ndarray, vertices: int) -> np.ndarray | None:
    if uv is None:
        return None
    if uv.dtype.kind != "f" or uv.shape not in ((vertices, 2), (*faces.shape, 2)):
        wanted = f"floats of shape ({vertices}, 2) or ({len(faces)}, 3, 2)"
        raise refusal(path, f"uv is {uv.dtype} of shape {uv.shape}, wanted {wanted}", _AGAIN)
    return (uv if uv.ndim == 3 else uv[faces]).astype(np.float32)


def _number(path: Path, arrays: dict[str, np.ndarray], name: str) -> float | None:
    if name not in arrays:
        return None
    value = arrays[name]
    try:
        number = float(_text(value) if value.dtype.kind in "SUO" else value.ravel()[0]) if value.size == 1 else -1.0
    except (TypeError, ValueError):
        number = -1.0
    if not 0 < number < 1e6 or value.dtype.kind not in "iufSUO":
        raise refusal(path, f"{name} is {_text(value)[:40]}, wanted one number above 0", _AGAIN)
    return number


def _text(value: np.ndarray) -> str:
    """The text of an array of one, whether bytes or not."""
    one = value.ravel()[0] if value.size == 1 else value
    return (one.decode(errors="replace") if isinstance(one, bytes) else str(one)).strip("\0 ")


def _unit(path: Path, arrays: dict[str, np.ndarray]) -> float | None:
    """Metres in a unit, by its number or its name."""
    number = _number(path, arrays, "metres_per_unit")
    if "units" not in arrays:
        return number
    said = _text(arrays["units"]).lower()
    name = next((name for pattern, name in _UNIT_NAMES.items() if re.fullmatch(pattern, said)), said)
    wanted = f"wanted {', '.join(UNITS)}"
    if name not in UNITS:
        raise refusal(path, f"units is '{said[:20]}', {wanted}", _AGAIN)
    if number is not None and abs(number / UNITS[name] - 1) > 1e-6:
        raise refusal(path, f"units is '{said}', metres_per_unit {number:g}", "write only the one that is right")
    return UNITS[name]


def _up(path: Path, arrays: dict[str, np.ndarray]) -> str | None:
    if "up" not in arrays:
        return None
    up = _text(arrays["up"])
    found = _UP.fullmatch(up)
    if found is None:
        raise refusal(path, f"up is '{up[:20]}', wanted x, y or z", _AGAIN)
    return found[1].lower()
