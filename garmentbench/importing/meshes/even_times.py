"""Frames at uneven times, brought to an even rate by interpolation, where that is little and can be said."""

from pathlib import Path
from typing import TypeGuard

import numpy as np

from garmentbench.importing.meshes.mesh_sequence import refusal

_EVEN = 0.05  # of a step: times that are off by less are rounded
_FARTHEST = 3.05  # steps between frames up to which what lies between is interpolated
_WHOLE = 1e-3  # [s] from a whole number
_RATES = (24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 100.0, 120.0)  # that uneven times are brought to where they are near
_NEAR_RATE = 0.03
_DO = "export at a constant frame rate"


def evenly_timed(
    path: Path, frames: np.ndarray, times: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray | None, float | None, tuple[str, ...]]:
    """Frames at even times.

    Args:
        path: Their file, for complaints.
        frames: Positions, shape (T, V, 3).
        times: When each frame is [s], shape (T,); None where the file doesn't say.

    Returns:
        Frames, times, the rate (None of a single frame), and a note where frames had to be interpolated.

    Raises:
        UserError: Times are not finite, don't increase, or have a gap too wide to be filled.
    """
    if times is None or len(times) < 2:
        return frames, times, None, ()
    _refuse_odd(path, times)
    steps = np.diff(times)
    step = (times[-1] - times[0]) / len(steps)
    if np.abs(steps - step).max() <= _EVEN * step + 1e-6 * np.abs(times).max():
        return frames, times, float(round(1 / step, 3)), ()
    step = float(np.median(steps))
    gap = int(np.argmax(steps))
    if steps[gap] > _FARTHEST * step:
        found = f"frames {gap} and {gap + 1} are at {times[gap]:g} s and {times[gap + 1]:g} s"
        wanted = f"wanted evenly spaced times, or steps near {step:.3g} s to interpolate between"
        raise refusal(path, f"{found}, {wanted}", f"{_DO}, or cut it there")
    rate = min(_RATES, key=lambda r: abs(r * step - 1))
    rate = rate if abs(rate * step - 1) <= _NEAR_RATE else float(round(1 / step, 3))
    even = times[0] + np.arange(int((times[-1] - times[0]) * rate + 0.01) + 1) / rate
    note = f"times are uneven, {steps.min():.3g} to {steps.max():.3g} s apart: interpolated at {rate:g} frames a second"
    return _between(frames, times, even), even, rate, (note,)


def are_numbers(times: np.ndarray | None) -> TypeGuard[np.ndarray]:
    """Are times [s] whole numbers? No cloth is recorded at one frame a second or fewer: they are numbers of frames."""
    if times is None or len(times) < 2 or not np.isfinite(times).all():
        return False
    return bool(np.diff(times).min() > 1 - _WHOLE and np.abs(times - times.round()).max() < _WHOLE)


def _refuse_odd(path: Path, times: np.ndarray) -> None:
    with np.errstate(invalid="ignore"):
        bad = np.flatnonzero(~(np.diff(times) > 0) | ~np.isfinite(times[1:]) | ~np.isfinite(times[:-1]))
    if len(bad):
        k = bad[0]
        found = f"frames {k} and {k + 1} are at {times[k]:g} s and {times[k + 1]:g} s, wanted times that increase"
        raise refusal(path, found, _DO)


def _between(frames: np.ndarray, times: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Linear interpolation of frames at other times, which lie among theirs; shape (len(at), V, 3), float32."""
    after = np.clip(np.searchsorted(times, at), 1, len(times) - 1)
    share = np.clip((at - times[after - 1]) / (times[after] - times[after - 1]), 0.0, 1.0)
    out = np.empty((len(at), *frames.shape[1:]), np.float32)
    for k, (b, w) in enumerate(zip(after, share, strict=True)):
        out[k] = (1 - w) * frames[b - 1] + w * frames[b]
    return out
