"""The garment of a scene: baked, in datasets/garments/{name}-{size}.npz, or the user's own."""

import numpy as np

from garmentbench.errors import UserError, unknown_name
from garmentbench.paths import GARMENTS
from garmentbench.scenes.garment_file import read_garment
from garmentbench.scenes.presets import MESH_SIZES, MeshSize
from garmentbench.scenes.scene import Scene
from garmentbench.sequence import Garment


def garment_names() -> list[str]:
    """Names of all baked garments."""
    return sorted({path.stem.rsplit("-", 1)[0] for path in GARMENTS.glob("*.npz")})


def load_garment(name: str, size: str) -> Garment:
    """The garment of that name at a mesh size ("smoke", "laptop", "desktop", "paper").

    Raises `UsageError` with the nearest name where the name or the size is unknown.
    """
    if size not in MESH_SIZES:
        raise unknown_name("mesh size", size, list(MESH_SIZES))
    path = GARMENTS / f"{name}-{size}.npz"
    if name not in garment_names():
        raise unknown_name("garment", name, garment_names())
    if not path.is_file():
        sizes = ", ".join(p.stem.rsplit("-", 1)[1] for p in GARMENTS.glob(f"{name}-*.npz"))
        raise UserError(f"garment '{name}' has no mesh of size {size}; it has {sizes}")
    with np.load(path, allow_pickle=False) as arrays:
        parts = (arrays[key] for key in ("rest", "faces", "uv", "seams", "pins"))
        return Garment(name, *parts, cut=arrays.get("cut"))


def scene_garment(scene: Scene, size: MeshSize) -> Garment:
    """The garment of a scene: a baked one at that size, one of the user's own as its file has it.

    Raises `UserError` where it is unknown, or its file can't be worn.
    """
    if scene.mesh is None:
        return load_garment(scene.garment, size.name)
    return read_garment(scene.garment, scene.mesh)
