"""Methods as outsiders might write them, each wrong in one way. Named on the command line as foreign_methods:Class."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

BAD_FRAME = 7


@dataclass(frozen=True)
class Config:
    """Nothing to choose."""


class Good:
    """Holds the last frame still."""

    name = "good"
    random = False
    Config = Config

    @classmethod
    def fit(cls, train, config, run):
        return cls()

    def save(self, folder: Path) -> None:
        (folder / "good.json").write_text(json.dumps({}))

    @classmethod
    def load(cls, folder: Path):
        return cls()

    def begin(self, template, history):
        return 3, history.garments[-1]  # the frame that comes next

    def step(self, state, body):
        frame, last = state
        return self.output(frame, last), (frame + 1, last)

    def output(self, frame: int, last: np.ndarray) -> np.ndarray:
        return last


class Raises(Good):
    def output(self, frame, last):
        if frame == BAD_FRAME:
            raise ZeroDivisionError("seventh frame")
        return last


class WrongShape(Good):
    def output(self, frame, last):
        return last[:-1] if frame == BAD_FRAME else last


class NaN(Good):
    def output(self, frame, last):
        return last * np.nan if frame == BAD_FRAME else last


class FitRaises(Good):
    @classmethod
    def fit(cls, train, config, run):
        raise ZeroDivisionError("no data")


class FitInterrupted(Good):
    @classmethod
    def fit(cls, train, config, run):
        if (run.folder / "checkpoint").exists():
            return cls()
        (run.folder / "checkpoint").write_text("1")
        raise KeyboardInterrupt


class Forgets(Good):
    """Reads back less than it wrote."""

    def __init__(self, offset: float = 0.0) -> None:
        self.offset = np.float32(offset)

    @classmethod
    def fit(cls, train, config, run):
        return cls(0.01)

    def output(self, frame, last):
        return last + self.offset


class HidesState(Good):
    """Keeps the last frame in itself."""

    def begin(self, template, history):
        self.last = history.garments[-1]
        return 3, self.last

    def output(self, frame, last):
        return self.last


class Random(Good):
    def output(self, frame, last):
        return last + np.random.default_rng().normal(scale=1e-3, size=last.shape).astype(np.float32)


class Writes(Good):
    def output(self, frame, last):
        last += np.float32(0.001)
        return last.copy()


class Nameless(Good):
    name = None
    step = None
