"""Reading the text of Wavefront OBJ files without a Python step a line: a frame of 20k vertices in about 20 ms.

Reference: Wavefront's "Object Files (.obj)", Appendix B1 of the Advanced Visualizer manual: v, vt and f lines; indices
count from 1, negative ones from the end of what was listed so far.
"""

import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from garmentbench.errors import UserError
from garmentbench.importing.meshes.mesh_sequence import refusal, size_of

LARGEST = 1 << 30  # [bytes] of one frame
_SPACES = (9, 10, 13, 32)
_AGAIN = "export it again as OBJ"


@dataclass(frozen=True)
class ObjMesh:
    """One OBJ file.

    Attributes:
        positions: Shape (V, 3), float32.
        counts: Corners of each polygon, shape (P,).
        corners: Vertex of each corner, shape (C,).
        corner_uv: UV of each corner, shape (C, 2), float32; None where the file has none.
    """

    positions: np.ndarray
    counts: np.ndarray
    corners: np.ndarray
    corner_uv: np.ndarray | None


class ObjText:
    """An OBJ file's lines, sorted by kind; nothing is parsed until asked for.

    Raises `UserError`, as all that it does.
    """

    def __init__(self, path: Path) -> None:
        size = size_of(path, "an OBJ file")
        if size > LARGEST:
            raise refusal(path, f"has {size} bytes, wanted one frame below {LARGEST}", "export one OBJ file a frame")
        self.path = path
        data = path.read_bytes()
        data = data.replace(b"\\\r\n", b"  ").replace(b"\\\n", b" ") if b"\\" in data else data
        self._data = data if data.endswith(b"\n") else data + b"\n"
        codes = np.frombuffer(self._data, np.uint8)
        self._ends = np.flatnonzero(codes == 10)
        self._starts = np.concatenate([[0], self._ends[:-1] + 1])
        first, second = codes[self._starts], codes[np.minimum(self._starts + 1, len(codes) - 1)]
        blank = np.isin(second, _SPACES)
        v = first == ord("v")
        self._lines = {
            "v": np.flatnonzero(v & blank),
            "vt": np.flatnonzero(v & (second == ord("t"))),
            "f": np.flatnonzero((first == ord("f")) & blank),
        }

    def count(self, kind: str) -> int:
        """Number of lines of a kind ("v", "vt", "f")."""
        return len(self._lines[kind])

    def text(self, kind: str) -> bytes:
        """All lines of a kind."""
        lines = self._lines[kind]
        if not len(lines):
            return b""
        breaks = np.flatnonzero(np.diff(lines) > 1)
        begins, stops = lines[np.concatenate([[0], breaks + 1])], lines[np.concatenate([breaks, [len(lines) - 1]])]
        spans = zip(self._starts[begins], self._ends[stops] + 1, strict=True)
        return b"".join(self._data[a:b] for a, b in spans)

    def positions(self) -> np.ndarray:
        """Vertices, shape (V, 3), float32."""
        return self._table("v", 3, (3, 4, 6, 7))[:, :3]

    def mesh(self) -> ObjMesh:
        """All of it."""
        positions, uv = self.positions(), None
        counts, table = self._faces()
        corners = self._indices(table[:, 0], counts, "v")
        if table.shape[1] > 1 and self.count("vt") and (table[:, 1] != 0).all():
            uv = self._table("vt", 2, (2, 3))[:, :2][self._indices(table[:, 1], counts, "vt")]
        return ObjMesh(positions, counts, corners, uv)

    def _table(self, kind: str, wanted: int, widths: tuple[int, ...]) -> np.ndarray:
        count = self.count(kind)
        if not count:
            raise refusal(self.path, f"has no {kind} lines, wanted an OBJ mesh", _AGAIN)
        try:
            numbers = _numbers(self.text(kind).translate(_BLANK[kind]), np.float32)
        except ValueError:
            raise self._odd_line(kind, wanted) from None
        width = len(numbers) // count
        if len(numbers) % count or width not in widths:
            raise self._odd_line(kind, wanted)
        return numbers.reshape(count, width)

    def _faces(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners of each polygon, shape (P,), and what each corner names (v, vt, vn as far as given), shape (C, 1
        to 3)."""
        if not self.count("f"):
            raise refusal(self.path, "has no f lines (faces), wanted a mesh", "export the mesh with its faces")
        text = self.text("f").translate(_BLANK["f"]).replace(b"//", b"/0/")
        codes = np.frombuffer(text, np.uint8)
        gap = np.isin(codes, _SPACES)
        tokens = np.flatnonzero(~gap & np.concatenate([[True], gap[:-1]]))
        counts = np.diff(np.searchsorted(tokens, np.concatenate([[0], np.flatnonzero(codes == 10)])))
        slashes = np.add.reduceat(codes == ord("/"), tokens, dtype=np.int64) if len(tokens) else np.zeros(1, np.int64)
        try:
            numbers = _numbers(text.replace(b"/", b" "), np.int64)
        except ValueError:
            raise self._odd_line("f", 3) from None
        if np.ptp(slashes) or not len(tokens) or len(numbers) != len(tokens) * (slashes[0] + 1) or counts.min() < 3:
            raise self._odd_line("f", 3)
        return counts, numbers.reshape(len(tokens), -1)

    def _indices(self, named: np.ndarray, counts: np.ndarray, kind: str) -> np.ndarray:
        """What corners name, counted from 0."""
        so_far = np.searchsorted(self._lines[kind], self._lines["f"])  # lines of that kind before each face
        found = np.where(named > 0, named - 1, np.repeat(so_far, counts) + named)
        bad = np.flatnonzero((found < 0) | (found >= self.count(kind)) | (named == 0))
        if len(bad):
            face = int(np.searchsorted(np.cumsum(counts), bad[0], side="right"))
            line, there = self._lines["f"][face] + 1, self.count(kind)
            raise refusal(self.path, f"line {line} names {kind} {named[bad[0]]}, there are {there}", _AGAIN)
        return found

    def _odd_line(self, kind: str, wanted: int) -> UserError:
        """The first line of a kind that can't be read, found slowly."""
        style = None
        for line in self._lines[kind]:
            text = self._data[self._starts[line] : self._ends[line]].decode(errors="replace")
            words = text.split()[1:]
            style = style or [len(words) if kind != "f" else w.count("/") for w in words[:1]]
            same = [w.count("/") for w in words] == style * len(words) if kind == "f" else [len(words)] == style
            if (
                len(words) < wanted
                or not same
                or not all(_is_number(part, kind) for w in words for part in w.split("/"))
            ):
                like = "corners" if kind == "f" else "numbers"
                return refusal(
                    self.path, f"line {line + 1} is '{text.strip()[:60]}', wanted {like} as before it", _AGAIN
                )
        return refusal(self.path, f"its {kind} lines can't be read", _AGAIN)


def _is_number(word: str, kind: str) -> bool:
    try:
        int(word or "0") if kind == "f" else float(word)
    except ValueError:
        return False
    return True


_BLANK = {kind: bytes.maketrans(kind.encode(), b" " * len(kind)) for kind in ("v", "vt", "f")}


def _numbers(text: bytes, dtype: type) -> np.ndarray:
    """All numbers of a text. Raises ValueError where it holds something else."""
    with warnings.catch_warnings():  # before NumPy 2.4 what can't be read is a warning
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, dtype, sep=" ")
        except DeprecationWarning as e:
            raise ValueError(str(e)) from e
