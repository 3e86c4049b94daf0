"""Pairing the frames of garment and body by their times, on the frames that both have."""

from dataclasses import dataclass, replace

import numpy as np

from garmentbench.errors import UserError
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal

_SAME = 0.1  # of the shorter step: times this near are the same
_ONE_FRAME = 1.01  # formats count from 0 or from 1


@dataclass(frozen=True)
class Paired:
    """Garment and body over the same frames.

    Attributes:
        garment, body: With frames, times and rates of the frames that are kept only.
        fps: The rate that the user gave, brought to these frames; None where none was given.
        notes: What was done, for the user.
    """

    garment: MeshSequence
    body: MeshSequence | None
    fps: float | None
    notes: tuple[str, ...] = ()


def paired(garment: MeshSequence, body: MeshSequence | None, fps: float | None, same_start: bool = False) -> Paired:
    """Keep the frames that garment and body have in common.

    Args:
        garment, body: As they were read; a body of one frame stands still, whatever its time.
        fps: Frames a second as the user says, or None.
        same_start: Both begin at the same moment, whatever their times say.

    Raises `UserError` where they have no frame in common, where their rates don't fit together, or where `fps`
    contradicts rates that differ.
    """
    if body is None or len(body.frames) == 1 or garment.times is None or body.times is None:
        return Paired(garment, body, fps)
    _refuse_other_rate(garment, body, fps)
    _refuse_other_sampling(garment, body)
    (ours, theirs), notes = _comparable(garment, body, fps)
    if same_start:
        ours, theirs = ours - ours[0], theirs - theirs[0]
    steps = [float(np.median(np.diff(t))) if len(t) > 1 else np.inf for t in (ours, theirs)]
    step = min(steps)
    tolerance = _SAME * step if np.isfinite(step) else 1e-6
    near = np.clip(np.searchsorted(theirs, ours), 1, max(len(theirs) - 1, 1))
    near = np.where(
        np.abs(theirs[near - 1] - ours) <= np.abs(theirs[np.minimum(near, len(theirs) - 1)] - ours), near - 1, near
    )
    near = np.minimum(near, len(theirs) - 1)
    kept = np.flatnonzero(np.abs(theirs[near] - ours) <= tolerance)
    spans = f"the garment's frames are from {_span(garment, ours)}, the body's from {_span(body, theirs)}"
    if not len(kept) or (len(kept) == 1 and min(len(ours), len(theirs)) > 1):
        raise refusal(
            garment.where,
            f"{'only one' if len(kept) else 'no'} frame in common: {spans}",
            "export both over the same frames, or give --same-start if both begin at the same moment all the same",
        )
    common = float(np.median(np.diff(ours[kept]))) if len(kept) > 1 else max(steps)
    coarser = max(s for s in steps if np.isfinite(s)) if np.isfinite(step) else 1.0
    if len(kept) > 1 and (common > 1.01 * coarser or np.ptp(np.diff(ours[kept])) > 0.5 * common):
        raise refusal(
            garment.where,
            f"the rates don't fit together: {spans}, of which both have {len(kept)}",
            "export both at the same rate",
        )
    if len(kept) < max(len(ours), len(theirs)) or same_start:
        notes = (*notes, f"frames: {len(kept)} that both have, from {_span(garment, ours[kept])}; {spans}")
    rate = None if garment.counted or len(kept) < 2 or not common else float(round(1 / common, 3))
    factor = step / common if len(kept) > 1 and steps[0] != steps[1] else 1.0
    if fps is not None and factor != 1:
        notes = (
            *notes,
            f"of {fps:g} frames a second (--fps) both have every {round(1 / factor)}th: {fps * factor:g} a second",
        )
    return Paired(
        _only(garment, kept, rate), _only(body, near[kept], rate), None if fps is None else fps * factor, notes
    )


def _refuse_other_rate(garment: MeshSequence, body: MeshSequence, fps: float | None) -> None:
    """--fps mends a rate that both files state wrongly; where they state different ones it would part them."""
    if fps is None or garment.fps is None or body.fps is None or garment.counted or body.counted:
        return
    if abs(garment.fps / body.fps - 1) > 0.01:
        raise UserError(
            f"--fps is {fps:g}, but the garment's file states {garment.fps:g} frames a second and the body's "
            f"{body.fps:g}; leave --fps out: they are paired by their times"
        )


def _refuse_other_sampling(garment: MeshSequence, body: MeshSequence) -> None:
    """Of two PC2 files one states frames a second in the place of its sampling, and the other doesn't."""
    if _formats(garment) | _formats(body) != {".pc2"} or (garment.fps is None) == (body.fps is None):
        return
    stated, other = (garment, body) if garment.fps else (body, garment)
    found = f"its sampling is {stated.fps:g}, that of {other.where} is not: frames a second, or every so many"
    raise refusal(stated.where, f"{found}?", "export both with the same sampling, 1 if possible")


def _comparable(
    garment: MeshSequence, body: MeshSequence, fps: float | None
) -> tuple[tuple[np.ndarray, np.ndarray], tuple[str, ...]]:
    """Times of both in one unit, and notes. Frames are counted from 0 by some formats, and from 1 by others."""
    if garment.counted == body.counted:
        ours, theirs = garment.required_times, body.required_times
        step = 1.0 if garment.counted else 1 / (garment.fps or np.inf)
        if _formats(garment) != _formats(body) and _one_apart(ours, theirs, step):
            note = f"frames: {' and '.join(sorted(_formats(garment) | _formats(body)))} count from 0 or 1"
            return (ours - ours[0], theirs - theirs[0]), (f"{note}; taken to begin together",)
        return (ours, theirs), ()
    timed, counted = (body, garment) if garment.counted else (garment, body)
    rate = fps or timed.fps
    if not rate:
        return (garment.required_times - garment.required_times[0], body.required_times - body.required_times[0]), ()
    seconds = counted.required_times / rate
    if abs(seconds[0] - timed.required_times[0]) * rate <= _ONE_FRAME:
        seconds = seconds - seconds[0] + timed.required_times[0]
        note = ("frames: one file counts them, the other has times; taken to begin together",)
    else:
        note = (f"frames: the numbers of {counted.where} are taken as times at {rate:g} a second, from 0 on",)
    return ((seconds, body.required_times) if garment.counted else (garment.required_times, seconds)), note


def _formats(mesh: MeshSequence) -> set[str]:
    """The ending of the file that says when its frames are."""
    return {file.suffix.lower() for file in mesh.files[:1]}


def _one_apart(ours: np.ndarray, theirs: np.ndarray, step: float) -> bool:
    """Do as many frames at the same step begin one frame apart?"""
    if len(ours) != len(theirs) or not np.isfinite(step) or step <= 0:
        return False
    shift = theirs - ours
    return bool(np.ptp(shift) < _SAME * step and abs(abs(shift[0]) / step - 1) < _SAME)


def _only(mesh: MeshSequence, kept: np.ndarray, rate: float | None) -> MeshSequence:
    """Some of the frames; still mapped from the file where they follow each other."""
    first, last = int(kept[0]), int(kept[-1])
    frames = mesh.frames[first : last + 1] if last - first + 1 == len(kept) else mesh.frames[kept]
    return replace(mesh, frames=frames, times=mesh.required_times[kept], fps=rate if rate is not None else mesh.fps)


def _span(mesh: MeshSequence, times: np.ndarray) -> str:
    """First and last time, as the file has them."""
    unit = "" if mesh.counted else " s"
    each = f", {mesh.fps:g} a second" if mesh.fps and not mesh.counted else ""
    return f"{times[0]:.4g} to {times[-1]:.4g}{unit} ({len(times)}{each})"
