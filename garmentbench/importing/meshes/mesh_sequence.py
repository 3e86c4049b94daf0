"""A moving mesh as a file has it, the one type that all readers give and all writers take; and how both complain."""

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from garmentbench.errors import UserError
from garmentbench.importing.text import counted


@dataclass(frozen=True)
class MeshSequence:
    """A moving mesh in its own units and axes.

    Attributes:
        name: What it is called, e.g. the file's stem.
        frames: Positions, shape (T, V, 3), float32 of any byte order; may be mapped from a file.
        faces: Triangles, shape (F, 3), int32.
        corner_uv: UV of each triangle's corners, shape (F, 3, 2), float32; None where the file has none.
        rest: Rest positions, shape (V, 3), float32; None where the first frame must do.
        fps: Frames a second, as the file says; None where it doesn't.
        unit: Metres in one of its units, as the file says; None where it doesn't.
        up: "x", "y" or "z", as the file says; None where it doesn't.
        times: When each frame is [s], or where `counted` its number, shape (T,); None where the file doesn't say.
        counted: `times` are numbers of frames, as in PC2 and in names of OBJ files.
        pins: Vertices held fast to the body, shape (P,), int32.
        numbers: Each vertex's number in the file, shape (V,); None where all are there.
        beside: Names of the other meshes of its file.
        notes: What was done to it while reading, e.g. "12 quads cut into triangles".
        files: The files that it was read from.
    """

    name: str
    frames: np.ndarray
    faces: np.ndarray
    corner_uv: np.ndarray | None = None
    rest: np.ndarray | None = None
    fps: float | None = None
    unit: float | None = None
    up: str | None = None
    times: np.ndarray | None = None
    counted: bool = False
    pins: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int32))
    numbers: np.ndarray | None = None
    beside: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    files: tuple[Path, ...] = ()

    @property
    def where(self) -> Path | str:
        """What to name in a complaint: its file, or else its name."""
        return self.files[0] if self.files else self.name

    @property
    def required_times(self) -> np.ndarray:
        """When each frame is, shape (T,), for work on files that say so."""
        assert self.times is not None, "ask `times` first"
        return self.times

    @property
    def still(self) -> np.ndarray:
        """The rest positions, or else the first frame, shape (V, 3)."""
        return self.frames[0] if self.rest is None else self.rest


def without_spare(mesh: MeshSequence) -> MeshSequence:
    """The mesh without vertices that no face uses, which would decide its size; and a note on these."""
    used = np.unique(mesh.faces)
    spare = mesh.frames.shape[1] - len(used)
    if not spare:
        return mesh
    return replace(
        mesh,
        frames=mesh.frames[:, used],
        faces=np.searchsorted(used, mesh.faces).astype(np.int32),
        rest=None if mesh.rest is None else mesh.rest[used],
        pins=np.searchsorted(used, mesh.pins[np.isin(mesh.pins, used)]).astype(np.int32),
        numbers=used,
        notes=(*mesh.notes, f"{counted(spare, 'vertex', 'vertices')} without a face left out"),
    )


def refusal(where: Path | str, found: str, do: str) -> UserError:
    """The error, in one line, for what can't be used: where, what was found and wanted, what to do."""
    return UserError(" ".join(f"{where}: {found}; {do}".split()))


def size_of(path: Path, wanted: str) -> int:
    """Size of a file [bytes]. Raises `UserError` where there is none, or an empty one."""
    if not path.is_file():
        raise refusal(path, f"{'a folder' if path.is_dir() else 'no such file'}, wanted {wanted}", "check the path")
    size = path.stat().st_size
    if size == 0:
        raise refusal(path, f"an empty file, wanted {wanted}", "export it again")
    return size


def checked_faces(where: Path | str, faces: np.ndarray, vertices: int) -> np.ndarray:
    """Triangles as int32. Raises `UserError` where there is none, or one that names a vertex which is not there."""
    if not len(faces):
        raise refusal(where, "has no faces, wanted a mesh", "export the mesh with its faces")
    bad = np.flatnonzero(((faces < 0) | (faces >= vertices)).any(axis=1))
    if len(bad):
        found = f"face {bad[0]} names vertices {faces[bad[0]].tolist()}, there are {vertices}"
        raise refusal(where, found, "export the mesh again, whole")
    return faces.astype(np.int32)
