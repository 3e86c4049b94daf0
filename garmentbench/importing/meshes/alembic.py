"""Alembic: polygon meshes with their world transforms and UV. It says neither unit nor up axis.

Needs `alembic3d` (in the extra `alembic`), PyAlembic as a wheel. Damaged files may crash its library:
`subprocess_reader` calls `read_alembic` in a process of its own.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from garmentbench.errors import UserError
from garmentbench.importing.meshes.choosing import choose
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal
from garmentbench.importing.meshes.polygons import PolygonFrames, from_polygons

_OTHER_SHAPES = ("Curves", "NuPatch", "Points")
_AGAIN = "export it again, as Ogawa (not HDF5) Alembic"
_SAME_TIME = 1e-6  # [s]


def read_alembic(path: Path, prim: str, role: str) -> MeshSequence | None:
    """A mesh of an Alembic file, as `subprocess_reader.read_isolated`, which is the safe way to call it."""
    try:
        from alembic3d import Abc
    except ImportError as e:
        do = "pip install alembic3d, or export PC2, OBJ or USD instead"
        raise UserError(f"Alembic needs the package alembic3d; {do}") from e
    try:
        archive = Abc.IArchive(str(path))
        unread: list[str] = []
        meshes = dict(_meshes(archive.getTop(), (), unread))
        if not meshes and unread:
            found = f"has no polygon mesh, wanted one; what it has is not read: {', '.join(unread[:8])}"
            raise refusal(path, found, "export the meshes with their faces")
        name = choose(path, list(meshes), prim, role)
        if name is None:
            return None
        return replace(_mesh(path, name, meshes[name], unread), beside=tuple(n for n in meshes if n != name))
    except (RuntimeError, ValueError, IndexError) as e:  # what Boost.Python makes of Alembic's exceptions
        reason = (str(e).strip() or type(e).__name__).splitlines()[-1]
        raise refusal(path, f"damaged, or no Alembic file ({reason[:120]})", _AGAIN) from e


def _meshes(holder: Any, above: tuple, unread: list[str]) -> Iterator[tuple[str, tuple]]:
    """Names of all polygon and subdivision meshes, each with its schema and the transforms above it, outermost first;
    shapes of other kinds are added to `unread`."""
    from alembic3d import Abc, AbcGeom

    for header in holder.children:
        name, kind = header.getName(), header.getMetaData()
        child, transforms = Abc.IObject(holder, name), above
        if AbcGeom.IPolyMesh.matches(kind):
            yield child.getFullName(), (AbcGeom.IPolyMesh(holder, name).getSchema(), above)
        if AbcGeom.ISubD.matches(kind):  # its cage, as other programs read it
            yield child.getFullName(), (AbcGeom.ISubD(holder, name).getSchema(), above)
        unread += [f"{name} ({k})" for k in _OTHER_SHAPES if getattr(AbcGeom, f"I{k}").matches(kind)]
        if AbcGeom.IXform.matches(kind):
            transforms = (*above, AbcGeom.IXform(holder, name).getSchema())
        yield from _meshes(child, transforms, unread)


def _mesh(path: Path, name: str, found: tuple, unread: list[str]) -> MeshSequence:
    schema, transforms = found
    counts = _constant(path, schema.getFaceCountsProperty())
    corners = _constant(path, schema.getFaceIndicesProperty())
    track, above = _Track.of(schema), tuple(_Track.of(transform) for transform in transforms)
    times = _sample_times(track, above)
    length = len(times)
    mirrored = bool(np.linalg.det(_matrix(above, float(times[0]))[:3, :3]) < 0)
    notes = ("its transform mirrors it: the faces are turned with it",) if mirrored else ()
    notes += (f"not read of this file: {', '.join(unread[:8])}",) if unread else ()
    polygons = PolygonFrames(
        path,
        name.rsplit("/", 1)[-1],
        counts,
        corners,
        length,
        lambda t: _points(track, above, float(times[t])),
        _corner_uv(schema, corners),
        clockwise=not mirrored,
        notes=notes,
    )
    return from_polygons(polygons, times if length > 1 else None, unit=None, up=None)


@dataclass(frozen=True)
class _Track:
    """A schema with samples over time, linear between them, as programs play Alembic.

    Attributes:
        schema: Of points, or of a transform.
        times: When its samples are [s]; none where it has one, which holds always.
    """

    schema: Any
    times: np.ndarray

    @classmethod
    def of(cls, schema: Any) -> "_Track":
        count, sampling = schema.getNumSamples(), schema.getTimeSampling()
        return cls(schema, np.array([sampling.getSampleTime(t) for t in range(count)] if count > 1 else [], np.float64))

    def at(self, time: float, read: Callable[[Any], np.ndarray]) -> np.ndarray:
        """What its value holds at a time [s]; `read` takes it from a sample."""
        from alembic3d import Abc

        def sample(when: float) -> np.ndarray:
            return read(self.schema.getValue(Abc.ISampleSelector(float(when))))  # the nearest one

        times = self.times
        after = int(np.searchsorted(times, time - _SAME_TIME))
        if after in (0, len(times)) or abs(times[after] - time) <= _SAME_TIME:
            return sample(time)
        share = (time - times[after - 1]) / (times[after] - times[after - 1])
        low, high = sample(times[after - 1]), sample(times[after])
        return low if low.shape != high.shape else ((1 - share) * low + share * high).astype(low.dtype)


def _sample_times(points: _Track, transforms: tuple[_Track, ...]) -> np.ndarray:
    """Times of the points' samples, or of the transforms above where these have more in the same span [s]."""
    own, above = points.times, np.concatenate([np.zeros(0), *(transform.times for transform in transforms)])
    if len(own):
        above = above[(above >= own[0] - _SAME_TIME) & (above <= own[-1] + _SAME_TIME)]
    above = _distinct(above)
    if len(own) and len(above) <= len(own):
        return own
    both = _distinct(np.concatenate([own, above]))
    return both if len(both) else np.array([points.schema.getTimeSampling().getSampleTime(0)])


def _distinct(times: np.ndarray) -> np.ndarray:
    times = np.sort(times)
    return times[np.diff(times, prepend=-np.inf) > _SAME_TIME]


def _points(track: _Track, transforms: tuple[_Track, ...], time: float) -> np.ndarray:
    """World positions at a time [s], shape (V, 3)."""
    points = track.at(time, lambda value: np.array(value.getPositions(), np.float32).reshape(-1, 3))
    matrix = _matrix(transforms, time)
    if np.array_equal(matrix, np.eye(4)):
        return points
    return (points.astype(np.float64) @ matrix[:3, :3] + matrix[3, :3]).astype(np.float32)


def _matrix(transforms: tuple[_Track, ...], time: float) -> np.ndarray:
    """All transforms together at a time [s], shape (4, 4); rows are images: x M."""
    matrix = np.eye(4)
    for transform in transforms:  # outermost first
        own = transform.at(time, lambda value: np.array(value.getMatrix(), np.float64).reshape(4, 4))
        matrix = own @ matrix if transform.schema.getInheritsXforms() else own
    return matrix


def _constant(path: Path, attribute: Any) -> np.ndarray:
    first = np.array(attribute.samples[0], np.int64)
    if not attribute.isConstant():
        for k, value in enumerate(attribute.samples):
            if not np.array_equal(np.array(value, np.int64), first):
                found = f"{attribute.getName()} changes at its sample {k}, wanted one mesh in all frames"
                raise refusal(path, found, "export the mesh without remeshing")
    return first


def _corner_uv(schema: Any, corners: np.ndarray) -> np.ndarray | None:
    parameter = schema.getUVsParam()
    if not parameter.valid():
        return None
    values = np.array(parameter.getExpandedValue().getVals(), np.float32).reshape(-1, 2)
    if len(values) == len(corners):
        return values
    return values[corners] if len(corners) and corners.max() < len(values) else None
