"""Reading a garment, or a body to check it against, from an OBJ, PLY, .npz or sequence file.

Writing a mended garment.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from garmentbench import sequence_file
from garmentbench.errors import UsageError, UserError
from garmentbench.geometry.unwrap import in_order, split_corners
from garmentbench.importing.mesh_doctor.body import Wearer, baked, is_baked, of_body
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.shape import unit
from garmentbench.importing.meshes import obj
from garmentbench.importing.meshes.conventions import UNITS, converter, guess_unit, guess_up, unit_name
from garmentbench.importing.meshes.mesh_sequence import MeshSequence
from garmentbench.importing.meshes.ply import read_ply
from garmentbench.importing.text import counted
from garmentbench.scenes.garment_file import garment_name
from garmentbench.sequence import Body, Garment
from garmentbench.storage.atomic import written_whole
from garmentbench.storage.npz import read_arrays

MESH_FILES = (".obj", ".ply", ".npz")
_WANTED = (
    "a garment: rest (V, 3), faces (F, 3), and as far as there are any uv (V, 2), seams (S, 2), pins (P,), cut (V, 2)"
)
_AGAIN = "write it again with numpy.savez_compressed, or export OBJ"
_SHAPES = {
    "rest": ("f", (3,)),
    "faces": ("iu", (3,)),
    "uv": ("f", (2,)),
    "seams": ("iu", (2,)),
    "pins": ("iu", ()),
    "cut": ("f", (2,)),
}


def is_mesh_file(path: Path) -> bool:
    """Is that a mesh by its name? Anything else is taken for a sequence."""
    return path.suffix.lower() in MESH_FILES


def read_mesh(path: Path, prim: str = "") -> Mesh:
    """The garment of a mesh or sequence file; `prim` says which object of an OBJ file that has several.

    Raises `UserError`, one line, for what can't be read at all.
    """
    kind = path.suffix.lower()
    if not is_mesh_file(path):
        return mesh_of(sequence_file.load(path, frames=1).template.garment)
    if kind == ".npz":
        return _garment_file(path)
    return _of_corners(obj.read_template(path, prim) if kind == ".obj" else read_ply(path))


def mesh_of(garment: Garment) -> Mesh:
    """The garment of a sequence."""
    return Mesh(
        garment.name,
        garment.rest.astype(np.float64),
        garment.faces.astype(np.int64),
        garment.uv.astype(np.float64),
        np.arange(len(garment.rest)),
        garment.seams.astype(np.int64),
        garment.pins.astype(np.int64),
        says_seams=True,
        cut=None if garment.cut is None else garment.cut.astype(np.float64),
    )


def read_wearer(which: str, units: str = "", up: str = "") -> Wearer:
    """A baked body by its name, or the body of a mesh or sequence file, brought to metres, z up.

    Args:
        which: The name, or the file.
        units, up: A mesh's unit and axis that points up, keys of `UNITS` and `AXES`; "" for as its size tells.

    Raises `UserError` where there is none, or its size is no body's in any unit; `UsageError` where units are given for
    what says its own.
    """
    path = Path(which)
    named = is_baked(which) or not (path.suffix or path.exists())
    if (units or up) and (named or not is_mesh_file(path)):
        raise UsageError(f"{which} is in metres, z up; --body-units and --body-up go with a mesh (.obj, .ply, .npz)")
    if named:
        return baked(which)
    if not is_mesh_file(path):
        template = sequence_file.load(path, frames=1).template
        if template.body is None:
            raise UserError(f"{path}: has no body; name another file, or a baked body such as base")
        return of_body(template.body)
    return _of_mesh(path, units, up)


def _of_mesh(path: Path, units: str, up: str) -> Wearer:
    """The body of a mesh file. What is no standing person is taken for z up, and for a garment's sizes."""
    mesh = read_mesh(path, "all").compact()
    if not np.isfinite(mesh.vertices).all():
        raise UserError(f"{path}: the body has NaN or infinite positions; export it again")
    person = MeshSequence(path.stem, mesh.vertices[None].astype(np.float32), mesh.faces.astype(np.int32))
    if up:
        axis, lines = up, [f"up: {up} (given)"]
    else:
        axis, why = _or_else(lambda: guess_up(person), ("z", ""))
        lines = [
            f"up: {axis} (inferred: {why})" if why else "up: z (assumed: its size doesn't tell; --body-up says it)"
        ]
    height, told = _or_else(lambda: guess_unit(person, person, axis), (None, ""))
    if units:
        metres, told = UNITS[units], "given"
    elif height is not None:
        metres, told = height, f"inferred: {told}"
    elif (known := unit(mesh.size)) is not None:
        metres, told = known[1], "" if known[1] == 1 else f"inferred: it measures {mesh.size:.3g} across"
    else:
        found = f"the body measures {mesh.size:.3g} across, wanted a person of 1 to 2.4 m"
        raise UserError(f"{path}: {found}; give --body-units ({', '.join(UNITS)})")
    if told:
        lines = [f"units: {unit_name(metres)} ({told})", *lines]
    rest = (mesh.vertices @ converter(metres, axis).T).astype(np.float32)
    return replace(of_body(Body(path.stem, rest, mesh.faces.astype(np.int32))), assumed=tuple(lines))


def _or_else(guess: Callable[[], tuple[Any, str]], otherwise: tuple[Any, str]) -> tuple[Any, str]:
    """What is guessed, or where nothing tells something else."""
    try:
        return guess()
    except UserError:
        return otherwise


def _of_corners(read: MeshSequence) -> Mesh:
    """Vertices keep the file's numbers; copies at UV seams come after them."""
    count, uv = len(read.still), read.corner_uv
    vertices, faces = read.still.astype(np.float64), read.faces.astype(np.int64)
    if uv is None or not np.isfinite(uv).all():
        return Mesh(read.name, vertices, faces, None if uv is None else np.full((count, 2), np.nan), np.arange(count))
    cut = in_order(count, *split_corners(read.faces, uv))
    at = cut.source
    return Mesh(
        read.name, vertices[at], cut.faces.astype(np.int64), cut.uv.astype(np.float64), at, cut.seams.astype(np.int64)
    )


def _garment_file(path: Path) -> Mesh:
    arrays = read_arrays(path, _WANTED, _AGAIN)
    for name, (kinds, width) in _SHAPES.items():
        array = arrays.get(name)
        if array is None and name in ("rest", "faces"):
            found = ", ".join(sorted(arrays)) or "none"
            raise UserError(f"{path}: has no array '{name}' (found: {found}), wanted {_WANTED}; {_AGAIN}")
        if array is not None and (array.dtype.kind not in kinds or array.shape[1:] != width or array.ndim < 1):
            raise UserError(f"{path}: {name} is {array.dtype} of shape {array.shape}, wanted {_WANTED}; {_AGAIN}")
    rest = arrays["rest"].astype(np.float64)
    uv, cut = (arrays[name].astype(np.float64) if name in arrays else None for name in ("uv", "cut"))
    indices = {n: arrays.get(n, np.zeros((0, *_SHAPES[n][1]))).astype(np.int64) for n in ("faces", "seams", "pins")}
    for name, array in indices.items():
        if array.size and not 0 <= array.min() <= array.max() < len(rest):
            found = f"{name} name vertices from {array.min()} to {array.max()}, there are {len(rest)}"
            raise UserError(f"{path}: {found}; {_AGAIN}")
    if not len(indices["faces"]):
        raise UserError(f"{path}: has no faces, wanted {_WANTED}; {_AGAIN}")
    for name, array in (("uv", uv), ("cut", cut)):
        if array is not None and len(array) != len(rest):
            raise UserError(f"{path}: {name} has {len(array)} rows, rest has {len(rest)}, wanted {_WANTED}; {_AGAIN}")
    notes = {k: str(a) for k, a in arrays.items() if k not in _SHAPES and a.ndim == 0 and a.dtype.kind == "U"}
    return Mesh(
        path.stem, rest, indices["faces"], uv, np.arange(len(rest)), indices["seams"], indices["pins"], True, notes, cut
    )


def writable(path: Path) -> None:
    """Raises `UsageError` for a name that is neither OBJ nor .npz."""
    if path.suffix.lower() not in (".obj", ".npz"):
        raise UsageError(f"--fix {path}: wanted a name that ends in .obj or .npz")


def wardrobe_lines(path: Path) -> str:
    """The lines that enter a garment's .npz file into a wardrobe."""
    lines = f'[garments.{garment_name(str(path))}]\nmesh = "{path.resolve().as_posix()}"'
    return f"to wear it in scenes, put into your wardrobe.toml:\n{lines}"


def write_mesh(path: Path, mesh: Mesh) -> list[str]:
    """Write a garment whole; gives a line on what the format can't hold.

    Raises `UserError` where it can't be written.
    """
    writable(path)
    if path.suffix.lower() == ".npz":
        _write_npz(path, mesh)
        return []
    uv = None if mesh.uv is None else mesh.uv[mesh.faces].astype(np.float32)
    has_uv = uv is not None and np.isfinite(uv).all()
    uv = uv if has_uv else None
    points = mesh.points.astype(np.float32)
    obj.write_template(path, MeshSequence(mesh.name, points[None], mesh.corners.astype(np.int32), uv))
    left_out = [counted(len(mesh.pins), "pin")] if len(mesh.pins) else []
    left_out += [] if mesh.cut is None else ["the flat pattern (cut)"]
    return [f"left out {' and '.join(left_out)}: OBJ has no place for them, .npz has"] if left_out else []


def _write_npz(path: Path, mesh: Mesh) -> None:
    if mesh.uv is None or not np.isfinite(mesh.uv).all():
        found = "a garment's .npz needs UV, and this mesh has none for all of it"
        raise UserError(f"{path}: {found}; give --make-uv, or write .obj")
    arrays = {
        "rest": mesh.vertices.astype(np.float32),
        "faces": mesh.faces.astype(np.int32),
        "uv": mesh.uv.astype(np.float32),
        "seams": mesh.seams.astype(np.int32),
        "pins": mesh.pins.astype(np.int32),
        **({} if mesh.cut is None else {"cut": mesh.cut.astype(np.float32)}),
        **mesh.notes,
    }
    with written_whole(path) as partial, partial.open("wb") as file:
        np.savez_compressed(file, **arrays)
