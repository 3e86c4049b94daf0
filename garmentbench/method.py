"""The contract of a method, what it is given, and the clock that its steps are timed by.

A method sees the body up to the present frame and its own past output, never a reference garment after `begin`.
"""

import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from jaxtyping import Float

from garmentbench.sequence import Sequence, Template

HISTORY = 3  # frames before the first predicted one: positions, from which velocity and acceleration follow
PARTS = ("prepare", "predict", "collide")  # of a step's time
_current: ContextVar["Clock | None"] = ContextVar("garmentbench_clock", default=None)


@dataclass(frozen=True)
class BodyFrame:
    """The body at the present frame. vertices: [m], shape (B, 3), float32; None where the scene has no body."""

    vertices: Float[np.ndarray, "body 3"] | None


@dataclass(frozen=True)
class History:
    """The last three reference frames before the first predicted one, oldest first.

    garments: [m], shape (3, V, 3).   bodies: [m], shape (3, B, 3), or None where the scene has no body.
    """

    garments: Float[np.ndarray, "history vertices 3"]
    bodies: Float[np.ndarray, "history body 3"] | None

    @classmethod
    def before(cls, sequence: Sequence, frame: int) -> "History":
        """The history of predicting `frame` (at least 3)."""
        past = slice(frame - HISTORY, frame)
        return cls(sequence.garment[past], None if sequence.body is None else sequence.body[past])


class FitRun(Protocol):
    """What `fit` may use of the run that it trains in (see `garmentbench.storage.runs.Run`).

    folder: Where checkpoints go (atomically: write to a temporary name, rename).
    seed: Random seed of this run.
    """

    folder: Path
    seed: int

    def log(self, step: int, **values: float) -> None:
        """Append a line to metrics.jsonl."""
        ...

    def track(self, total: int, label: str, done: int = 0) -> Any:
        """A progress bar as a context manager; call the value it gives once per step done."""
        ...

    def stage(self, name: str, identity: dict) -> "StageRun":
        """A sub-run shared by all runs whose `identity` (plain JSON, all that decides the result) is the same."""
        ...


class StageRun(FitRun, Protocol):
    """A sub-run; callers skip the work when it is `finished` already."""

    @property
    def finished(self) -> bool:
        """Is it complete, from this run or an earlier one?"""
        ...

    def finish(self) -> None:
        """All that belongs to it is in its folder."""
        ...


class Method(Protocol):
    """A trained method.

    A method may leave the garment before its collision stage in `state.before_collision` (shape (V, 3)), and in
    `state.novelty` how far the frame is from what it was trained on (1: as far as all but a hundredth of its training
    frames are from the others), which is asked for after the step and not timed. It may mark parts of its time with
    `garmentbench.method.span("prepare" | "predict" | "collide")`.

    Attributes:
        name: What the method is called in tables, runs and results.csv.
        Config: A frozen dataclass of its settings.

    Optional class attributes: `random` (the seed changes what is learned; true if absent), `any_garment` (a trained
    method predicts other garments than the one it was trained on, too; false if absent), `learns` (false for a rule
    without anything to train; true if absent).
    """

    name: str
    Config: type

    @classmethod
    def fit(cls, train: tuple[Sequence, ...], config: Any, run: FitRun) -> "Method":
        """Train on one or more sequences: several motions, several bodies.

        Args:
            train: At least one. All have the same garment mesh and the same body mesh; rest shapes may differ between
                bodies. No frame of one sequence follows a frame of another.
            config: An instance of `Config`.
            run: Where checkpoints and logs go.
        """
        ...

    def save(self, folder: Path) -> None:
        """Write what `load` needs into an existing folder: arrays and JSON, no code."""
        ...

    @classmethod
    def load(cls, folder: Path) -> "Method":
        """Read a trained method back, as data only."""
        ...

    def begin(self, template: Template, history: History) -> Any:
        """State before the first predicted frame. `template` may be another body's than in training."""
        ...

    def step(self, state: Any, body: BodyFrame) -> tuple[Float[np.ndarray, "vertices 3"], Any]:
        """Garment vertices [m], shape (V, 3), at the frame of `body`, and the new state."""
        ...


class Clock:
    """Where a step's time goes: wall time, batch 1, synchronised on a CUDA device. Time outside any span is
    `predict`'s.

    Attributes:
        ms: Wall time of each part [ms].
        processor_ms: Processor time of the whole step, of all threads [ms]; None with a CUDA device, which is waited
            for.
    """

    def __init__(self) -> None:
        self.ms: dict[str, float] = defaultdict(float)
        self.processor_ms: float | None = None

    @contextmanager
    def running(self) -> Iterator[None]:
        """Time everything inside the block."""
        token, start, begun = _current.set(self), _now(), time.process_time()
        try:
            yield
        finally:
            self.processor_ms = None if _uses_cuda() else 1e3 * (time.process_time() - begun)
            total = 1e3 * (_now() - start)
            _current.reset(token)
            self.ms["predict"] += total - sum(self.ms.values())


@contextmanager
def span(part: str) -> Iterator[None]:
    """Count the block's time as `part` (one of `PARTS`) of the running clock; does nothing when none is running.

    Spans do not nest.
    """
    clock = _current.get()
    if clock is None:
        yield
        return
    start = _now()
    try:
        yield
    finally:
        clock.ms[part] += 1e3 * (_now() - start)


def _now() -> float:
    """Seconds, after all work queued on a CUDA device is done."""
    if _uses_cuda():
        sys.modules["torch"].cuda.synchronize()
    return time.perf_counter()


def _uses_cuda() -> bool:
    """Has the method begun to use a CUDA device? (torch is only asked if the method has loaded it)"""
    torch = sys.modules.get("torch")
    return torch is not None and torch.cuda.is_initialized()
