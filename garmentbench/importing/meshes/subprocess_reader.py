"""Reading USD, Alembic and foreign HDF5 files in a process of its own.

Their libraries trust what a file says: a damaged one may crash the process, hang it, or make it ask for all memory.
Here that ends a child, which has a limit of time and memory, and becomes one line.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from garmentbench.errors import UserError
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal, size_of

_SECONDS, _SECONDS_A_MB = 30.0, 1.0
_MEMORY, _MEMORY_A_BYTE = 4 << 30, 8  # the libraries reserve far more addresses than they use
_ARRAYS = ("frames", "faces", "corner_uv", "rest", "pins", "times")
_AGAIN = "export it again, or as a PC2 or OBJ sequence"


def read_isolated(path: Path, prim: str, role: str) -> MeshSequence | None:
    """A mesh of a USD, Alembic or HDF5 file; None where none is named as a body, and `role` is "body if named so".

    Args:
        path: The file.
        prim: The mesh's path, or the end of it; "" where `role` says enough.
        role: "garment", "body", or "body if named so".

    Raises:
        UserError: One line: the file can't be read, or it is not clear which mesh is meant, or a package is missing.
    """
    size = size_of(path, "a USD, Alembic or HDF5 file")
    seconds = _SECONDS + _SECONDS_A_MB * size / 2**20
    with tempfile.TemporaryDirectory(prefix="garmentbench-") as folder:
        command = [
            sys.executable,
            "-m",
            "garmentbench.importing.meshes.subprocess_reader",
            str(path),
            prim,
            role,
            folder,
        ]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
        try:
            done = subprocess.run(command, env=environment, capture_output=True, timeout=seconds, check=False)
        except subprocess.TimeoutExpired:
            raise refusal(path, f"its library did not finish in {seconds:.0f} s: it is damaged", _AGAIN) from None
        written = Path(folder) / "values.json"
        if done.returncode != 0 or not written.is_file():
            why = (done.stderr.decode(errors="replace").strip().splitlines() or [f"exit code {done.returncode}"])[-1]
            raise refusal(path, f"damaged: its library gave up ({why[:120]})", _AGAIN)
        values = json.loads(written.read_text())
        if "error" in values:
            raise UserError(values["error"])
        arrays = {name: np.load(file) for name in _ARRAYS if (file := Path(folder) / f"{name}.npy").is_file()}
    if not arrays:
        return None
    return MeshSequence(**arrays, **values | {name: tuple(values[name]) for name in ("beside", "notes")}, files=(path,))


def _child(path: Path, prim: str, role: str, folder: Path) -> None:
    """Read the file, and leave arrays and values, or the line of an error, in a folder."""
    limit = _MEMORY + _MEMORY_A_BYTE * path.stat().st_size
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    values: dict = {}
    try:
        mesh = _read(path, prim, role)
        if mesh is not None:
            values = {name: getattr(mesh, name) for name in ("name", "fps", "unit", "up", "beside", "notes")}
            for name in _ARRAYS:
                if getattr(mesh, name) is not None:
                    np.save(folder / f"{name}.npy", getattr(mesh, name))
    except UserError as e:
        values = {"error": str(e)}
    except MemoryError:
        values = {"error": f"{path}: its library asked for more than {limit >> 20} MB: it is damaged; {_AGAIN}"}
    (folder / "values.json").write_text(json.dumps(values))


def _read(path: Path, prim: str, role: str) -> MeshSequence | None:
    from garmentbench.importing.meshes import alembic, arrays, usd

    ending = path.suffix.lower()
    if ending in (".h5", ".hdf5"):
        return arrays.read_hdf5(path)
    return (alembic.read_alembic if ending == ".abc" else usd.read_usd)(path, prim, role)


if __name__ == "__main__":
    _child(Path(sys.argv[1]), sys.argv[2], sys.argv[3], Path(sys.argv[4]))
