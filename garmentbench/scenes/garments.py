"""The baked garments in datasets/garments/{name}-{size}.npz."""

import numpy as np

from garmentbench.errors import unknown_name
from garmentbench.paths import GARMENTS
from garmentbench.scenes.presets import MESH_SIZES
from garmentbench.sequence import Garment


def garment_names() -> list[str]:
    """Names of all baked garments."""
    return sorted({path.stem.rsplit("-", 1)[0] for path in GARMENTS.glob("*.npz")})


def load_garment(name: str, size: str) -> Garment:
    """The garment of that name at a mesh size ("smoke", "laptop", "paper").

    Raises `UsageError` with the nearest name where the name or the size is unknown.
    """
    if size not in MESH_SIZES:
        raise unknown_name("mesh size", size, list(MESH_SIZES))
    path = GARMENTS / f"{name}-{size}.npz"
    if not path.is_file():
        raise unknown_name("garment", name, garment_names())
    with np.load(path, allow_pickle=False) as arrays:
        return Garment(name, *(arrays[key] for key in ("rest", "faces", "uv", "seams", "pins")))
