"""Reading .npz files that somebody else may have written, or that were cut off."""

import zipfile
import zlib
from pathlib import Path

import numpy as np

from garmentbench.errors import UserError
from garmentbench.hdf5 import reason

DAMAGED = (
    zipfile.BadZipFile, zlib.error, ValueError, KeyError, EOFError, OSError, RuntimeError, NotImplementedError, SyntaxError,
)
_LARGEST = 1 << 32  # [bytes] of one array


def read_arrays(path: Path, wanted: str, again: str) -> dict[str, np.ndarray]:
    """All arrays of an .npz file, by name.

    Args:
        path: The file.
        wanted: What should be there, for messages, e.g. "a garment".
        again: How to come by a good file, for messages.

    Raises `UserError`, one line, for a file that is missing, damaged, or claims more than it holds.
    """
    if not path.is_file():
        raise UserError(f"{path}: {'a folder' if path.is_dir() else 'no such file'}, wanted {wanted}; check the path")
    try:
        with zipfile.ZipFile(path) as archive:
            return {m.filename.removesuffix(".npy"): _array(archive, m) for m in archive.infolist()}
    except DAMAGED as e:
        raise UserError(f"{path}: damaged, or no .npz file ({reason(e)[:100]}), wanted {wanted}; {again}") from e


def _array(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> np.ndarray:
    """One array, read only where its header claims no more than is there."""
    with archive.open(member) as file:
        version = np.lib.format.read_magic(file)
        header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, dtype = header(file)
    claimed = int(np.prod(shape, dtype=object)) * dtype.itemsize
    if dtype.hasobject or not 0 <= claimed <= min(member.file_size, _LARGEST):
        raise ValueError(f"{member.filename} claims {claimed} bytes, there are {member.file_size}")
    with archive.open(member) as file:
        return np.lib.format.read_array(file, allow_pickle=False)
