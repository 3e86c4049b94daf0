"""Writing a mended garment: OBJ for other programs, .npz as the baked garments are."""

from pathlib import Path

import numpy as np

from garmentbench.errors import UsageError, UserError
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.meshes import obj
from garmentbench.importing.meshes.mesh_sequence import MeshSequence
from garmentbench.storage.atomic import written_whole


def writable(path: Path) -> None:
    """Raises `UsageError` for a name that is neither OBJ nor .npz."""
    if path.suffix.lower() not in (".obj", ".npz"):
        raise UsageError(f"--fix {path}: wanted a name that ends in .obj or .npz")


def write_mesh(path: Path, mesh: Mesh) -> list[str]:
    """Write a garment whole; gives a line on what the format can't hold. Raises `UserError` where it can't be written."""
    writable(path)
    if path.suffix.lower() == ".npz":
        _write_npz(path, mesh)
        return []
    has_uv = mesh.uv is not None and np.isfinite(mesh.uv[mesh.faces]).all()
    uv = mesh.uv[mesh.faces].astype(np.float32) if has_uv else None
    points = mesh.points.astype(np.float32)
    obj.write_template(path, MeshSequence(mesh.name, points[None], mesh.corners.astype(np.int32), uv))
    return [f"left out {len(mesh.pins)} pins: OBJ has no place for them, .npz has"] if len(mesh.pins) else []


def _write_npz(path: Path, mesh: Mesh) -> None:
    if mesh.uv is None or not np.isfinite(mesh.uv).all():
        found = "a garment's .npz needs UV, and this mesh has none for all of it"
        raise UserError(f"{path}: {found}; give --make-uv, or write .obj")
    arrays = {
        "rest": mesh.vertices.astype(np.float32),
        "faces": mesh.faces.astype(np.int32),
        "uv": mesh.uv.astype(np.float32),
        "seams": mesh.seams.astype(np.int32),
        "pins": mesh.pins.astype(np.int32),
        **mesh.notes,
    }
    with written_whole(path) as partial, partial.open("wb") as file:
        np.savez_compressed(file, **arrays)
