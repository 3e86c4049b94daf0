"""The files of the authors' release, one by one, as numbers that are not trusted yet.

Source: what Zhang, Ceylan and Mitra 2022 released with their paper. Whatever is wrong with a file is a `UserError`.
"""

import math
import tokenize
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np

from garmentbench.errors import UserError
from garmentbench.geometry.uvmap import Chart
from garmentbench.importing.meshes.obj_text import ObjText

AGAIN = "copy it from the authors' release again"
_DAMAGED = (
    ValueError,
    EOFError,
    TypeError,
    SyntaxError,
    RecursionError,
    MemoryError,
    OverflowError,
    tokenize.TokenError,
)
_HEADERS = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}


@dataclass(frozen=True)
class SurfaceSamples:
    """Points on a mesh, N of them.

    A label, the corners of a triangle, shape (N, 3), and their weights, shape (N, 3).
    """

    labels: np.ndarray
    corners: np.ndarray
    weights: np.ndarray


def read_arrays(path: Path, count: int) -> list[np.ndarray]:
    """The first `count` arrays of those saved one after another in an npy file, float64."""
    with _said_of(path, f"{count} arrays of numbers one after another (npy)"):
        size = path.stat().st_size
        with path.open("rb") as file:
            return [_array(file, size) for _ in range(count)]


def _array(file: BinaryIO, size: int) -> np.ndarray:
    header = _HEADERS.get(np.lib.format.read_magic(file))
    if header is None:
        raise ValueError("an npy array of another version")
    shape, by_columns, dtype = header(file)
    if dtype.kind != "f" or min(shape, default=0) < 0:
        raise ValueError(f"an array of {dtype} {shape}")
    claimed, left = math.prod(shape) * dtype.itemsize, size - file.tell()
    if claimed > left:
        raise ValueError(f"an array of {claimed} bytes where {left} are left")
    array = np.frombuffer(file.read(claimed), dtype)
    return array.reshape(shape, order="F" if by_columns else "C").astype(np.float64)


def read_points(path: Path) -> np.ndarray:
    """Vertices of an OBJ file, shape (V, 3), float32, finite."""
    return _finite(path, ObjText(path).positions())


def read_mesh(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices, shape (V, 3), float32, and triangles, shape (F, 3), int32, of an OBJ file."""
    mesh = ObjText(path).mesh()
    if (mesh.counts != 3).any():
        raise UserError(f"{path}: has faces of {mesh.counts.max()} corners, wanted triangles; {AGAIN}")
    return _finite(path, mesh.positions), mesh.corners.reshape(-1, 3).astype(np.int32)


def _finite(path: Path, points: np.ndarray) -> np.ndarray:
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise UserError(f"{path}: vertex {bad[0]} is not finite; {AGAIN}")
    return points


def read_vectors(path: Path) -> np.ndarray:
    """A count V, then V times x y z; shape (V, 3)."""
    with _said_of(path, "a count and so many vectors"):
        numbers = _numbers(path)
        return _table(numbers[1:], _count(numbers[0]), 3)


def read_samples(path: Path, vertices: int) -> SurfaceSamples:
    """`# N`, then `label i0 i1 i2 u v` a line.

    Points (1 - u - v, u, v) on triangles of a body with this number of `vertices`.
    """
    with _said_of(path, "lines of a label, three vertices and two weights"):
        numbers = _numbers(path)
        table = _table(numbers[1:], _count(numbers[0]), 6)
        labels, corners = table[:, 0], _indices(table[:, 1:4], vertices)
        if labels.min() < 0 or (labels % 1).any():
            raise ValueError("a label that is no whole number from 0")
        return SurfaceSamples(labels.astype(np.int64), corners, _weights(table[:, 4:]))


def read_chart(path: Path, vertices: int) -> Chart:
    """The map from a garment with this number of `vertices` to pixels: the first of the levels that the file holds."""
    with _said_of(path, "a square map of pixels, three vertices and two weights each"):
        numbers = _numbers(path)
        levels = _count(numbers[0])
        (height, width), start = numbers[[1, 1 + levels]], 1 + 2 * levels
        if height != width:
            raise ValueError(f"a map of {width:g} x {height:g} pixels")
        size, rows = _count(height), numbers[start + 2 :]
        count = _count(numbers[start + 1])
        table = _table(rows if levels == 1 else rows[: 7 * count], count, 7)
        x, y = _indices(table[:, :2], size).T
        pixels, order = np.unique(y * size + x, return_index=True)
        if len(pixels) < count:
            raise ValueError(f"{count - len(pixels)} pixels named twice")
        return Chart(size, pixels, _indices(table[:, 2:5], vertices)[order], _weights(table[:, 5:])[order])


def read_sampling(path: Path, vertices: int, size: int) -> tuple[np.ndarray, np.ndarray]:
    """`# V`, then four pixels (x, y) of a map of `size` pixels a side, and four weights, a line.

    Returns:
        Pixels, y * size + x, and weights, shape (V, 4) each, as `geometry.uvmap.bilinear_table` gives them.
    """
    with _said_of(path, f"four pixels of a {size} x {size} map and four weights for each of {vertices} vertices"):
        numbers = _numbers(path)
        table = _table(numbers[1:], _count(numbers[0]), 12)
        if len(table) != vertices:
            raise ValueError(f"{len(table)} vertices")
        x, y = np.moveaxis(_indices(table[:, :8], size).reshape(-1, 4, 2), -1, 0)
        return y * size + x, table[:, 8:]


def read_groups(path: Path, vertices: int) -> list[np.ndarray]:
    """`# n`, then `k id...` a line: the copies of each point of cloth among a garment's `vertices`."""
    with _said_of(path, "a line for each point of cloth: how many copies, and which"):
        numbers = _numbers(path)
        groups, at = [], 1
        for _ in range(_count(numbers[0])):
            copies = _count(numbers[at])
            groups.append(_indices(numbers[at + 1 : at + 1 + copies], vertices))
            at += 1 + copies
        if at != len(numbers) or sum(map(len, groups)) != len(numbers) - 1 - len(groups):
            raise ValueError("more or fewer numbers than its counts say")
        return groups


@contextmanager
def _said_of(path: Path, wanted: str) -> Iterator[None]:
    """Whatever the block finds wrong, said of the file in one line."""
    try:
        yield
    except OSError as e:
        raise UserError(f"{path}: can't be read ({e.strerror or e}), wanted {wanted}; {AGAIN}") from e
    except IndexError as e:
        raise UserError(f"{path}: ends too early, wanted {wanted}; {AGAIN}") from e
    except _DAMAGED as e:
        why = str(e).strip().splitlines()[0][:120] if str(e).strip() else type(e).__name__
        raise UserError(f"{path}: damaged or of another kind ({why}), wanted {wanted}; {AGAIN}") from e


def _numbers(path: Path) -> np.ndarray:
    """All numbers of a text, shape (n,), float64, the `#` before a count left out."""
    numbers = np.array(path.read_bytes().replace(b"#", b" ").split()).astype(np.float64)
    if not np.isfinite(numbers).all():
        raise ValueError("a number that is not finite")
    return numbers


def _table(numbers: np.ndarray, rows: int, columns: int) -> np.ndarray:
    if len(numbers) != rows * columns:
        raise ValueError(f"{len(numbers)} numbers, for {rows} rows of {columns}")
    return numbers.reshape(rows, columns)


def _count(number: float) -> int:
    if number < 1 or number % 1:
        raise ValueError(f"{number:g} for a count")
    return int(number)


def _indices(numbers: np.ndarray, count: int) -> np.ndarray:
    """Whole numbers below `count`, int64."""
    wrong = (numbers < 0) | (numbers >= count) | (numbers % 1 != 0)
    if wrong.any():
        raise ValueError(f"{numbers[wrong][0]:g} for one of {count}")
    return numbers.astype(np.int64)


def _weights(last_two: np.ndarray) -> np.ndarray:
    """Barycentric weights, shape (n, 3), of which the last two are given."""
    return np.concatenate([1 - last_two.sum(axis=1, keepdims=True), last_two], axis=1)
