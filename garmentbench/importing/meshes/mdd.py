"""MDD point caches (LightWave's Motion Designer): positions and times; faces, UV and rest shape come from a template OBJ.

Format, big endian: int frames, int points, float times [s] of the frames; then frames x points x 3 floats.
"""

import struct
from pathlib import Path

import numpy as np

from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal, size_of
from garmentbench.importing.meshes.point_cache import rate_of, with_template
from garmentbench.storage.atomic import written_whole

_HEADER = struct.Struct(">ii")
_AGAIN = "export the cache again"


def read_mdd(path: Path, template: MeshSequence) -> MeshSequence:
    """An MDD file; the frames are mapped from it. Raises `UserError`, one line, for what is damaged or doesn't fit."""
    size = size_of(path, "an MDD file")
    with path.open("rb") as file:
        header = file.read(_HEADER.size)
    if len(header) < _HEADER.size:
        raise refusal(path, f"cut off in its header: has {size} bytes, wanted more than {_HEADER.size}", _AGAIN)
    count, points = _HEADER.unpack(header)
    if size == _bytes(*struct.unpack("<ii", header)):
        raise refusal(path, "its bytes are in little-endian order, MDD is big-endian", "export it big-endian")
    if count <= 0 or points <= 0:
        raise refusal(path, f"its header says {count} frames and {points} points, wanted at least 1 of each", _AGAIN)
    if size != _bytes(count, points):
        wanted = f"its header ({count} frames of {points} points) wants {_bytes(count, points)}"
        raise refusal(path, f"has {size} bytes, {wanted}: it is damaged, cut off, or no MDD file", _AGAIN)
    times = np.fromfile(path, ">f4", count, offset=_HEADER.size).astype(np.float64)
    frames = np.memmap(path, ">f4", "r", _HEADER.size + 4 * count, (count, points, 3))
    return with_template(path, frames, template, rate_of(path, times))


def write_mdd(path: Path, mesh: MeshSequence) -> None:
    """Positions as they are, times from `mesh.fps`. Raises `UserError` when it can't be written."""
    count = len(mesh.frames)
    with written_whole(path) as partial, partial.open("wb") as file:
        file.write(_HEADER.pack(count, mesh.frames.shape[1]))
        file.write((np.arange(count) / mesh.fps).astype(">f4"))
        file.write(np.ascontiguousarray(mesh.frames, ">f4"))


def _bytes(frames: int, points: int) -> int:
    return _HEADER.size + 4 * frames + 12 * frames * points
