"""Pairing the frames of garment and body by their times, on the frames that both have."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from garmentbench.errors import UsageError, UserError
from garmentbench.importing.meshes.conventions import SLOWEST
from garmentbench.importing.meshes.even_times import are_numbers
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal

_SAME = 0.1  # of the shorter step: times this near are the same
_SAME_RATE = 0.01  # relative difference of two rates that are one
_DRIFT = 0.08  # of a body's size, that the middles of garment and body change their distance by in a motion of both
_LOOKED_AT = 20  # frames
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
        fps: Frames a second as the user says, or None. Where files number their frames it is of these numbers, so that
            a file with every other frame has half of it.
        same_start: Both begin at the same moment, whatever their times say.

    Raises `UserError` where they have no frame in common, where their rates don't fit together, or where `fps`
    contradicts a rate that a file states.
    """
    garment, notes = by_number(garment)
    if body is not None:
        body, more = by_number(body)
        notes += more
    if body is None or len(body.frames) == 1 or garment.times is None or body.times is None:
        counted = garment if garment.counted or body is None else body
        rate, more = _of_samples(counted, fps)
        return Paired(garment, body, rate, notes + more)
    _refuse_other_rate(garment, body, fps)
    _refuse_other_sampling(garment, body)
    (ours, theirs), more = _comparable(garment, body)
    notes += more
    together = _Together(garment, body, ours, theirs, same_start)
    together.refuse()
    kept, near = together.pairs
    if len(kept) < max(len(ours), len(theirs)) or same_start:
        notes = (*notes, f"frames: {len(kept)} that both have, from {_span(garment, ours[kept])}; {together.spans}")
    counted = garment.counted and body.counted
    rate = None if counted or len(kept) < 2 else float(round(1 / together.common, 3))
    pair = _only(garment, kept, rate), _only(body, near, rate)
    if fps is None or counted or not (garment.counted or body.counted):
        fps, more = _of_samples(pair[0], fps)
    else:
        fps, more = rate or fps, ()
    return Paired(*pair, fps, notes + more)


def by_number(mesh: MeshSequence) -> tuple[MeshSequence, tuple[str, ...]]:
    """The mesh with its times as numbers of frames, and a note, where they are whole seconds, which are no rate of
    cloth: some exporters write numbers of frames there."""
    times = mesh.times
    if mesh.counted or not are_numbers(times):
        return mesh, ()
    note = f"frames: the times of {mesh.where} are whole numbers, taken as numbers of frames"
    return replace(mesh, times=times.round(), counted=True, fps=None), (note,)


def moves_alike(garment: np.ndarray, body: np.ndarray) -> bool:
    """Does the middle of a garment stay where it is beside the middle of its body, frames of shape (T, V, 3)? If not,
    these are not the same frames."""
    chosen = np.unique(np.linspace(0, min(len(garment), len(body)) - 1, _LOOKED_AT).astype(int))
    with np.errstate(all="ignore"):
        middles = [
            np.array([(x[t].max(axis=0).astype(np.float64) + x[t].min(axis=0)) / 2 for t in chosen])
            for x in (garment, body)
        ]
        apart = middles[0] - middles[1]
        drift = np.linalg.norm(apart - apart[0], axis=1).max()
        size = np.ptp(np.asarray(body[0], np.float64), axis=0).max()
    return bool(drift < _DRIFT * size)


@dataclass(frozen=True)
class _Together:
    """Which frames of a garment are at times of its body.

    Attributes:
        garment, body: As they were read.
        ours, theirs: Times of both, comparable, shapes (T,) and (S,).
        same_start: Counted from the first of each.
    """

    garment: MeshSequence
    body: MeshSequence
    ours: np.ndarray
    theirs: np.ndarray
    same_start: bool

    @cached_property
    def pairs(self) -> tuple[np.ndarray, np.ndarray]:
        """Frames of the garment, and of the body, that are at the same times."""
        ours, theirs = self.ours, self.theirs
        if self.same_start:
            ours, theirs = ours - ours[0], theirs - theirs[0]
        step = min(self._steps)
        after = np.clip(np.searchsorted(theirs, ours), 1, max(len(theirs) - 1, 1))
        last = len(theirs) - 1
        nearer = np.abs(theirs[after - 1] - ours) <= np.abs(theirs[np.minimum(after, last)] - ours)
        near = np.minimum(np.where(nearer, after - 1, after), last)
        kept = np.flatnonzero(np.abs(theirs[near] - ours) <= (_SAME * step if np.isfinite(step) else 1e-6))
        return kept, near[kept]

    @property
    def kept(self) -> np.ndarray:
        """Frames of the garment that the body has, too."""
        return self.pairs[0]

    @cached_property
    def _steps(self) -> list[float]:
        return [float(np.median(np.diff(t))) if len(t) > 1 else np.inf for t in (self.ours, self.theirs)]

    @cached_property
    def common(self) -> float:
        """Time between frames that both have."""
        return float(np.median(np.diff(self.ours[self.kept]))) if len(self.kept) > 1 else max(self._steps)

    @property
    def spans(self) -> str:
        body = _span(self.body, self.theirs)
        return f"the garment's frames are from {_span(self.garment, self.ours)}, the body's from {body}"

    @property
    def fault(self) -> str:
        """Why they can't be paired; "" if they can."""
        count, common = len(self.kept), self.common
        if not count or (count == 1 and min(len(self.ours), len(self.theirs)) > 1):
            return f"{'only one' if count else 'no'} frame in common: {self.spans}"
        coarser = max((s for s in self._steps if np.isfinite(s)), default=np.inf)
        if count > 1 and (common > 1.01 * coarser or np.ptp(np.diff(self.ours[self.kept])) > 0.5 * common):
            return f"the rates don't fit together: {self.spans}, of which both have {count}"
        return ""

    def refuse(self) -> None:
        """Raises `UserError` where there is a fault; --same-start is advised only where it brings both together."""
        fault = self.fault
        if not fault:
            return
        do = "export both over the same frames and at the same rate"
        begun = replace(self, same_start=True)
        if not self.same_start and not begun.fault:
            kept, near = begun.pairs
            if moves_alike(self.garment.frames[kept], self.body.frames[near]):
                do += f", or give --same-start, which pairs {len(kept)} frames, if both begin at the same moment"
        raise refusal(self.garment.where, fault, do)


def _of_samples(mesh: MeshSequence, fps: float | None) -> tuple[float | None, tuple[str, ...]]:
    """Frames a second of what a file holds, of those of the numbers that it gives its frames; and a note.

    Raises `UsageError` where that is no rate.
    """
    if fps is None or not mesh.counted or mesh.times is None or len(mesh.times) < 2:
        return fps, ()
    every = float(np.median(np.diff(mesh.times)))
    if abs(every - 1) < 1e-3 or every <= 0:
        return fps, ()
    rate = fps / every
    said = f"--fps {fps:g} is of the frames that {mesh.where} numbers, of which it has one every {every:g}"
    if not 1 <= rate <= 1000:
        raise UsageError(f"{said}: {rate:.3g} a second, wanted 1 to 1000; give the --fps of these numbers")
    slow = " (slow for cloth: is --fps that of the numbers?)" if rate < SLOWEST else ""
    return rate, (f"frames: {said}: {rate:.4g} a second{slow}",)


def _refuse_other_rate(garment: MeshSequence, body: MeshSequence, fps: float | None) -> None:
    """--fps mends a rate that both files state wrongly; where they state different ones, or one does, it would part
    them."""
    if fps is None or (garment.counted and body.counted):
        return
    if garment.counted or body.counted:
        timed, counted = (body, garment) if garment.counted else (garment, body)
        if timed.fps is not None and abs(timed.fps / fps - 1) > _SAME_RATE:
            raise UserError(
                f"--fps is {fps:g}, but {timed.where} states {timed.fps:g} frames a second; leave --fps out: "
                f"{counted.where} is then taken at that rate too"
            )
    elif garment.fps is not None and body.fps is not None and abs(garment.fps / body.fps - 1) > _SAME_RATE:
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


def _comparable(garment: MeshSequence, body: MeshSequence) -> tuple[tuple[np.ndarray, np.ndarray], tuple[str, ...]]:
    """Times of both in one unit, and notes. Frames are counted from 0 by some formats, and from 1 by others."""
    if garment.counted == body.counted:
        ours, theirs = garment.required_times, body.required_times
        step = 1.0 if garment.counted else 1 / (garment.fps or np.inf)
        if _formats(garment) != _formats(body) and _one_apart(ours, theirs, step):
            note = f"frames: {' and '.join(sorted(_formats(garment) | _formats(body)))} count from 0 or 1"
            return (ours - ours[0], theirs - theirs[0]), (f"{note}; taken to begin together",)
        return (ours, theirs), ()
    timed, counted = (body, garment) if garment.counted else (garment, body)
    rate = counted.fps or timed.fps
    if not rate:
        return (garment.required_times - garment.required_times[0], body.required_times - body.required_times[0]), ()
    seconds = counted.required_times / rate
    notes = () if counted.fps else (f"fps: {counted.where} says no rate: {rate:g} a second, as {timed.where} says",)
    if abs(seconds[0] - timed.required_times[0]) * rate <= _ONE_FRAME:
        seconds = seconds - seconds[0] + timed.required_times[0]
        notes += ("frames: one file counts them, the other has times; taken to begin together",)
    else:
        notes += (f"frames: the numbers of {counted.where} are taken as times at {rate:g} a second, from 0 on",)
    return ((seconds, body.required_times) if garment.counted else (garment.required_times, seconds)), notes


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
