"""Reading the text of Wavefront OBJ files without a Python step a line: a frame of 20k vertices in about 20 ms.

Reference: Wavefront's "Object Files (.obj)", Appendix B1 of the Advanced Visualizer manual: v, vt and f lines; indices
count from 1, negative ones from the end of what was listed so far. Read are also, as other programs do: byte order
marks, indented lines, comments behind numbers, colours on some vertices only, corners with and without UV in one file.
"""

import re
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from garmentbench.errors import UserError
from garmentbench.importing.meshes.mesh_sequence import refusal, size_of
from garmentbench.importing.text import as_utf8

LARGEST = 1 << 30  # [bytes] of one frame
_IS_SPACE = np.isin(np.arange(256), (9, 10, 13, 32))
_AGAIN = "export it again as OBJ"


@dataclass(frozen=True)
class ObjMesh:
    """One OBJ file.

    Attributes:
        positions: Shape (V, 3), float32.
        counts: Corners of each polygon, shape (P,).
        corners: Vertex of each corner, shape (C,).
        corner_uv: UV of each corner, shape (C, 2), float32, NaN for corners without; None where the file has none at
            all.
        objects, groups: Names of the objects (o lines) and groups (g lines) that have polygons.
        object_of, group_of: Which of these each polygon belongs to, shape (P,).
    """

    positions: np.ndarray
    counts: np.ndarray
    corners: np.ndarray
    corner_uv: np.ndarray | None
    objects: tuple[str, ...]
    groups: tuple[str, ...]
    object_of: np.ndarray
    group_of: np.ndarray


class ObjText:
    """An OBJ file's lines, sorted by kind; nothing is parsed until asked for.

    Raises `UserError`, as all that it does.
    """

    def __init__(self, path: Path) -> None:
        size = size_of(path, "an OBJ file")
        if size > LARGEST:
            raise refusal(path, f"has {size} bytes, wanted one frame below {LARGEST}", "export one OBJ file a frame")
        self.path = path
        self._data = _clean(path.read_bytes())
        codes = np.frombuffer(self._data, np.uint8)
        self._ends = np.flatnonzero(codes == 10)
        self._starts = np.concatenate([[0], self._ends[:-1] + 1])
        if np.isin(codes[self._starts], (9, 32)).any():  # indented: the same lines again without
            self._data = re.sub(rb"(?m)^[ \t]+", b"", self._data)
            codes = np.frombuffer(self._data, np.uint8)
            self._ends = np.flatnonzero(codes == 10)
            self._starts = np.concatenate([[0], self._ends[:-1] + 1])
        first, second = codes[self._starts], codes[np.minimum(self._starts + 1, len(codes) - 1)]
        blank = _IS_SPACE[second]
        v = first == ord("v")
        self._lines = {
            "v": np.flatnonzero(v & blank),
            "vt": np.flatnonzero(v & (second == ord("t"))),
            "f": np.flatnonzero((first == ord("f")) & blank),
            "o": np.flatnonzero((first == ord("o")) & blank),
            "g": np.flatnonzero((first == ord("g")) & blank),
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
        return self._table("v", 3)

    def mesh(self) -> ObjMesh:
        """All of it."""
        positions, uv = self.positions(), None
        counts, named = self._faces()
        corners, has_uv = self._indices(named[:, 0], counts, "v"), named[:, 1] != 0
        if self.count("vt") and has_uv.any():
            at = self._indices(np.where(has_uv, named[:, 1], 1), counts, "vt")
            uv = np.where(has_uv[:, None], self._table("vt", 2)[at], np.float32(np.nan))
        (objects, object_of), (groups, group_of) = self._parts("o"), self._parts("g")
        return ObjMesh(positions, counts, corners, uv, objects, groups, object_of, group_of)

    def _parts(self, kind: str) -> tuple[tuple[str, ...], np.ndarray]:
        """Names of the objects or groups that have faces, and the one of each face; a name that comes again is the
        same.
        """
        lines = self._lines[kind]
        at = np.searchsorted(lines, self._lines["f"])
        texts = [self._data[self._starts[k] : self._ends[k]].decode(errors="replace")[1:].strip() for k in lines]
        names = ["", *texts]
        used = list(dict.fromkeys(names[k] for k in np.unique(at)))
        number = np.array([used.index(n) if n in used else -1 for n in names])
        return tuple(used), number[at]

    def _table(self, kind: str, width: int) -> np.ndarray:
        """The first `width` numbers of each line, shape (lines, width), float32; what follows them (weight, colour)
        is left.
        """
        count = self.count(kind)
        if not count:
            raise refusal(self.path, f"has no {kind} lines, wanted an OBJ mesh", _AGAIN)
        text = self.text(kind).translate(_BLANK[kind])
        words = _words_a_line(text)
        if words.min() < width:
            raise self._odd_line(kind, width)
        try:
            if np.ptp(words) == 0:
                return _numbers(text, np.float32).reshape(count, words[0])[:, :width]
            short = b" ".join(b" ".join(line.split()[:width]) for line in text.splitlines())
            return _numbers(short, np.float32).reshape(count, width)
        except ValueError:
            raise self._odd_line(kind, width) from None

    def _faces(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners of each polygon, shape (P,), and the v and vt that each corner names, 0 for none, shape (C, 2)."""
        if not self.count("f"):
            raise refusal(self.path, "has no f lines (faces), wanted a mesh", "export the mesh with its faces")
        text = self.text("f").translate(_BLANK["f"]).replace(b"//", b"/0/")
        counts = _words_a_line(text)
        if counts.min() < 3:
            raise self._odd_line("f", 3)
        codes = np.frombuffer(text, np.uint8)
        gap = _IS_SPACE[codes]
        tokens = np.flatnonzero(~gap & np.concatenate([[True], gap[:-1]]))
        slashes = np.add.reduceat(codes == ord("/"), tokens, dtype=np.int64)
        try:
            if np.ptp(slashes) == 0 and b"/ " not in text and b"/\n" not in text and b"/\r" not in text:
                numbers = _numbers(text.replace(b"/", b" "), np.int64).reshape(len(tokens), slashes[0] + 1)
            else:
                numbers = np.array([[int(part or b"0") for part in (w + b"/").split(b"/")[:2]] for w in text.split()])
        except (ValueError, OverflowError):
            raise self._odd_line("f", 3) from None
        if slashes.max() > 2:
            raise self._odd_line("f", 3)
        return counts, np.column_stack([numbers, np.zeros(len(numbers), np.int64)])[:, :2]

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
        for line in self._lines[kind]:
            text = self._data[self._starts[line] : self._ends[line]].decode(errors="replace")
            words = text.split()[1:]
            parts = [part for w in words for part in w.split("/")] if kind == "f" else words[:wanted]
            slashes = max((w.count("/") for w in words), default=0)
            if len(words) < wanted or slashes > 2 or not all(_is_number(part, kind) for part in parts):
                like = "three corners or more" if kind == "f" else f"{wanted} numbers or more"
                return refusal(self.path, f"line {line + 1} is '{text.strip()[:60]}', wanted {like}", _AGAIN)
        return refusal(self.path, f"its {kind} lines can't be read", _AGAIN)


def _clean(data: bytes) -> bytes:
    """A file's text with one form of line ends at its end, without byte order mark, continued lines and comments."""
    data = as_utf8(data)
    if b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    if b"\\" in data:
        data = data.replace(b"\\\r\n", b"  ").replace(b"\\\n", b" ")
    if b"#" in data:
        data = re.sub(rb"#[^\n]*", lambda m: m[0] if m.start() and data[m.start() - 1] not in b" \t\n" else b"", data)
    return data if data.endswith(b"\n") else data + b"\n"


def _words_a_line(text: bytes) -> np.ndarray:
    """Number of words in each line, shape (lines,)."""
    codes = np.frombuffer(text, np.uint8)
    gap = _IS_SPACE[codes]
    words = np.flatnonzero(~gap & np.concatenate([[True], gap[:-1]]))
    return np.diff(np.searchsorted(words, np.concatenate([[0], np.flatnonzero(codes == 10)])))


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
