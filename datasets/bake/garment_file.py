"""Writing a baked garment."""

import numpy as np

from garmentbench.paths import GARMENTS


def save(name: str, arrays: dict[str, np.ndarray], provenance: str) -> None:
    """Write datasets/garments/{name}.npz: positions as float32, numbers as int32, its licence and its source."""
    small = {k: v.astype(np.float32 if v.dtype.kind == "f" else np.int32) for k, v in arrays.items()}
    text = {"licence": np.array("CC0-1.0"), "provenance": np.array(provenance)}
    np.savez_compressed(GARMENTS / f"{name}.npz", **small, **text)
    print(f"{name}: {len(small['rest'])} vertices, {len(small['faces'])} faces, {len(small['seams'])} seam pairs")
