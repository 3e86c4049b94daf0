"""PLY files, by trimesh's reader."""

from pathlib import Path
from typing import Any

import numpy as np

from garmentbench.importing.meshes.mesh_sequence import MeshSequence, checked_faces, refusal, size_of
from garmentbench.importing.meshes.polygons import triangulate, what_was_cut
from garmentbench.storage.atomic import written_whole
from garmentbench.storage.hdf5 import reason

# What trimesh's reader was seen to raise on damaged files.
_ODD = (
    ValueError,
    IndexError,
    KeyError,
    TypeError,
    NameError,
    AttributeError,
    OverflowError,
    MemoryError,
    OSError,
    SyntaxError,
)


def read_ply(path: Path) -> MeshSequence:
    """A PLY file, as a sequence of one frame. Raises `UserError`, one line, for what can't be used."""
    size_of(path, "a PLY file")
    split, whole = (_load(path, parted) for parted in (True, False))  # split: each corner has its own UV
    if whole.get("faces") is None or np.ndim(whole["faces"]) != 2 or not len(whole["faces"]):
        raise refusal(
            path, "has no faces of 3 or 4 corners each, wanted a mesh", "export the mesh with its faces, as triangles"
        )
    vertices = np.asarray(whole["vertices"], np.float32).reshape(-1, 3)
    polygons = checked_faces(path, np.asarray(whole["faces"], np.int64), len(vertices))
    counts = np.full(len(polygons), polygons.shape[1])
    cut = triangulate(counts, polygons.ravel(), vertices)
    uv = None
    if getattr(split.get("visual"), "uv", None) is not None:
        uv = np.asarray(split["visual"].uv, np.float32)[np.asarray(split["faces"])].reshape(-1, 2)[cut]
    return MeshSequence(path.stem, vertices[None], polygons.ravel()[cut], uv, notes=what_was_cut(counts), files=(path,))


def _load(path: Path, fix_texture: bool) -> dict:
    from trimesh.exchange.ply import load_ply

    try:
        with path.open("rb") as file:
            return load_ply(file, fix_texture=fix_texture, skip_materials=True)
    except _ODD as e:
        found = f"damaged, or no PLY file ({reason(e)[:100]})"
        raise refusal(path, found, "export it again as OBJ or PLY") from e


def write_ply(path: Path, positions: np.ndarray, faces: np.ndarray) -> None:
    """A mesh as a PLY file: positions, shape (V, 3), triangles, shape (F, 3). Raises `UserError`."""
    import trimesh

    with written_whole(path) as partial:
        data: Any = trimesh.Trimesh(positions, faces, process=False).export(file_type="ply")
        partial.write_bytes(data)
