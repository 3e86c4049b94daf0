"""Methods trained on some scenes and tested on others: most experiments are this."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from garmentbench.errors import UsageError
from garmentbench.evals.accuracy_table import accuracy_table
from garmentbench.evals.experiment import Experiment, Work, about, failed_row, first_failure, named
from garmentbench.evals.trial import (
    SIMPLE,
    STRONG,
    TRAIN_FRAMES,
    Entry,
    Trial,
    another_run_job,
    sequence_job,
    trial_jobs,
)
from garmentbench.evaluation.another_run import ANOTHER_RUN
from garmentbench.evaluation.results import Row
from garmentbench.methods import method_names
from garmentbench.pipeline.choice import MethodChoice, choose_method, load_method
from garmentbench.reference import Source, resolve_source
from garmentbench.report.card import frame_count
from garmentbench.report.lines import SIMULATED, Line, label, order
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.training_sets import expanded
from garmentbench.storage.jobs import Failure
from garmentbench.storage.runs import Run, RunStore

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Picture, Section

FRAMES = (
    "Error of the free roll-out in each frame (thin) and over 30 frames (thick). A cross: it diverged or failed there."
)
TIME = (
    "Error of the whole roll-out against time a frame. Lower left is better; inside the shaded band, differences mean "
    "nothing."
)
STRIP = (
    "Frames of the roll-outs: the reference above, below it what each method (first seed) made of it, coloured by its "
    "error."
)


@dataclass(frozen=True, kw_only=True)
class Comparison(Experiment):
    """Entries trained on some scenes and tested on others; a line of the table is computed once, whoever shares it.

    Attributes:
        train: The training scenes, sequence files, or a garment's training sets ("dress@varied").
        tests: The test scenes or files, a table each.
        entries: The lines.
    """

    train: tuple[str, ...]
    tests: tuple[str, ...]
    entries: tuple[Entry, ...]

    def trials(self, preset: Preset, seeds: int) -> list[Trial]:
        """Every entry and seed on every test. Raises `UserError` for what doesn't exist or goes together."""
        scenes, lengths = expanded(self.train)
        train, tests = (tuple(resolve_source(name) for name in names) for names in (scenes, self.tests))
        choices = {entry: choose_method(entry.method, entry.variant, preset) for entry in self.entries}
        self._require_names_of_their_own(choices)
        self._require_frames(train)
        return [
            Trial(entry, choice, train, seed, test, lengths)
            for test in tests
            for entry, choice in choices.items()
            for seed in range(seeds if choice.random else 1)
        ]

    def work(self, preset: Preset, seeds: int) -> Work:
        trials = self.trials(preset, seeds)
        tests = {trial.test.name: trial.test for trial in trials}.values()
        scenes = [scene for trial in trials for scene in (*trial.train, trial.test)]
        jobs = {job.key: job for scene in scenes for job in [sequence_job(scene, preset)]}
        jobs |= {job.key: job for trial in trials for job in trial_jobs(trial, trials, preset)}
        jobs |= {job.key: job for test in tests for job in [another_run_job(test, preset)]}

        def rows(results: dict) -> list[Row]:
            simulated = [row for test in tests for row in self.another_run_rows(test, preset, results)]
            return simulated + [row for trial in trials for row in self.trial_rows(trial, preset, results)]

        return Work(jobs, rows)

    def _require_names_of_their_own(self, choices: dict[Entry, MethodChoice]) -> None:
        """Raises `UsageError` where two lines of the tables would have the same name."""
        lines = [(choices[entry].name, entry.label) for entry in self.entries]
        for entry, choice in choices.items():
            name = choice.name
            if lines.count((name, entry.label)) > 1:
                raise UsageError(f"{self.name}: two entries are called '{name}', {entry.label}; wanted different ones")
            if name in SIMULATED:
                raise UsageError(
                    f"{self.name}: {entry.method} calls itself '{name}', as the simulator's line; rename it"
                )
            if name in method_names() and load_method(name) is not choice.method:
                raise UsageError(
                    f"{self.name}: {entry.method} calls itself '{name}', as another method does; rename it"
                )

    def _require_frames(self, train: tuple[Source, ...]) -> None:
        """Raises `UsageError` where an entry's `train_frames`, by which it is called, is more than a sequence has.

        What the preset leaves out doesn't count: there, all are trained on fewer.
        """
        for entry in self.entries:
            for source in train if entry.train_frames != TRAIN_FRAMES else ():
                frames = source.frames if isinstance(source, Scene) else frame_count(source.path)
                if entry.train_frames > frames:
                    raise UsageError(
                        f"{self.name}: train_frames = {entry.train_frames}: {source.name} has {frames} frames; "
                        "wanted at most that"
                    )

    def another_run_rows(self, test: Source, preset: Preset, results: dict[tuple, Any]) -> list[Row]:
        """The rows of the simulator's own spread; none where the reference is a single run, or could not be made."""
        made = results[ANOTHER_RUN, test.name]
        if made is None or isinstance(made, Failure):
            return []
        columns, run = about(self.table, preset, test, ANOTHER_RUN), RunStore().get(made)
        return [named(row, columns, run.id) for row in run.results["rows"]]

    def trial_rows(self, trial: Trial, preset: Preset, results: dict[tuple, Any]) -> list[Row]:
        """The rows of one trial: what its run measured, or that it failed."""
        entry, scene = trial.entry, trial.test
        columns = about(
            self.table,
            preset,
            scene,
            trial.choice.name,
            variant=entry.label,
            train_frames=trial.train_frames(preset),
            seed=trial.seed,
            train_scenes=trial.train_scenes,
        )
        failure = first_failure(*(results[k] for k in (("sequence", scene.name), trial.trained, trial.evaluated)))
        if failure:
            return [failed_row(columns, failure)]
        run = RunStore().get(results[trial.evaluated])
        return [named(row, columns, run.id) for row in self.measured(trial, run, results)]

    def measured(self, trial: Trial, run: Run, results: dict[tuple, Any]) -> list[Row]:
        """The measured part of a trial's rows."""
        return [Row(**row) for row in run.results["rows"]]

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.report.page import Section

        found = results.lines(self.table, self.label, self.order)
        sections = []
        for scene in dict.fromkeys(line.scene for line in found):
            lines = [line for line in found if line.scene == scene]
            table = accuracy_table(lines, self.title)
            sections.append(Section(table, _pictures(table.name, lines, results), lines=lines))
        return sections

    def label(self, line: Line) -> str:
        """A line's name for people; a training set of several scenes is said, since others may stand beside it."""
        named = any(mark in line.train_scenes for mark in "+@")
        several = f" (trained on {line.train_scenes.replace('+', ' + ')})" if named else ""
        return label(line) + several

    def order(self, line: Line) -> tuple:
        """The simple methods first."""
        return order_of_methods(line), *order(line)


def order_of_methods(line: Line) -> int:
    """The simulator's own lines, then the simple and the strong baselines as they are listed, then all others."""
    known = [*SIMULATED, *(entry.method for entry in (*SIMPLE, *STRONG))]
    return known.index(line.method) if line.method in known else len(known)


def _pictures(name: str, lines: list[Line], results: "Results") -> "list[Picture]":
    """Error over frames, error against time and frames of the roll-outs, of the lines that have a run."""
    from garmentbench.report.page import Picture
    from garmentbench.report.plots import error_against_time, error_over_frames
    from garmentbench.report.strips import frame_strip

    ran = [line for line in lines if line.run_ids]
    if not ran:
        return []
    made = [Picture(f"plots/{name}-frames.svg", FRAMES, error_over_frames(ran, results.excerpt))]
    if len({line.method for line in ran}) > 1:
        made.append(Picture(f"plots/{name}-time.svg", TIME, error_against_time(ran)))
    return [*made, Picture(f"strips/{name}.jpg", STRIP, frame_strip(ran, results.excerpt))]
