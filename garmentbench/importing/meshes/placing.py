"""Bringing a mesh into the house's frame: metres, z up, float32, vertices split, faces outward; checked on the way."""

import numpy as np

from garmentbench.importing.meshes.conventions import converter
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal

FARTHEST = 1e4  # [m] from the origin; what is farther is no number that anybody meant
_BLOCK = 8  # frames converted at once
_TURNS = {"": "z", "y up to z up": "y", "z up to y up": "-y"}  # of a template whose axes differ from the recording's


def placed_frames(mesh: MeshSequence, origin: np.ndarray | slice, unit: float, up: str, count: int) -> np.ndarray:
    """Positions [m], shape (count, W, 3), float32, of the first `count` frames; one frame is held still.

    Raises `UserError` naming the file, frame and vertex where a position is not finite or absurdly far.
    """
    matrix = converter(unit, up)
    vertices = np.arange(mesh.frames.shape[1])[origin]
    out = np.empty((count, len(vertices), 3), np.float32)
    held = len(mesh.frames) == 1
    for start in range(0, 1 if held else count, _BLOCK):
        with np.errstate(over="ignore", invalid="ignore"):
            block = np.asarray(mesh.frames[start : min(start + _BLOCK, count)], np.float32)[:, vertices]
            moved = block if unit == 1 and up == "z" else block.astype(np.float64) @ matrix.T
            bad = np.argwhere(~(np.abs(moved) < FARTHEST).all(axis=2))
        if len(bad):
            frame, vertex = bad[0]
            values = ", ".join(f"{v:g}" for v in block[frame, vertex])
            number = vertices[vertex] if mesh.numbers is None else mesh.numbers[vertices[vertex]]
            found = f"frame {start + frame}, vertex {number} is at ({values}), wanted finite positions"
            raise refusal(mesh.where, found, "export it again, or cut it before that frame (--frames)")
        out[start : start + len(moved)] = moved
    if held:
        out[:] = out[0]
    return out


def placed_rest(
    mesh: MeshSequence, origin: np.ndarray | slice, unit: float, up: str, first: np.ndarray
) -> tuple[np.ndarray, str]:
    """Rest positions [m], shape (W, 3), float32, upright as the first frame is; and what was turned, or "".

    Templates are often exported with other axes than caches: a quarter turn about x that fits the first frame far
    better is made. A turn about the vertical doesn't count.
    """
    if mesh.rest is None:
        return first.copy(), ""
    rest = placed_frames(MeshSequence(mesh.name, mesh.rest[None], mesh.faces, files=mesh.files), origin, unit, up, 1)[0]
    turned = {said: (rest.astype(np.float64) @ converter(1.0, axis).T) for said, axis in _TURNS.items()}
    misfit = {said: _misfit(x, first) for said, x in turned.items()}
    best = min(misfit, key=misfit.__getitem__)
    if not best or misfit[best] > 0.25 * misfit[""]:
        return rest, ""
    return turned[best].astype(np.float32), f"rest shape of {mesh.name}: turned from {best}, as the recording lies"


def _misfit(rest: np.ndarray, frame: np.ndarray) -> float:
    """Mean squared distance [m^2] after the best shift and turn about the vertical."""
    p, q = rest - rest.mean(axis=0), frame.astype(np.float64) - frame.mean(axis=0, dtype=np.float64)
    turned = np.hypot((p[:, :2] * q[:, :2]).sum(), (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum())
    return float(((p**2).sum() + (q**2).sum() - 2 * turned - 2 * (p[:, 2] * q[:, 2]).sum()) / len(p))


def outward(faces: np.ndarray, positions: np.ndarray) -> tuple[np.ndarray, bool]:
    """A closed body's faces with outward orientation, shape (K, 3), and whether they had to be turned."""
    x = positions.astype(np.float64) - positions.mean(axis=0)
    a, b, c = (x[faces[:, k]] for k in range(3))
    volume = np.sum(a * np.cross(b, c))
    return (faces[:, ::-1].copy(), True) if volume < 0 else (faces, False)
