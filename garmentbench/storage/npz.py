"""Reading .npz files that somebody else may have written, or that were cut off."""

import tokenize
import zipfile
import zlib
from collections.abc import Collection
from pathlib import Path

import numpy as np

from garmentbench.errors import UserError
from garmentbench.storage.hdf5 import reason

DAMAGED = (  # what zipfile and NumPy raise over damaged archives and headers, which are Python literals
    zipfile.BadZipFile,
    zlib.error,
    ValueError,
    TypeError,
    KeyError,
    EOFError,
    OSError,
    RuntimeError,
    NotImplementedError,
    SyntaxError,
    tokenize.TokenError,
    MemoryError,
)
_MOST_COMPRESSED, _SMALL = 200, 64 << 20  # what claims to be larger than both [times, bytes] is not believed


def read_arrays(path: Path, wanted: str, again: str, names: Collection[str] | None = None) -> dict[str, np.ndarray]:
    """Arrays of an .npz file, by name.

    Args:
        path: The file.
        wanted: What should be there, for messages, e.g. "a garment".
        again: How to come by a good file, for messages.
        names: The arrays to read; all others are left alone, whatever they hold. None: all.

    Raises `UserError`, one line, for a file that is missing, damaged, or claims more than it holds.
    """
    if not path.is_file():
        raise UserError(f"{path}: {'a folder' if path.is_dir() else 'no such file'}, wanted {wanted}; check the path")
    try:
        with zipfile.ZipFile(path) as archive:
            size = path.stat().st_size
            members = {m.filename.removesuffix(".npy"): m for m in archive.infolist()}
            return {k: read_array(archive, m, size) for k, m in members.items() if names is None or k in names}
    except DAMAGED as e:
        raise UserError(f"{path}: damaged, or no .npz file ({reason(e)[:100]}), wanted {wanted}; {again}") from e


def read_array(archive: zipfile.ZipFile, member: zipfile.ZipInfo, size: int) -> np.ndarray:
    """One array of an archive of `size` bytes, read only where its header claims no more than is there.

    Raises one of `DAMAGED`.
    """
    with archive.open(member) as file:
        version = np.lib.format.read_magic(file)
        header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, dtype = header(file)
    if dtype.hasobject:
        raise ValueError(f"{member.filename} holds Python objects, wanted numbers")
    claimed = int(np.prod(shape, dtype=object)) * dtype.itemsize
    if not 0 <= claimed <= min(member.file_size, max(_SMALL, _MOST_COMPRESSED * size)):
        raise ValueError(f"{member.filename} claims {claimed} bytes in a file of {size}")
    with archive.open(member) as file:
        return np.lib.format.read_array(file, allow_pickle=False)
