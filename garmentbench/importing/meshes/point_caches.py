"""Point caches, PC2 and MDD: positions over time; faces, UV and rest shape come from a template OBJ.

PC2 (PointCache2 by footools), little endian: char[12] "POINTCACHE2\0", int version = 1, int points, float start frame,
float sample rate, int samples; then samples x points x 3 floats. The sample rate is "every so many frames", so that the
format has no frames a second; some programs write these there all the same.

MDD (LightWave's Motion Designer), big endian: int frames, int points, float times [s] of the frames; then frames x
points x 3 floats."""

import io
import struct
from pathlib import Path

import numpy as np

from garmentbench.importing.meshes.even_times import evenly_timed
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal, size_of
from garmentbench.storage.atomic import written_whole


def with_template(
    path: Path,
    frames: np.ndarray,
    template: MeshSequence,
    times: np.ndarray | None,
    counted: bool,
    fps: float | None,
    notes: tuple[str, ...] = (),
) -> MeshSequence:
    """Cached positions, shape (T, V, 3), at some times, on a template's mesh. Raises `UserError` where the vertex
    counts differ."""
    if frames.shape[1] != len(template.still):
        found = f"has {frames.shape[1]} points, its template {template.files[0]} has {len(template.still)} vertices"
        raise refusal(path, found, "export both from the same mesh, with no modifier between")
    return MeshSequence(
        path.stem,
        frames,
        template.faces,
        template.corner_uv,
        template.still,
        fps,
        times=times,
        counted=counted,
        notes=(*template.notes, *notes),
        files=(path, *template.files),
    )


def point_count(path: Path) -> int | None:
    """Points of a cache, as its header says; None where it is too short to say."""
    with path.open("rb") if path.is_file() else io.BytesIO() as file:
        header = file.read(_PC2.size)
    if header.startswith(_SIGNATURE) and len(header) == _PC2.size:
        return _PC2.unpack(header)[2]
    return _MDD.unpack(header[: _MDD.size])[1] if len(header) >= _MDD.size else None


_SIGNATURE = b"POINTCACHE2\0"
_PC2 = struct.Struct("<12siiffi")
_AGAIN = "export the cache again"
_RATES = (23.976, 24, 25, 29.97, 30, 48, 50, 59.94, 60, 90, 120, 240)  # sampling rates meant as frames a second


def read_pc2(path: Path, template: MeshSequence) -> MeshSequence:
    """A PC2 file; the frames are mapped from it. Raises `UserError`, one line, for what is damaged or doesn't fit."""
    size = size_of(path, "a PC2 file")
    with path.open("rb") as file:
        header = file.read(_PC2.size)
    if not header.startswith(_SIGNATURE[: len(header)]):
        raise refusal(path, "no PC2 file, wanted it to begin with POINTCACHE2", _AGAIN)
    if len(header) < _PC2.size:
        raise refusal(path, f"cut off in its header: has {size} bytes, wanted more than {_PC2.size}", _AGAIN)
    _, version, points, start, sampling, samples = _PC2.unpack(header)
    if version != 1:
        order = ": its bytes are in big-endian order" if version == 1 << 24 else ""
        raise refusal(path, f"version {version}, wanted 1{order}", "export it little-endian, as PC2 is defined")
    if points <= 0 or samples <= 0:
        raise refusal(path, f"its header says {points} points and {samples} frames, wanted at least 1 of each", _AGAIN)
    wanted = _PC2.size + 12 * points * samples
    if size != wanted and size != wanted + 12 * points:
        claim = f"its header ({samples} frames of {points} points) wants {wanted}"
        raise refusal(path, f"has {size} bytes, {claim}: it is damaged or cut off", _AGAIN)
    frames = np.memmap(path, "<f4", "r", _PC2.size, (samples, points, 3))
    notes = _surplus(size - wanted)
    rate = next((float(r) for r in _RATES if abs(sampling - r) < 0.01), None)
    step = sampling if rate is None and 0 < sampling < 1e6 else 1.0
    if rate is not None:
        notes = (*notes, f"its sampling of {sampling:g} is taken as frames a second")
    elif step != 1:
        notes = (
            *notes,
            f"its sampling of {sampling:g} is taken as one sample every {sampling:g} frames",
        )
    if not np.isfinite(start):
        notes = (*notes, f"its start of {start:g} means nothing: taken as 0")
    if rate is None and step != sampling:
        notes = (*notes, f"its sampling of {sampling:g} means nothing: taken as 1")
    times = (start if np.isfinite(start) else 0.0) + step * np.arange(samples)
    return with_template(path, frames, template, times, True, rate, notes)


def _surplus(size: int) -> tuple[str, ...]:
    """A note on bytes beyond what a header asks for: one frame, which older exporters write."""
    return ("one frame more than its header says: left out",) if size else ()


def write_pc2(path: Path, mesh: MeshSequence) -> None:
    """Positions as they are. Raises `UserError` when it can't be written."""
    header = _PC2.pack(_SIGNATURE, 1, mesh.frames.shape[1], 0.0, 1.0, len(mesh.frames))
    with written_whole(path) as partial, partial.open("wb") as file:
        file.write(header)
        file.write(np.ascontiguousarray(mesh.frames, "<f4").data)


_MDD = struct.Struct(">ii")
_AGAIN = "export the cache again"


def read_mdd(path: Path, template: MeshSequence) -> MeshSequence:
    """An MDD file; the frames are mapped from it. Raises `UserError`, one line, for what is damaged or doesn't fit."""
    size = size_of(path, "an MDD file")
    with path.open("rb") as file:
        header = file.read(_MDD.size)
    if len(header) < _MDD.size:
        raise refusal(path, f"cut off in its header: has {size} bytes, wanted more than {_MDD.size}", _AGAIN)
    count, points = _MDD.unpack(header)
    surplus = size - _bytes(count, points)
    if size == _bytes(*struct.unpack("<ii", header)):
        raise refusal(path, "its bytes are in little-endian order, MDD is big-endian", "export it big-endian")
    if count <= 0 or points <= 0:
        raise refusal(path, f"its header says {count} frames and {points} points, wanted at least 1 of each", _AGAIN)
    if surplus not in (0, 12 * points):
        wanted = f"its header ({count} frames of {points} points) wants {_bytes(count, points)}"
        raise refusal(path, f"has {size} bytes, {wanted}: it is damaged, cut off, or no MDD file", _AGAIN)
    times = np.fromfile(path, ">f4", count, offset=_MDD.size).astype(np.float64)
    frames = np.memmap(path, ">f4", "r", _MDD.size + 4 * count, (count, points, 3))
    moving, even, rate, uneven = evenly_timed(path, frames, times)
    return with_template(path, moving, template, even, False, rate, (*_surplus(surplus), *uneven))


def write_mdd(path: Path, mesh: MeshSequence) -> None:
    """Positions as they are, times from `mesh.fps`. Raises `UserError` when it can't be written."""
    assert mesh.fps is not None, "what is exported has a rate"
    count = len(mesh.frames)
    with written_whole(path) as partial, partial.open("wb") as file:
        file.write(_MDD.pack(count, mesh.frames.shape[1]))
        file.write((np.arange(count) / mesh.fps).astype(">f4").data)
        file.write(np.ascontiguousarray(mesh.frames, ">f4").data)


def _bytes(frames: int, points: int) -> int:
    return _MDD.size + 4 * frames + 12 * frames * points
