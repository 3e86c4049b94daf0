"""The checks of a method: what each asks, on a tiny scene where the method is tried. `check_method` runs them."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from garmentbench import progress
from garmentbench.errors import FOREIGN, UserError, described
from garmentbench.evaluation.rollout import RETURN_A_PAIR, NoPairError, positions_and_state
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.method import HISTORY, BodyFrame, History, Method
from garmentbench.sequence import GARMENT, HUMAN, OBJECT, Sequence
from garmentbench.storage.runs import RunStore

if TYPE_CHECKING:
    pass

FRAMES = 20
CUT = 12  # frames after it are scrambled, to see whether the output up to it changes
SCENES: dict[str, str | None] = {HUMAN: HUMAN, OBJECT: OBJECT, GARMENT: GARMENT, "bodiless": None}


class CheckFailedError(AssertionError):
    """A check found something. `problem` says what, and what to do about it."""

    def __init__(self, what: str, do: str) -> None:
        super().__init__(f"{what}; {do}")
        self.what, self.do = what, do


class CheckSkippedError(Exception):
    """A check says nothing here, for the reason given."""


@dataclass(frozen=True)
class Trace:
    """What a method returned, frame by frame from the fourth on, as it was, and what it raised, if anything."""

    outputs: list[Any]
    error: BaseException | None = None

    def same(self, other: "Trace", frames: int | None = None) -> bool:
        """Are the outputs of both equal (the first `frames` of them)?"""
        mine, its = self.outputs[:frames], other.outputs[:frames]
        return len(mine) == len(its) and all(
            np.array_equal(a, b, equal_nan=_is_float(a)) for a, b in zip(mine, its, strict=False)
        )


def _is_float(value: Any) -> bool:
    return np.asarray(value).dtype.kind == "f"


@dataclass
class Trial:
    """A method on one scene: fitted once, on demand, for all checks.

    Attributes:
        method: The class.
        config: Its configuration, the smaller the better.
        scene: One of `SCENES`.
        folder: Where it is trained and saved.
    """

    method: type[Method]
    config: Any
    scene: str
    folder: Path
    _fits: int = field(default=0, init=False)

    def sequence(self, phase: float) -> Sequence:
        """The tiny sequence of the scene; another phase is another motion."""
        return tiny_sequence(FRAMES, SCENES[self.scene], phase=phase)

    @cached_property
    def train(self) -> Sequence:
        return self.sequence(0.0)

    def fit(self, *train: Sequence) -> Method:
        """Fit anew. Raises whatever the method raises."""
        self._fits += 1
        with RunStore(self.folder).open("check", {"scene": self.scene, "fit": self._fits, "seed": 0}) as run:
            return self.method.fit(train, self.config, run)

    @cached_property
    def fitted(self) -> Method | BaseException:
        """The method fitted on `train`, or what it raised."""
        try:
            return self.fit(self.train)
        except FOREIGN as e:  # a method may raise anything
            return e

    @property
    def trained(self) -> Method:
        """The fitted method. Skips the check where there is none, which `check_fit` reports."""
        if isinstance(self.fitted, BaseException):
            raise CheckSkippedError("fit refused the scene" if isinstance(self.fitted, UserError) else "fit raised")
        return self.fitted

    @cached_property
    def trace(self) -> Trace:
        """A roll-out."""
        return replay(self.trained, self.sequence(1.0))

    @property
    def outputs(self) -> list[Any]:
        """What `trace` returned. Skips the check where it raised at once, which `check_begin_and_step_run` reports."""
        if self.trace.error is not None and not self.trace.outputs:
            raise CheckSkippedError("roll-outs raise")
        return self.trace.outputs

    @cached_property
    def repeated(self) -> Trace:
        """The same roll-out, once more."""
        return replay(self.trained, self.sequence(1.0))

    @property
    def steady_trace(self) -> Trace:
        """`trace`, for comparisons. Skips the check where it is empty or a repetition differs; both have own checks."""
        _ = self.outputs
        if not self.trace.same(self.repeated):
            raise CheckSkippedError("its roll-outs differ anyhow")
        return self.trace

    def raised(self, error: BaseException) -> str:
        return f"raised {described(error, self.method)}"


def replay(method: Method, sequence: Sequence, arrays: "list[np.ndarray] | None" = None) -> Trace:
    """A roll-out that keeps outputs as they are. All that the method is handed is appended to `arrays`, if given."""
    outputs: list[Any] = []
    handed = [] if arrays is None else arrays
    label = f"roll-out of {getattr(method, 'name', 'the method')}"
    try:
        with progress.track(len(sequence) - HISTORY, label) as advance:
            state = method.begin(sequence.template, _handed(_history(sequence), handed))
            for t in range(HISTORY, len(sequence)):
                output, state = positions_and_state(method.step(state, _handed(_body(sequence, t), handed)))
                outputs.append(np.array(output))
                advance()
    except FOREIGN as e:  # a method may raise anything
        return Trace(outputs, e)
    return Trace(outputs)


def _history(sequence: Sequence, frame: int = HISTORY) -> History:
    past = History.before(sequence, frame)
    return History(past.garments.copy(), None if past.bodies is None else past.bodies.copy())


def _body(sequence: Sequence, frame: int) -> BodyFrame:
    return BodyFrame(None if sequence.body is None else sequence.body[frame].copy())


def _handed(value: Any, arrays: list[np.ndarray]) -> Any:
    arrays += [array for array in vars(value).values() if array is not None]
    return value


# The checks. Each is given a trial, returns where all is well, and raises `CheckFailedError` where it is not.


def check_fit(trial: Trial) -> None:
    """`fit` trains on one sequence. It may refuse a scene by a `UserError`, but not the one with a human body."""
    error = trial.fitted
    if isinstance(error, UserError):
        if trial.scene != HUMAN:
            raise CheckSkippedError(f"refused: {error}")
        raise CheckFailedError(f"fit refuses a human body: {error}", "accept it")
    if isinstance(error, BaseException):
        do = f"try it with garmentbench.tiny_sequence({FRAMES}, {SCENES[trial.scene]!r})"
        raise CheckFailedError(f"fit {trial.raised(error)}", do)


def check_fit_on_several_sequences(trial: Trial) -> None:
    """`fit` takes more than one sequence."""
    _ = trial.trained
    try:
        trial.fit(trial.sequence(0.0), trial.sequence(2.0))
    except FOREIGN as e:  # a method may raise anything
        do = "train on all of them, without a step from one into the next"
        raise CheckFailedError(f"fit on two sequences {trial.raised(e)}", do) from e


def check_fit_leaves_sequences_alone(trial: Trial) -> None:
    """`fit` does not write into the sequences that it is given."""
    _ = trial.trained
    if not _same_arrays(trial.train, trial.sequence(0.0)):
        raise CheckFailedError("fit writes into the training sequence", "work on a copy")


def check_begin_and_step_run(trial: Trial) -> None:
    """`begin` and `step` raise nothing."""
    error = trial.trace.error
    if isinstance(error, UserError) and not trial.trace.outputs and trial.scene != HUMAN:
        raise CheckSkippedError(f"refused: {error}")
    if error is not None:
        frame = HISTORY + len(trial.trace.outputs)
        if isinstance(error, NoPairError):
            raise CheckFailedError(f"at frame {frame} step returned {error.found}", RETURN_A_PAIR)
        raise CheckFailedError(f"at frame {frame} it {trial.raised(error)}", "mend it")


def check_begin_at_any_frame(trial: Trial) -> None:
    """Single steps begin anew at every frame, also late in a sequence."""
    sequence = trial.sequence(1.0)
    method = trial.trained
    if trial.trace.error is not None:
        raise CheckSkippedError("roll-outs raise")
    for t in (HISTORY + 1, FRAMES - 1):
        try:
            method.step(method.begin(sequence.template, _history(sequence, t)), _body(sequence, t))
        except FOREIGN as e:  # a method may raise anything
            raise CheckFailedError(f"begun at frame {t} it {trial.raised(e)}", "let begin start anywhere") from e


def check_output_shape(trial: Trial) -> None:
    """`step` returns one position a vertex, as floats."""
    wanted = trial.train.garment.shape[1:]
    for t, output in enumerate(trial.outputs, HISTORY):
        if output.shape != wanted or output.dtype.kind != "f":
            found = f"{output.dtype} of shape {output.shape}"
            raise CheckFailedError(f"at frame {t} step returned {found}", f"return floats of shape {wanted}")


def check_output_is_finite(trial: Trial) -> None:
    """`step` returns no NaN and no infinity."""
    for t, output in enumerate(trial.outputs, HISTORY):
        if output.dtype.kind == "f" and not np.isfinite(output).all():
            vertices = int((~np.isfinite(output)).reshape(len(output), -1).any(axis=1).sum())
            raise CheckFailedError(f"at frame {t}, {vertices} of {len(output)} vertices are not finite", "mend it")


def check_inputs_are_left_alone(trial: Trial) -> None:
    """`begin` and `step` do not write into the history or the body."""
    test, arrays = trial.sequence(1.0), []
    replay(trial.trained, test, arrays)
    bodies = [] if test.body is None else [test.body[:HISTORY], *test.body[HISTORY:]]
    if not all(np.array_equal(a, b) for a, b in zip(arrays, [test.garment[:HISTORY], *bodies], strict=False)):
        raise CheckFailedError("begin or step writes into the history or the body that it is given", "work on a copy")


def check_second_run_is_the_same(trial: Trial) -> None:
    """A roll-out repeated gives the same garments."""
    _ = trial.outputs
    if not trial.trace.same(trial.repeated):
        do = "keep what changes in the state that begin and step pass on, and seed what is random"
        raise CheckFailedError("the same roll-out, twice, gives different garments", do)


def check_roll_outs_do_not_disturb_each_other(trial: Trial) -> None:
    """State lies in what `begin` and `step` pass on, not in self."""
    sequence, method, outputs = trial.sequence(1.0), trial.trained, []
    if trial.trace.error is not None:
        raise CheckSkippedError("roll-outs raise")
    history = _history(sequence)
    moved = History(history.garments + np.array([0, 0, 0.01], np.float32), history.bodies)
    try:
        states = [method.begin(sequence.template, h) for h in (history, moved)]
        for t in range(HISTORY, FRAMES):
            stepped = [method.step(state, _body(sequence, t)) for state in states]
            outputs.append(np.array(stepped[0][0]))
            states = [state for _, state in stepped]
    except FOREIGN:  # alone it runs through, so fewer outputs say enough
        pass
    if not Trace(outputs).same(trial.steady_trace):
        raise CheckFailedError(
            "two roll-outs in turns disturb each other", "keep what changes in the state, not in self"
        )


def check_save_and_load(trial: Trial) -> None:
    """A method that is saved and loaded predicts the same."""
    folder = trial.folder / f"saved_{trial.scene}"
    folder.mkdir()
    doing = "save"
    try:
        trial.trained.save(folder)
        doing = "load"
        loaded = trial.method.load(folder)
    except FOREIGN as e:  # a method may raise anything
        if isinstance(e, CheckSkippedError):
            raise
        raise CheckFailedError(f"{doing} {trial.raised(e)}", "write in save what load reads") from e
    if not replay(loaded, trial.sequence(1.0)).same(trial.steady_trace):
        raise CheckFailedError("the method read back predicts something else", "save all that step uses")


def check_future_is_not_seen(trial: Trial) -> None:
    """The output at a frame stays the same when bodies and garments after it are scrambled.

    Arrays are scrambled in place, so that a method that has kept hold of them (from `fit`, or by other ways) is caught;
    what a method has learned from a sequence it must keep as a copy.
    """
    _ = trial.steady_trace
    test = trial.sequence(1.0)
    methods = {"roll-out": trial.trained}
    if trial.scene == HUMAN:  # once is enough: it is fitted on the very sequence that it is tested on
        try:
            methods["fit"] = trial.fit(test)
        except FOREIGN as e:  # a method may raise anything
            raise CheckSkippedError("fit on the test sequence raised") from e
    before = {name: replay(method, test) for name, method in methods.items()}
    random = np.random.default_rng(0)
    for array in (test.garment, test.body):
        if array is not None:
            array[CUT + 1 :] = random.permutation(array[CUT + 1 :]) + random.normal(0, 0.1, 3).astype(np.float32)
    for name, method in methods.items():
        if not replay(method, test).same(before[name], CUT + 1 - HISTORY):
            do = "use the body up to the present frame only" + (
                "; copy what fit keeps of a sequence" if name == "fit" else ""
            )
            raise CheckFailedError(f"the output up to frame {CUT} depends on what comes after it", do)


def check_reference_is_not_read(trial: Trial) -> None:
    """`begin` and `step` open no sequence file."""
    with _opened_sequences() as opened:
        replay(trial.trained, trial.sequence(1.0))
    foreign = [path for path in opened if trial.folder not in Path(path).resolve().parents]
    if foreign:
        raise CheckFailedError(f"begin or step opens {foreign[0]}", "keep all that it learned in save and load")


@contextmanager
def _opened_sequences() -> Iterator[list[str]]:
    """Paths of the HDF5 files that are opened in the block, found or not."""
    import h5py

    opened: list[str] = []
    original, watching = h5py.File.__init__, True

    def watched(self: Any, name: Any, *args: Any, **kwargs: Any) -> None:
        opened.append(str(name))
        original(self, name, *args, **kwargs)

    def audit(event: str, arguments: tuple) -> None:
        if watching and event == "open" and str(arguments[0]).endswith((".h5", ".hdf5")):
            opened.append(str(arguments[0]))

    sys.addaudithook(audit)  # can't be taken off again, hence `watching`
    h5py.File.__init__ = watched
    try:
        yield opened
    finally:
        h5py.File.__init__, watching = original, False


def _same_arrays(one: Sequence, other: Sequence) -> bool:
    def arrays(sequence: Sequence) -> list[np.ndarray]:
        template = sequence.template
        parts = (
            *vars(template.garment).values(),
            *vars(template.body or object).values(),
            sequence.garment,
            sequence.body,
        )
        return [part for part in parts if isinstance(part, np.ndarray)]

    return all(np.array_equal(a, b) for a, b in zip(arrays(one), arrays(other), strict=True))


CheckFunction = Callable[[Trial], None]
CHECKS: tuple[CheckFunction, ...] = (
    check_fit,
    check_fit_on_several_sequences,
    check_fit_leaves_sequences_alone,
    check_begin_and_step_run,
    check_begin_at_any_frame,
    check_output_shape,
    check_output_is_finite,
    check_inputs_are_left_alone,
    check_second_run_is_the_same,
    check_roll_outs_do_not_disturb_each_other,
    check_save_and_load,
    check_future_is_not_seen,
    check_reference_is_not_read,
)
ONCE = (check_fit_on_several_sequences,)  # checks that need a training of their own run on the human scene alone
