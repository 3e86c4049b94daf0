"""The stress ladder: rungs that leave what the methods were trained on, for simulators and methods alike.

The methods are those of the main table, trained once, on nothing of all this.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from garmentbench.evals.experiment import Experiment, Work, about, failed_row, first_failure
from garmentbench.evals.stability.course import UNSTRESSED, Course, Rung
from garmentbench.evals.stability.rungs import FIRST_LOOK, PLAIN, RUNGS, SHORT, chosen
from garmentbench.evals.trial import FULL, TUNED, Entry, Trial, sequence_job, trial_jobs
from garmentbench.evaluation.results import Row
from garmentbench.evaluation.rollout import BROKEN, DIVERGED, FAILED, OK
from garmentbench.pipeline.choice import choose_method
from garmentbench.report.lines import REFERENCE
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.storage.jobs import Job
from garmentbench.storage.runs import RunStore

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section

PAIR = 2  # starts
TRAIN = "tshirt-armspace-75"
XPBD = "xpbd"
METHODS = (Entry("skinning"), Entry("linear_subspace"), Entry("linear_memory"), TUNED, FULL)
WORST = (FAILED, DIVERGED, BROKEN, OK)  # of several starts' endings the first stands for all
FRAME_SECONDS = 0.1  # rough, of a simulated frame


@dataclass(frozen=True, kw_only=True)
class Ladder(Experiment):
    """A ladder.

    Attributes:
        rungs: From the lowest.
        starts: Of each rung, at most.
        first_look: The names of the rungs where sequences are cut short, which are then climbed from one pair of
            starts; None where all are, from all.
    """

    rungs: tuple[Rung, ...]
    starts: int
    first_look: tuple[str, ...] | None = None

    def work(self, preset: Preset, seeds: int) -> Work:
        """Its jobs and rows. Methods are trained once, however many seeds there are: what is repeated is the start."""
        if self.first_look is not None and preset.mesh.frame_limit is not None:
            short = replace(self, rungs=chosen(self.first_look), starts=PAIR, first_look=None)
            return short.work(preset, seeds)
        trials, jobs = [_trial(entry, preset) for entry in METHODS], {}
        for trial in trials:
            training, _ = trial_jobs(trial, trials, preset)
            jobs |= {job.key: job for job in (sequence_job(trial.train[0], preset), training)}
        for rung in self.rungs:
            for course in _courses(rung):
                job = self._course_job(course, rung, preset)
                jobs.setdefault(job.key, job)  # named after the first rung that has it
            jobs |= {job.key: job for job in self._line_jobs(rung, trials, preset)}

        def rows(results: dict) -> list[Row]:
            return [row for rung in self.rungs for row in self._rung_rows(rung, trials, preset, results)]

        return Work(jobs, rows)

    def _count(self, rung: Rung) -> int:
        return min(self.starts, rung.starts)

    def _course_job(self, course: Course, rung: Rung, preset: Preset) -> Job:
        count = self._count(rung)
        cost = FRAME_SECONDS * count * course.steps(preset)
        return Job(_course(course, count), f"simulate {rung.title}", _simulate, (), (course, count, preset), cost)

    def _line_jobs(self, rung: Rung, trials: list[Trial], preset: Preset) -> Iterator[Job]:
        on, count = _courses(rung), self._count(rung)
        needs = tuple(_course(course, count) for course in on)
        cost = FRAME_SECONDS * count * rung.course.frames(preset)
        if rung.precision is None:
            for method in (REFERENCE, XPBD):
                label, arguments = f"{method} on {rung.title}", (method, on, rung.step, preset)
                yield Job(_line(rung, method, count), label, _simulator_line, needs, arguments, cost)
        for trial in trials:
            method = trial.choice.name
            label, arguments = f"{method} on {rung.title}", (on, rung.precision, preset)
            yield Job(_line(rung, method, count), label, _method_line, (trial.trained, *needs), arguments, cost / 2)

    def _rung_rows(self, rung: Rung, trials: list[Trial], preset: Preset, results: dict[tuple, Any]) -> Iterator[Row]:
        """A row a line and quantity, in whose horizon stand the frames that were predicted."""
        plain, count = load_scene(trials[0].test.name), self._count(rung)
        named = replace(plain, name=rung.name, body=rung.course.body)
        lines: list[tuple[str, Row, tuple]] = [
            (method, about(self.table, preset, named, method), ())
            for method in ((REFERENCE, XPBD) if rung.precision is None else ())
        ]
        for trial in trials:
            learned = {"train_frames": trial.train_frames(preset), "train_scenes": trial.train_scenes}
            method = trial.choice.name
            lines.append((method, about(self.table, preset, named, method, **learned), (trial.trained,)))
        for method, columns, needs in lines:
            key = _line(rung, method, count)
            keys = (*needs, *(_course(course, count) for course in _courses(rung)), key)
            failure = first_failure(*(results[k] for k in keys))
            if failure:
                yield replace(failed_row(columns, failure, "passed"), unit="1")
            elif results[key] is not None:
                run = RunStore().get(results[key])
                yield from line_rows(run.results, replace(columns, run_id=run.id))

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.evals.stability.sections import ladder_sections

        return ladder_sections(results, self.table, self.title)


STABILITY = Ladder(
    name="stability", table="stability", title="Stress ladder", rungs=chosen(SHORT), starts=3, first_look=FIRST_LOOK
)
WHOLE = Ladder(
    name="stability-whole",
    table="stability_whole",
    title="Stress ladder, every rung",
    rungs=RUNGS,
    starts=10,
    on_request=True,  # hours
)


def line_rows(found: dict[str, Any], columns: Row) -> list[Row]:
    """The rows of a line: how many starts it passed, and the worst of what was measured.

    Args:
        found: The results of its run.
        columns: What they are about.
    """
    starts = found["starts"]
    bad = [start["first_bad_frame"] for start in starts if start["first_bad_frame"] is not None]
    ended = {start["status"] for start in starts}
    columns = replace(
        columns,
        horizon=starts[0]["frames"],
        status=next(status for status in WORST if status in ended),
        first_bad_frame=min(bad, default=None),
    )
    passed = sum(start["status"] == OK for start in starts)
    values: dict[str, tuple[float | None, str]] = {
        "passed": (passed, "1"),
        "starts": (len(starts), "1"),
        "strain_p99_max": (_largest(starts, "strain"), "%"),
        "inside_max": (_largest(starts, "inside"), "%"),
        "energy_max": (_largest(starts, "energy"), "1"),
        "energy_left": (_largest(starts, "energy_left"), "%"),
        "change": (_largest(starts, "changed"), "cm"),
        "growth_rate": (found["growth"], "1/s"),
    }
    return [
        replace(columns, metric=name, value=float(value), unit=unit)
        for name, (value, unit) in values.items()
        if value is not None
    ]


def _largest(starts: list[dict[str, Any]], key: str) -> float | None:
    return max((start[key] for start in starts if start[key] is not None), default=None)


def _trial(entry: Entry, preset: Preset) -> Trial:
    choice = choose_method(entry.method, entry.variant, preset)
    return Trial(entry, choice, (load_scene(TRAIN),), 0, load_scene(UNSTRESSED))


def _courses(rung: Rung) -> list[Course]:
    """What a rung climbs, and what it should end as."""
    return [rung.course, PLAIN] if rung.unmoved else [rung.course]


def _course(course: Course, starts: int) -> tuple:
    return ("course", course, starts)


def _line(rung: Rung, method: str, starts: int) -> tuple:
    return ("climb", rung.name, method, starts)


def _simulate(course: Course, starts: int, preset: Preset) -> Any:
    from garmentbench.evals.stability.line import course_runs

    return course_runs(course, starts, preset)


def _simulator_line(*inputs: Any) -> Any:
    from garmentbench.evals.stability.line import reference_line, xpbd_line

    *courses, method, on, step, preset = inputs
    return (reference_line if method == REFERENCE else xpbd_line)(courses, on, step, preset)


def _method_line(trained: str, *inputs: Any) -> Any:
    from garmentbench.evals.stability.line import method_line

    *courses, on, precision, preset = inputs
    return method_line(trained, courses, on, precision, preset)
