"""One line of the ladder: a method or a simulator on a rung, from every start. What is finished stays in the store."""

from collections.abc import Callable, Iterator
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from garmentbench.device import device_name, has_cuda, quiet_warp
from garmentbench.evals.stability.course import Course, Precision
from garmentbench.evals.stability.judging import Outcome, judged, largest_energy, whole
from garmentbench.evals.stability.precision import computing, has_network
from garmentbench.evals.stability.simulating import Begun, simulated
from garmentbench.evals.stability.statistics import growth_rate
from garmentbench.evaluation.excerpt import write_excerpt
from garmentbench.evaluation.rollout import FAILED, ROLL_OUT, RollOut, roll_out
from garmentbench.method import HISTORY, PARTS, Method
from garmentbench.metrics.change import change
from garmentbench.metrics.l2 import frame_l2
from garmentbench.pipeline.choice import load_method
from garmentbench.pipeline.shell import foreign_code
from garmentbench.progress import track
from garmentbench.reference import reference_identity
from garmentbench.scenes.presets import Preset
from garmentbench.sequence import Sequence
from garmentbench.storage.atomic import written_whole
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.jobs import Reused
from garmentbench.storage.runs import Run, RunStore

KIND, COURSE = "stability", "course"  # of runs
POSITIONS = "garment.npy"
Garment = Float[np.ndarray, "frames vertices 3"]
Climb = Callable[[Course, Begun, int, Garment], tuple[Garment, str]]  # what was made of a start, and what was raised


def course_runs(course: Course, starts: int, preset: Preset) -> list[str] | Reused:
    """Simulate a course from its starts, unless that is done; the runs' ids. Their folders hold the garment after the
    warm-up [m], shape (T, V, 3)."""
    store, ids, reused = RunStore(), [], True
    for start in range(starts):
        identity = {
            "course": course,
            "start": start,
            "preset": preset.mesh.name,
            "scene": reference_identity(course.scene(start), preset),
            "code": fingerprint("garmentbench.evals.stability.simulating"),
            "device": device_name(),
        }
        with store.open(COURSE, identity) as run:
            ids, reused = [*ids, run.id], reused and run.reused
            if not run.finished:
                quiet_warp()
                with track(course.steps(preset), f"start {start + 1} of {starts}") as tick:
                    garment = simulated(course, start, preset, _device(), tick=tick)
                with written_whole(run.folder / POSITIONS) as partial, partial.open("wb") as file:
                    np.save(file, garment)
                run.finish()
    return Reused(ids) if reused else ids


def reference_line(courses: list[list[str]], on: list[Course], step: int, preset: Preset) -> str | Reused:
    """The reference solver's own line; arguments as for `_line`."""

    def climb(course: Course, begun: Begun, start: int, garment: Garment) -> tuple[Garment, str]:
        return (garment if step == 1 else simulated(course, start, preset, _device(), step=step)), ""

    return _line({"method": "reference", "step": step}, courses, on, preset, climb)


def xpbd_line(courses: list[list[str]], on: list[Course], step: int, preset: Preset) -> str | Reused:
    """XPBD's line; arguments as for `_line`."""

    def climb(course: Course, begun: Begun, start: int, garment: Garment) -> tuple[Garment, str]:
        return simulated(course, start, preset, _device(), xpbd=True, step=step), ""

    return _line({"method": "xpbd", "step": step}, courses, on, preset, climb)


def method_line(
    trained: str, courses: list[list[str]], on: list[Course], precision: Precision | None, preset: Preset
) -> str | Reused | None:
    """The line of a trained method, in that precision; None where one is asked for and it has no network."""
    training = RunStore().get(trained)
    method = load_method(training.identity["class"])
    with foreign_code(training, "load", method):
        learnt: Method = method.load(training.folder / "method")
    if precision is not None and not has_network(learnt):
        return None

    def climb(course: Course, begun: Begun, start: int, garment: Garment) -> tuple[Garment, str]:
        known = np.full_like(garment, np.nan)
        known[:HISTORY] = garment[:HISTORY]
        with computing(learnt, precision):
            roll = roll_out(learnt, Sequence(begun.template, known, begun.bodies))
        return roll.garment, roll.message if roll.status == FAILED else ""

    about = {key: training.identity[key] for key in ("method", "class", "variant", "train_scenes", "seed")}
    precision = None if precision == "float32" else precision  # which they compute in anyway
    identity = about | {"trained": trained, "precision": precision, "of_method": fingerprint(method.__module__)}
    return _line(identity, courses, on, preset, climb)


def _line(
    identity: dict[str, Any], courses: list[list[str]], on: list[Course], preset: Preset, climb: Climb
) -> str | Reused:
    """Climb a course from every start, unless that is done; the run's id.

    Args:
        identity: What decides the result beside the courses.
        courses: Ids of the courses' runs, one a start: of the one that is climbed, and of one that should end alike.
        on: These courses.
        preset: Sizes.
        climb: What is made of a start.

    Its results are the `starts` (see `Outcome`; energy over the reference's, and how far it ended from the course that
    should end alike), `growth` [1/s] (the median of the pairs') and the worst start's `message`.
    """
    code = fingerprint("garmentbench.evals.stability.line")
    identity |= {"courses": courses, "preset": preset.name, "code": code, "device": device_name()}
    with RunStore().open(KIND, identity) as run:
        if not run.finished:
            quiet_warp()
            run.finish(_climbed(run, courses, on, preset, climb))
        return Reused(run.id) if run.reused else run.id


def _climbed(run: Run, courses: list[list[str]], on: list[Course], preset: Preset, climb: Climb) -> dict[str, Any]:
    outcomes: list[Outcome] = []
    made: list[dict[str, Any]] = []
    rates, pair, worst = [], {}, None
    for start, garment, begun, reference, raised in _starts(run, courses[0], on[0], preset, climb):
        outcome = judged(garment, begun.bodies, begun.template, on[0].rest_from, raised)
        calm = largest_energy(reference[: whole(reference, begun.bodies, begun.template)], begun.template)
        energy = outcome.energy / calm if outcome.energy is not None and calm else None
        outcomes.append(replace(outcome, energy=energy))
        made.append(asdict(outcomes[-1]) | {"survived": outcome.survived, "changed": None})
        if worst is None or _badness(outcome) > _badness(worst):
            worst = outcome
            _keep(run, begun, reference, garment, outcome)
        if start - 1 in pair:
            other, survived = pair.pop(start - 1)
            both = slice(HISTORY, HISTORY + min(survived, outcome.survived))
            rates.append(growth_rate(0.01 * frame_l2(garment[both], other[both]), on[0].fps))
        elif start % 2 == 0:
            pair[start] = garment, outcome.survived
        if len(on) > 1:
            made[-1]["changed"] = _changed(run, start, garment, courses[1][start], on, preset, climb)
    known = [rate for rate in rates if rate is not None]
    assert worst is not None, "a line has starts"
    return {"starts": made, "growth": float(np.median(known)) if known else None, "message": worst.message}


def _starts(
    run: Run, ids: list[str], course: Course, preset: Preset, climb: Climb
) -> Iterator[tuple[int, Garment, Begun, Garment, str]]:
    """Each start: its number, what was made of it, what was given, the reference, and what was raised."""
    with run.track(len(ids), "starts") as done:
        for start, name in enumerate(ids):
            begun, reference = Begun.of(course, start, preset), _reference(name)
            garment, raised = climb(course, begun, start, reference)
            yield start, garment, begun, reference, raised
            done()


def _changed(
    run: Run, start: int, garment: Garment, plain: str, on: list[Course], preset: Preset, climb: Climb
) -> float | None:
    """How far it is from what is made of the plain course from that start [cm]; None where one isn't whole."""
    other, _ = climb(on[1], Begun.of(on[1], start, preset), start, _reference(plain))
    moved = change(garment[HISTORY:], other[HISTORY:], on[0].turn, on[0].translate)
    return moved if np.isfinite(moved) else None


def _reference(course_run: str) -> Garment:
    return np.load(RunStore().root / course_run / POSITIONS)


def _badness(outcome: Outcome) -> tuple[bool, int, float]:
    return outcome.first_bad_frame is not None, -outcome.survived, outcome.strain or 0.0


def _keep(run: Run, begun: Begun, reference: Garment, garment: Garment, outcome: Outcome) -> None:
    """Keep what the report draws of a start."""
    shown = []
    for moved in (reference, garment):
        ends = whole(moved, begun.bodies, begun.template)
        shown.append(np.where(np.arange(len(moved))[:, None, None] < ends, moved, np.float32(np.nan)))
    ms = np.full((len(garment), len(PARTS)), np.nan)
    ended = (outcome.status, outcome.first_bad_frame, outcome.message)
    roll = RollOut(ROLL_OUT, HISTORY, shown[1], None, ms, *ended)
    write_excerpt(run.folder, Sequence(begun.template, shown[0], begun.bodies), roll)


def _device() -> str:
    return "cuda:0" if has_cuda() else "cpu"
