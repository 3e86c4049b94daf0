"""Roll-outs: a method runs through a sequence, freely or one step at a time, and whatever it does becomes a value."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from garmentbench.errors import FOREIGN, UserError, described
from garmentbench.method import HISTORY, PARTS, BodyFrame, Clock, History, Method
from garmentbench.sequence import Sequence, Template
from garmentbench.storage import hdf5

ROLL_OUT, ONE_STEP = "roll_out", "one_step"
OK, BROKEN, DIVERGED, FAILED = "ok", "broken", "diverged", "failed"
COMPLETE = (OK, BROKEN)  # it came to its end, and every frame can be measured
SCHEMA = 1
_ARRAYS = ("garment", "before_collision", "ms", "processor_ms", "novelty")
_REMAKE = "evaluate again (garmentbench evaluate)"
_WARM_UP_STEPS = 3
RETURN_A_PAIR = "return (positions, state)"


@dataclass(frozen=True)
class RollOut:
    """What a method made of a sequence.

    Attributes:
        kind: "roll_out" (begun once, runs freely) or "one_step" (begun anew at every frame).
        start: The first predicted frame.
        garment: [m], shape (T, V, 3), float32: the reference before `start`, NaN from the first bad frame on.
        before_collision: The same before the method's collision stage, NaN where there is none; None if it has no such
            stage.
        ms: Milliseconds of each frame's prepare, predict and collide, shape (T, 3); NaN where nothing was timed.
        status: "ok", "broken" (no longer cloth, see `broken`), "diverged" (not finite, or a vertex farther from the
            reference than the body is high), or "failed" (raised, or returned something else than garment vertices).
        first_bad_frame: The frame at which it broke, diverged or failed; None where it did not.
        message: What happened there; empty where all is well.
        processor_ms: Processor time of each frame [ms], shape (T,); None where it was not taken (with a CUDA device).
        novelty: How far each frame is from what the method was trained on, shape (T,), as it says itself (see
            `garmentbench.method`); None where it never does.
    """

    kind: str
    start: int
    garment: Float[np.ndarray, "frames vertices 3"]
    before_collision: Float[np.ndarray, "frames vertices 3"] | None
    ms: Float[np.ndarray, "frames 3"]
    status: str = OK
    first_bad_frame: int | None = None
    message: str = ""
    processor_ms: Float[np.ndarray, " frames"] | None = None
    novelty: Float[np.ndarray, " frames"] | None = None

    def save(self, path: Path) -> None:
        """Write as HDF5, whole or not at all. Raises `UserError` when it can't be written."""
        with hdf5.create(path, "roll-out", SCHEMA) as file:
            hdf5.put(file, "garment", self.garment)
            hdf5.put(file, "ms", self.ms)
            if self.before_collision is not None:
                hdf5.put(file, "before_collision", self.before_collision)
            if self.processor_ms is not None:
                hdf5.put(file, "processor_ms", self.processor_ms)
            if self.novelty is not None:
                hdf5.put(file, "novelty", self.novelty)
            bad = -1 if self.first_bad_frame is None else self.first_bad_frame
            hdf5.put_attributes(
                file, kind=self.kind, start=self.start, status=self.status, first_bad_frame=bad, message=self.message
            )

    @classmethod
    def load(cls, path: Path) -> "RollOut":
        """Read a roll-out. Raises `UserError` for a file that is missing, foreign, damaged or of another schema."""
        with hdf5.opened(path, "roll-out", SCHEMA, _REMAKE) as file:
            arrays = [hdf5.dataset(file, name) for name in _ARRAYS]
            garment, before, ms, processor_ms, novelty = (None if a is None else a[()] for a in arrays)
            kinds = {"kind": str, "start": int, "status": str, "first_bad_frame": int, "message": str}
            values: dict[str, Any] = {name: hdf5.attribute(file, name, kind) for name, kind in kinds.items()}
        if garment is None or ms is None or None in values.values():
            raise UserError(f"{path}: parts of the roll-out are missing; {_REMAKE}")
        if values["first_bad_frame"] < 0:
            values["first_bad_frame"] = None
        return cls(
            garment=garment, before_collision=before, ms=ms, processor_ms=processor_ms, novelty=novelty, **values
        )


def roll_out(method: Method, sequence: Sequence, progress: Callable[[], None] | None = None) -> RollOut:
    """Let a method run freely: it begins once, from three true frames. `progress` is called once a frame."""
    return _run(ROLL_OUT, method, sequence, progress)


def one_step(method: Method, sequence: Sequence, progress: Callable[[], None] | None = None) -> RollOut:
    """Let a method predict each frame from the three true frames before it. `progress` is called once a frame."""
    return _run(ONE_STEP, method, sequence, progress)


class _Bad(Exception):
    """A frame that can't be used: its status and a message."""


class NoPairError(TypeError):
    """`step` returned something else than a pair. `found` says what."""

    def __init__(self, found: str) -> None:
        super().__init__(f"step returned {found}; {RETURN_A_PAIR}")
        self.found = found


def positions_and_state(returned: Any) -> tuple[Any, Any]:
    """What `step` returned, as the pair that it must be. Raises `NoPairError`."""
    if isinstance(returned, tuple | list) and len(returned) == 2:
        return returned[0], returned[1]
    if isinstance(returned, tuple | list):
        raise NoPairError(f"{len(returned)} values")
    raise NoPairError("one array" if hasattr(returned, "shape") else f"a {type(returned).__name__}")


def _run(kind: str, method: Method, sequence: Sequence, progress: Callable[[], None] | None) -> RollOut:
    if len(sequence) <= HISTORY:
        raise UserError(f"the sequence has {len(sequence)} frames; wanted at least {HISTORY + 1}; simulate more")
    garment = np.full_like(sequence.garment, np.nan)
    garment[:HISTORY] = sequence.garment[:HISTORY]
    before, ms = np.full_like(garment, np.nan), np.full((len(sequence), len(PARTS)), np.nan)
    processor_ms, novelty = np.full((2, len(sequence)), np.nan)
    limit = _limit(sequence.template)
    ending: tuple[str, int | None, str] = (OK, None, "")
    frame, state = HISTORY, None
    _warm_up(method, sequence)
    try:
        for frame in range(HISTORY, len(sequence)):
            if kind == ONE_STEP or frame == HISTORY:
                state = method.begin(sequence.template, _history(sequence, frame))
            clock = Clock()
            with clock.running():
                returned = method.step(state, _body(sequence, frame))
            output, state = positions_and_state(returned)
            garment[frame] = _checked(output, sequence.garment[frame], limit)
            ms[frame] = [clock.ms[part] for part in PARTS]
            processor_ms[frame] = np.nan if clock.processor_ms is None else clock.processor_ms
            if getattr(state, "before_collision", None) is not None:
                before[frame] = np.asarray(state.before_collision)
            if kind == ROLL_OUT and (said := getattr(state, "novelty", None)) is not None:
                novelty[frame] = float(said)
            if progress is not None:
                progress()
    except _Bad as e:
        ending = (e.args[0], frame, e.args[1])
    except NoPairError as e:
        ending = (FAILED, frame, str(e))
    except FOREIGN as e:  # a method may raise anything, and its line must stay in the tables
        ending = (FAILED, frame, f"raised {described(e, type(method))}")
    return RollOut(
        kind,
        HISTORY,
        garment,
        before if np.isfinite(before).any() else None,
        ms,
        *ending,
        processor_ms=processor_ms if np.isfinite(processor_ms).any() else None,
        novelty=novelty if np.isfinite(novelty).any() else None,
    )


def _warm_up(method: Method, sequence: Sequence) -> None:
    """A few steps that are not timed: compilers, caches and allocators do their first work here."""
    with suppress(*FOREIGN):  # what a method raises here it raises again where it counts
        state = method.begin(sequence.template, _history(sequence, HISTORY))
        for frame in range(HISTORY, min(HISTORY + _WARM_UP_STEPS, len(sequence))):
            _, state = method.step(state, _body(sequence, frame))


def _history(sequence: Sequence, frame: int) -> History:
    """Copies: a view would let a method reach the whole reference through it, or spoil it."""
    past = History.before(sequence, frame)
    return History(past.garments.copy(), None if past.bodies is None else past.bodies.copy())


def _body(sequence: Sequence, frame: int) -> BodyFrame:
    return BodyFrame(None if sequence.body is None else sequence.body[frame].copy())


def _checked(output: Any, reference: np.ndarray, limit: float) -> np.ndarray:
    """The output as float32, shape (V, 3). Raises `_Bad`."""
    output = np.asarray(output)
    if output.shape != reference.shape or output.dtype.kind != "f":
        found = f"{output.dtype} of shape {output.shape}"
        raise _Bad(FAILED, f"returned {found}; wanted floats of shape {reference.shape}")
    if not np.isfinite(output).all():
        bad = np.flatnonzero(~np.isfinite(output).all(axis=1))
        raise _Bad(DIVERGED, f"{len(bad)} of {len(output)} vertices are not finite, the first is vertex {bad[0]}")
    with np.errstate(over="ignore"):  # an infinite error is beyond the limit, too
        error = float(np.linalg.norm(output - reference, axis=1).max())
    if error > limit:
        raise _Bad(DIVERGED, f"a vertex is {error:.3g} m from the reference, farther than the limit of {limit:.3g} m")
    return output.astype(np.float32)


def _limit(template: Template) -> float:
    """Beyond this error [m] a prediction has diverged: the height of a human body; where there is none, twice the
    garment's size, since a sheet that stands up instead of hanging down is wrong but whole."""
    if template.body is not None and template.needs.body:
        return float(np.ptp(template.body.rest[:, 2]))
    return 2 * float(np.linalg.norm(np.ptp(template.garment.rest, axis=0)))
