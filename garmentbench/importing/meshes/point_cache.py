"""What formats share that hold positions over time: the template that they lie on, and the rate of their times."""

from pathlib import Path

import numpy as np

from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal


def with_template(
    path: Path, frames: np.ndarray, template: MeshSequence, fps: float | None, notes: tuple[str, ...] = ()
) -> MeshSequence:
    """Cached positions, shape (T, V, 3), on a template's mesh. Raises `UserError` where the vertex counts differ."""
    if frames.shape[1] != len(template.still):
        found = f"has {frames.shape[1]} points, its template {template.files[0]} has {len(template.still)} vertices"
        raise refusal(path, found, "export both from the same mesh, with no modifier between")
    return MeshSequence(
        path.stem,
        frames,
        template.faces,
        template.corner_uv,
        template.still,
        fps,
        notes=(*template.notes, *notes),
        files=(path, *template.files),
    )


def rate_of(path: Path, times: np.ndarray) -> float | None:
    """Frames a second of evenly spaced times [s], shape (T,); None of a single one. Raises `UserError` for others."""
    if len(times) < 2:
        return None
    with np.errstate(invalid="ignore", over="ignore"):
        steps = np.diff(times)
        step = (times[-1] - times[0]) / (len(times) - 1)
        rounding = 1e-6 * np.abs(times).max()
        even = step > 0 and np.isfinite(times).all() and np.abs(steps - step).max() <= 0.05 * step + rounding
    if not even:
        with np.errstate(invalid="ignore"):
            bad = int(np.argmax(~(np.abs(steps - np.median(steps)) <= 0.05 * np.abs(np.median(steps)))))
        found = (
            f"frames {bad} and {bad + 1} are at {times[bad]:g} s and {times[bad + 1]:g} s, wanted evenly spaced times"
        )
        raise refusal(path, found, "export at a constant frame rate")
    return float(round(1 / step, 3))
