"""Methods as outsiders might write them, each wrong in one way. Named on the command line as foreign_methods:Class."""

import json
import sys
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from garmentbench import sequence_file
from garmentbench.errors import UserError

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


class KnowsTheAnswer(Good):
    """Takes the answer from the disk: test.h5 in the working folder."""

    def output(self, frame, last):
        return sequence_file.load(Path("test.h5")).garment[frame]


class Waits(Good):
    """Takes wall time without processor time, as a method on a loaded machine does."""

    def output(self, frame, last):
        time.sleep(0.002)
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


class Integers(Good):
    def output(self, frame, last):
        return (1000 * last).astype(int)


class FitWrites(Good):
    """Centres the training sequence in place."""

    @classmethod
    def fit(cls, train, config, run):
        train[0].garment[:] -= train[0].garment.mean(axis=(0, 1))
        return cls()


class FitTakesOne(Good):
    @classmethod
    def fit(cls, train, config, run):
        (_,) = train
        return cls()


class BeginsAtTheStart(Good):
    """Can't begin after the sequence's first tenth of a second."""

    def begin(self, template, history):
        if history.garments[-1][:, 0].mean() > 0.038:
            raise IndexError("too late")
        return super().begin(template, history)


class LoadRaises(Good):
    @classmethod
    def load(cls, folder):
        raise FileNotFoundError("weights.pt")


class LooksAhead(Good):
    """Keeps the sequence that it was trained on, and answers with the next frame's body."""

    def __init__(self, bodies):
        self.bodies = bodies

    @classmethod
    def fit(cls, train, config, run):
        return cls(train[0].garment if train[0].body is None else train[0].body)

    def save(self, folder: Path) -> None:
        np.save(folder / "bodies.npy", self.bodies)

    @classmethod
    def load(cls, folder: Path):
        return cls(np.load(folder / "bodies.npy"))

    def output(self, frame, last):
        return last + self.bodies[min(frame + 1, len(self.bodies) - 1)].mean(axis=0) - self.bodies[2].mean(axis=0)


class LooksAround(Good):
    """Finds the reference in its caller's variables."""

    def step(self, state, body):
        caller = sys._getframe(1)
        frame, last = state
        sequence = caller.f_locals.get("sequence")
        if sequence is None:
            return super().step(state, body)
        return sequence.garment[min(frame + 1, len(sequence) - 1)].copy(), (frame + 1, last)


class ReadsTheReference(Good):
    """Looks for the reference on the disk."""

    def begin(self, template, history):
        with suppress(OSError):
            h5py.File("sequences/smoke/tshirt-armspace-90.h5")
        return super().begin(template, history)


class RefusesObjects(Good):
    @classmethod
    def fit(cls, train, config, run):
        if train[0].template.body is None or train[0].template.body.kind != "human":
            raise UserError("refuses_objects needs a human body; train it on one")
        return cls()


class ForgetsTheState(Good):
    """Returns the positions alone."""

    def step(self, state, body):
        return super().step(state, body)[0]


class FitExits(Good):
    @classmethod
    def fit(cls, train, config, run):
        sys.exit(0)


class LoadExits(Good):
    @classmethod
    def load(cls, folder):
        sys.exit(0)


class BeginExits(Good):
    def begin(self, template, history):
        sys.exit(0)


class StepExits(Good):
    def step(self, state, body):
        sys.exit(0)
