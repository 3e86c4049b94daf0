"""The contract of a method, and what it is given.

A method sees the body up to the present frame and its own past output, never a reference garment after `begin`.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from garmentbench.sequence import Sequence, Template

HISTORY = 3  # frames before the first predicted one: positions, from which velocity and acceleration follow


@dataclass(frozen=True)
class BodyFrame:
    """The body at the present frame. vertices: [m], shape (B, 3), float32; None where the scene has no body."""

    vertices: np.ndarray | None


@dataclass(frozen=True)
class History:
    """The last three reference frames before the first predicted one, oldest first.

    garments: [m], shape (3, V, 3).   bodies: [m], shape (3, B, 3), or None where the scene has no body.
    """

    garments: np.ndarray
    bodies: np.ndarray | None

    @classmethod
    def before(cls, sequence: Sequence, frame: int) -> "History":
        """The history of predicting `frame` (at least 3)."""
        past = slice(frame - HISTORY, frame)
        return cls(sequence.garment[past], None if sequence.body is None else sequence.body[past])


class FitRun(Protocol):
    """What `fit` may use of the run that it trains in (see `garmentbench.runs.Run`).

    folder: Where checkpoints go (atomically: write to a temporary name, rename).
    seed: Random seed of this run.
    """

    folder: Path
    seed: int

    def log(self, step: int, **values: float) -> None:
        """Append a line to metrics.jsonl."""

    def track(self, total: int, label: str, done: int = 0) -> Any:
        """A progress bar as a context manager; call the value it gives once per step done."""

    def stage(self, name: str, identity: dict) -> "FitRun":
        """A sub-run shared by all runs whose `identity` (plain JSON, all that decides the result) is the same.

        It has a `finished` flag and a `finish()`; callers skip the work when it is finished already.
        """


class Method(Protocol):
    """A trained method. Class attribute `name` as in the tables; `Config` is a frozen dataclass.

    A method may leave the garment before its collision stage in `state.before_collision` (shape (V, 3)), and may mark
    parts of its time with `garmentbench.clock.span("prepare" | "predict" | "collide")`.
    """

    name: str
    Config: type

    @classmethod
    def fit(cls, train: Sequence, config: Any, run: FitRun) -> "Method":
        """Train on a sequence. `config` is an instance of `Config`."""

    def save(self, folder: Path) -> None:
        """Write what `load` needs into an existing folder: arrays and JSON, no code."""

    @classmethod
    def load(cls, folder: Path) -> "Method":
        """Read a trained method back, as data only."""

    def begin(self, template: Template, history: History) -> Any:
        """State before the first predicted frame. `template` may be another body's than in training."""

    def step(self, state: Any, body: BodyFrame) -> tuple[np.ndarray, Any]:
        """Garment vertices [m], shape (V, 3), at the frame of `body`, and the new state."""
