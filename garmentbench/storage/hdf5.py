"""HDF5 files of this project: written whole or not at all, and read without trusting them."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

import h5py
import numpy as np

from garmentbench.errors import Problem, ProblemError
from garmentbench.storage.atomic import written_whole

T = TypeVar("T")
DAMAGED = (OSError, RuntimeError, KeyError, ValueError)  # what h5py raises over a damaged file
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_FRAMES_A_CHUNK = 16
_MOST_COMPRESSED = 200  # a file that claims to hold more than this times its size is not believed,
_SMALL_BYTES = 64 << 20  # unless what it claims is small anyway


@contextmanager
def create(path: Path, kind: str, schema: int) -> Iterator[h5py.File]:
    """A new file of a kind ("sequence", "roll-out") to be filled; it is at `path` when the block ends without an error.

    It is made in memory first, since the HDF5 library may crash the process when a disk fills under it.
    Raises `UserError` when it can't be written.
    """
    image = io.BytesIO()
    with h5py.File(image, "w", libver="v110") as file:  # from 1.10 on the structure carries checksums
        put_attributes(file, format=f"garmentbench {kind}", schema=schema)
        yield file
    with written_whole(path) as partial:
        partial.write_bytes(image.getbuffer())


def put(file: h5py.File, name: str, array: np.ndarray) -> None:
    """Write an array: per-frame arrays (three axes, or four with one for runs before them) chunked by frames and
    compressed without loss, others plain."""
    if array.ndim < 3 or array.size == 0:
        file.create_dataset(name, data=array)
        return
    *before, frames, points, axes = array.shape
    chunks = (*(1 for _ in before), min(_FRAMES_A_CHUNK, frames), points, axes)
    file.create_dataset(name, data=array, chunks=chunks, compression="gzip", compression_opts=1, shuffle=True)


@contextmanager
def opened(path: Path, kind: str, schema: int, remake: str) -> Iterator[h5py.File]:
    """An existing file of a kind, to be read with `attribute` and `dataset`.

    `remake` says how the user gets a good one. Raises `ProblemError` for a missing, foreign, damaged, older or
    newer file.
    """

    def refuse(what: str, do: str = remake) -> ProblemError:
        return ProblemError(Problem(str(path), what, do))

    if not path.is_file():
        raise refuse(f"{'a folder' if path.is_dir() else 'no such file'}, wanted a garmentbench {kind}")
    try:
        with path.open("rb") as f:
            start = f.read(len(_SIGNATURE))
        if start != _SIGNATURE:
            raise refuse(f"{'not an HDF5' if start else 'an empty'} file, wanted a garmentbench {kind}")
        with h5py.File(path, "r", locking=False) as file:
            if attribute(file, "format", str) != f"garmentbench {kind}":
                raise refuse(f"an HDF5 file, but not a garmentbench {kind}")
            found = attribute(file, "schema", int)
            if found is not None and found > schema:
                raise refuse(f"schema {found} is newer than schema {schema}, which is read here", "update garmentbench")
            if found != schema:
                raise refuse(f"schema {found} is older than schema {schema}, which is read here")
            yield file
    except DAMAGED as e:
        raise refuse(f"truncated or damaged ({reason(e)})") from e


def put_attributes(holder: h5py.Group, **values: str | int | float) -> None:
    """Write attributes. Texts have fixed length.

    HDF5 keeps others where no checksum guards them, and may hang there.
    """
    for name, value in values.items():
        holder.attrs[name] = np.bytes_(value.encode()) if isinstance(value, str) else value


def attribute(holder: h5py.Group, name: str, kind: type[T]) -> T | None:
    """An attribute; None where it is missing or not one value of that kind, as `put_attributes` writes it."""
    if name not in holder.attrs or holder.attrs.get_id(name).dtype.hasobject:
        return None
    value: Any = holder.attrs[name]
    value = value.item() if isinstance(value, np.generic) else value
    if kind is str and isinstance(value, bytes):
        value = value.decode(errors="replace")
    if kind is float and isinstance(value, int):
        value = float(value)
    return value if isinstance(value, kind) else None


def dataset(file: h5py.File, name: str) -> h5py.Dataset | None:
    """A dataset of this very file, not yet read; None where there is none.

    Raises ValueError for one that claims to be larger than the file could hold, or that lies elsewhere.
    """
    link = file.get(name, getlink=True)
    if link is None:
        return None
    found = file[name] if isinstance(link, h5py.HardLink) else None
    if not isinstance(found, h5py.Dataset) or found.external or found.is_virtual or found.dtype.hasobject:
        raise ValueError(f"{name} is not an array of numbers in this file")
    size = Path(file.filename).stat().st_size
    bytes_claimed = found.size * found.dtype.itemsize if found.size is not None else 0
    chunk_claimed = int(np.prod(found.chunks)) * found.dtype.itemsize if found.chunks else 0
    if max(bytes_claimed, chunk_claimed) > max(_SMALL_BYTES, _MOST_COMPRESSED * size):
        raise ValueError(f"{name} claims {max(bytes_claimed, chunk_claimed)} bytes in a file of {size}")
    return found


def reason(error: Exception) -> str:
    """What h5py says, in one line."""
    return str(error).strip("'\"").splitlines()[0] if str(error) else type(error).__name__
