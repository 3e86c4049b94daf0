"""PC2 point caches: positions only; faces, UV and rest shape come from a template OBJ.

Format (PointCache2 by footools, little endian): char[12] "POINTCACHE2\\0", int version = 1, int points, float start frame,
float sample rate, int samples; then samples x points x 3 floats. The sample rate is "every so many frames", so that the
format has no frames a second; some programs write these there all the same.
"""

import struct
from pathlib import Path

import numpy as np

from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal, size_of
from garmentbench.importing.meshes.point_cache import with_template
from garmentbench.storage.atomic import written_whole

_SIGNATURE = b"POINTCACHE2\0"
_HEADER = struct.Struct("<12siiffi")
_AGAIN = "export the cache again"
_SLOWEST, _FASTEST = 10, 240  # a sample rate in between must be meant as frames a second


def read_pc2(path: Path, template: MeshSequence) -> MeshSequence:
    """A PC2 file; the frames are mapped from it. Raises `UserError`, one line, for what is damaged or doesn't fit."""
    size = size_of(path, "a PC2 file")
    with path.open("rb") as file:
        header = file.read(_HEADER.size)
    if not header.startswith(_SIGNATURE[: len(header)]):
        raise refusal(path, "no PC2 file, wanted it to begin with POINTCACHE2", _AGAIN)
    if len(header) < _HEADER.size:
        raise refusal(path, f"cut off in its header: has {size} bytes, wanted more than {_HEADER.size}", _AGAIN)
    _, version, points, _, rate, samples = _HEADER.unpack(header)
    if version != 1:
        order = ": its bytes are in big-endian order" if version == 1 << 24 else ""
        raise refusal(path, f"version {version}, wanted 1{order}", "export it little-endian, as PC2 is defined")
    if points <= 0 or samples <= 0:
        raise refusal(path, f"its header says {points} points and {samples} frames, wanted at least 1 of each", _AGAIN)
    wanted = _HEADER.size + 12 * points * samples
    if size != wanted:
        claim = f"its header ({samples} frames of {points} points) wants {wanted}"
        raise refusal(path, f"has {size} bytes, {claim}: it is damaged or cut off", _AGAIN)
    frames = np.memmap(path, "<f4", "r", _HEADER.size, (samples, points, 3))
    fps = float(rate) if _SLOWEST <= rate <= _FASTEST else None
    thinned = (f"sampled every {rate:g} frames: --fps is the rate of the samples",) if 1 < rate < _SLOWEST else ()
    return with_template(path, frames, template, fps, thinned)


def write_pc2(path: Path, mesh: MeshSequence) -> None:
    """Positions as they are. Raises `UserError` when it can't be written."""
    header = _HEADER.pack(_SIGNATURE, 1, mesh.frames.shape[1], 0.0, 1.0, len(mesh.frames))
    with written_whole(path) as partial, partial.open("wb") as file:
        file.write(header)
        file.write(np.ascontiguousarray(mesh.frames, "<f4"))
