"""Writing and reading sequences. `sequence_layout` says what lies where, `sequence_checks` what must hold."""

import json
import warnings
from pathlib import Path
from typing import TypeVar

import h5py
import numpy as np

from garmentbench.errors import Problem, UserError, errors
from garmentbench.sequence import Sequence
from garmentbench.sequence_file.array_checks import FIRST_FRAME
from garmentbench.sequence_file.checks import hash_problems, shape_problems, value_problems
from garmentbench.sequence_file.layout import (
    ARRAYS,
    KIND,
    REMAKE,
    SCHEMA,
    UNITS,
    Contents,
    Names,
    contents_of,
    sequence_of,
)
from garmentbench.storage import hdf5

T = TypeVar("T")


def save(sequence: Sequence, path: Path) -> None:
    """Write a sequence, whole or not at all.

    Raises `UserError` when it can't be written, or when it is such that `load` would refuse it.
    """
    contents = contents_of(sequence)
    problems = shape_problems(contents)
    _refuse(path, problems or value_problems(contents))
    with hdf5.create(path, KIND, SCHEMA) as file:
        for name, array in contents.arrays.items():
            hdf5.put(file, name, array)
        info = json.dumps(contents.info)
        hdf5.put_attributes(file, units=UNITS, content_hash=contents.hash(), fps=contents.fps, info=info)
        names = contents.names
        hdf5.put_attributes(file.require_group("garment"), name=names.garment)
        if names.body is not None and names.kind is not None:
            parts = json.dumps(names.part_names)
            hdf5.put_attributes(file.require_group("body"), name=names.body, kind=names.kind, part_names=parts)


def load(path: Path, frames: int | None = None) -> Sequence:
    """Read a sequence, or only the first `frames` of it (the content hash is compared only when all is read).

    Raises `UserError`, one line, for a file that is missing, foreign, damaged, of another schema, or that holds what
    can't be used. Warns of an imported garment that begins inside the body. `garmentbench.sequence_file.examine` tells
    all that is wrong.
    """
    contents, problems = read(path, frames)
    if not problems:
        problems = value_problems(contents) + (hash_problems(contents) if frames is None else [])
    _refuse(path, problems)
    for problem in problems:
        if problem.where == FIRST_FRAME and "simulation" not in contents.info:  # the card of a simulated one says it
            warnings.warn(f"{path}: {problem}", stacklevel=2)
    return sequence_of(contents)


def content_hash(path: Path) -> str:
    """SHA-256 of a file's arrays, template and schema, as noted when it was written; cheap.

    Raises `UserError` as `load`, as far as that shows without reading the arrays.
    """
    with hdf5.opened(path, KIND, SCHEMA, REMAKE) as file:
        noted = hdf5.attribute(file, "content_hash", str)
    if noted is None:
        raise UserError(f"{path}: has no content hash; {REMAKE}")
    return noted


def read(path: Path, frames: int | None = None) -> tuple[Contents, list[Problem]]:
    """What a file holds, and what is wrong with its attributes and with its arrays' presence, types and shapes.

    Raises `UserError` where it is no sequence file at all.
    """
    arrays: dict[str, np.ndarray] = {}
    problems: list[Problem] = []
    with hdf5.opened(path, KIND, SCHEMA, REMAKE) as file:
        for name in ARRAYS:
            try:
                stored = hdf5.dataset(file, name)
                if stored is not None:
                    arrays[name] = np.asarray(stored[_first(name, stored.ndim, frames)])
            except hdf5.DAMAGED as e:
                problems.append(Problem(name, f"can't be read ({hdf5.reason(e)})", REMAKE))
        attributes = _Attributes(file)
        contents = attributes.contents(arrays)
    unreadable = {p.where for p in problems}
    missing_or_odd = [p for p in shape_problems(contents) if p.where not in unreadable]
    return contents, problems + attributes.problems + missing_or_odd


def _first(name: str, axes: int, frames: int | None) -> tuple[slice, ...]:
    """Which part of an array has the first `frames` (None: all), where it has frames and as many axes as it must."""
    _, shape = ARRAYS[name]
    return (slice(None),) * shape.index("T") + (slice(frames),) if "T" in shape and axes == len(shape) else ()


class _Attributes:
    """Reads attributes, and notes what is wrong with them in `problems`."""

    def __init__(self, file: h5py.File) -> None:
        self.file = file
        self.problems: list[Problem] = []

    def contents(self, arrays: dict[str, np.ndarray]) -> Contents:
        names = Names(self._value("garment", "name", str) or "")
        if "body" in self.file:
            body, kind = self._value("body", "name", str) or "", self._value("body", "kind", str)
            names = Names(names.garment, body, kind, tuple(map(str, self._json("body", "part_names", list))))
        if self._value("/", "units", str) not in (UNITS, None):
            self._complain("/", "units", f"not '{UNITS}'", "convert the positions and write the file again")
        fps = self._value("/", "fps", float)
        info, noted = self._json("/", "info", dict), self._value("/", "content_hash", str)
        return Contents(arrays, names, 0.0 if fps is None else fps, info, noted)

    def _value(self, place: str, name: str, kind: type[T]) -> T | None:
        holder = self.file.get(place)
        value = hdf5.attribute(holder, name, kind) if isinstance(holder, h5py.Group) else None
        if value is None:
            self._complain(place, name, f"missing, or no {kind.__name__}")
        return value

    def _json(self, place: str, name: str, kind: type[T]) -> T:
        text = self._value(place, name, str)
        try:
            value = kind() if text is None else json.loads(text)
        except json.JSONDecodeError:
            value = None
        if not isinstance(value, kind):
            self._complain(place, name, f"no JSON {kind.__name__}")
            return kind()
        return value

    def _complain(self, place: str, name: str, what: str, do: str = REMAKE) -> None:
        self.problems.append(Problem(f"{place} attribute {name}".removeprefix("/ "), what, do))


def _refuse(path: Path, problems: list[Problem]) -> None:
    bad = errors(problems)
    if bad:
        more = f" (and {len(bad) - 1} more, see garmentbench check {path})" if len(bad) > 1 else ""
        raise UserError(f"{path}: {bad[0]}{more}")
