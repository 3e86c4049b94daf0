"""Methods trained on some scenes and tested on others, and the table of their accuracy: most experiments are this."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentbench import pipeline
from garmentbench.errors import UsageError, UserError
from garmentbench.evals.experiment import Experiment, Work, about, failed_row, first_failure, named
from garmentbench.evals.paper_numbers import paper_cell
from garmentbench.evaluation.another_run import ANOTHER_RUN
from garmentbench.evaluation.results import Row
from garmentbench.method import Method
from garmentbench.methods import method_names
from garmentbench.metrics import metric
from garmentbench.metrics.push_growth import PUSH_GROWTH, regime
from garmentbench.motion.timing import WARM_UP
from garmentbench.reference import Source, make_reference, resolve_source, runs_wanted
from garmentbench.report.card import frame_count
from garmentbench.report.cells import ABSENT, best, competing, number, status_cell, value_cell
from garmentbench.report.lines import SIMULATED, Line, Value, label, order
from garmentbench.report.table import Cell, Table
from garmentbench.scenes.material import Material
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.training_sets import expanded
from garmentbench.scenes.training_sets import title as training_title
from garmentbench.storage.jobs import Failure, Job, Reused
from garmentbench.storage.runs import Run, RunStore

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Picture, Section

TRAIN_FRAMES = 300  # the paper's training length, section 6.1
MAIN = (  # the main table's columns after the errors against the first run
    "error",
    "error_over_spread",
    "interpenetration_before",
    "interpenetration",
    "self_intersection",
    "liveliness",
    "jitter",
    "skill",
    "ms_per_frame",
)
FRAMES = (
    "Error of the free roll-out in each frame (thin) and over 30 frames (thick). A cross: it diverged or failed there."
)
PAPER = (
    " The paper does not define its L2; were it a mean over coordinates, it would be half of ours. Its columns show an "
    "order of magnitude."
)
TIME = (
    "Error of the whole roll-out against time a frame. Lower left is better; inside the shaded band, differences mean "
    "nothing."
)
STRIP = (
    "Frames of the roll-outs: the reference above, below it what each method (first seed) made of it, coloured by its "
    "error."
)


@dataclass(frozen=True)
class Entry:
    """One line of a table.

    Attributes:
        method: A method's name, "module:Class", or the class itself.
        variant: "full", or one of the method's `VARIANTS`.
        train_frames: How many frames of each training scene it is trained on, from the first on; of a training set as
            many as that says.
    """

    method: str | type[Method]
    variant: str = "full"
    train_frames: int = TRAIN_FRAMES

    @property
    def label(self) -> str:
        """The variant's name in results.csv: a departure from the paper's training length is a variant too."""
        return self.variant if self.train_frames == TRAIN_FRAMES else f"train_{self.train_frames}"


FULL = Entry("motion_guided")
SIMPLE = tuple(Entry(m) for m in ("skinning", "hold", "constant_velocity", "linear_subspace"))


@dataclass(frozen=True)
class Trial:
    """One line of results to be: an entry and a seed, trained, on a test scene; every name in it resolved."""

    entry: Entry
    choice: pipeline.MethodChoice
    train: tuple[Source, ...]
    seed: int
    test: Source
    lengths: Mapping[str, int] = field(default_factory=dict)

    @property
    def train_scenes(self) -> str:
        return training_title([scene.name for scene in self.train])

    def train_frames(self, preset: Preset) -> int:
        """Frames of each training scene; where a training set says how many, of all together."""
        taken = [preset.mesh.limited(self.lengths.get(scene.name, self.entry.train_frames)) for scene in self.train]
        return sum(taken) if self.lengths else taken[0]

    @property
    def trained(self) -> tuple:
        return ("train", self.train_scenes, self.choice.name, self.entry.label, self.entry.train_frames, self.seed)

    @property
    def evaluated(self) -> tuple:
        return ("evaluate", self.trained, self.test.name)


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
        choices = {entry: pipeline.choose_method(entry.method, entry.variant, preset) for entry in self.entries}
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
        jobs |= {job.key: job for trial in trials for job in _jobs(trial, trials, preset)}
        jobs |= {job.key: job for test in tests for job in [_another_run_job(test, preset)]}

        def rows(results: dict) -> list[Row]:
            simulated = [row for test in tests for row in self.another_run_rows(test, preset, results)]
            return simulated + [row for trial in trials for row in self.trial_rows(trial, preset, results)]

        return Work(jobs, rows)

    def _require_names_of_their_own(self, choices: dict[Entry, pipeline.MethodChoice]) -> None:
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
            if name in method_names() and pipeline.load_method(name) is not choice.method:
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
    """The simulator's own lines, then the simple methods as they are listed, then all others."""
    known = [*SIMULATED, *(entry.method for entry in SIMPLE)]
    return known.index(line.method) if line.method in known else len(known)


def sequence_job(source: Source, preset: Preset) -> Job:
    """Simulating a scene, or finding a file as it is."""
    key, cost = ("sequence", source.name), _seconds(source, preset) if isinstance(source, Scene) else 0.0
    return Job(key, f"simulate {source.name}", _simulate, arguments=(source, preset), cost=cost)


def _seconds(scene: Scene, preset: Preset) -> float:
    """Rough seconds that simulating a scene takes; of an ensemble's runs one has twice the substeps."""
    frames, runs = preset.mesh.limited(scene.frames) + WARM_UP, runs_wanted(scene)
    layers = 1 if scene.worn_over is None else 2
    stiff = math.sqrt(scene.material.stretch / Material().stretch)  # so many times the substeps
    return 0.05 * frames * (runs if runs == 1 else runs + 1) * layers * stiff


def _jobs(trial: Trial, trials: list[Trial], preset: Preset) -> list[Job]:
    """Training and evaluating."""
    entry, choice, test = trial.entry, trial.choice, trial.test
    name = f"{choice.name} {entry.label}" + (f" seed {trial.seed}" if trial.seed else "")
    full = replace(trial, entry=replace(entry, variant="full")).trained
    shared = full != trial.trained and any(t.trained == full for t in trials)
    return [
        Job(
            trial.trained,
            f"train {name} on {trial.train_scenes}",
            _train,
            tuple(("sequence", scene.name) for scene in trial.train),
            (trial, preset),
            600.0 if choice.random else 10.0,
            (full,) if shared else (),  # the full variant first: it shares stages with the others
        ),
        Job(
            trial.evaluated,
            f"evaluate {name} on {test.name}",
            _evaluate,
            (trial.trained, ("sequence", test.name)),
            (trial, preset),
            0.1 * getattr(test, "frames", TRAIN_FRAMES),
        ),
    ]


def _simulate(source: Source, preset: Preset) -> Path | Reused:
    reference = make_reference(source, preset)
    return Reused(reference.path) if reference.reused else reference.path


def _another_run_job(source: Source, preset: Preset) -> Job:
    """Scoring the further runs of a test scene."""
    key, needs = (ANOTHER_RUN, source.name), (("sequence", source.name),)
    return Job(key, f"another run of {source.name}", _score_another_run, needs, (source, preset))


def _score_another_run(_: Path, source: Source, preset: Preset) -> str | Reused | None:
    run = pipeline.evaluate_another_run(source, preset, RunStore())
    return None if run is None else _id(run)


def _train(*inputs: Any) -> str | Reused:
    *_, trial, preset = inputs
    frames = trial.entry.train_frames
    return _id(pipeline.train(trial.choice, trial.train, preset, frames, trial.seed, RunStore(), trial.lengths))


def _evaluate(trained: str, _: Path, trial: Trial, preset: Preset) -> str | Reused:
    store = RunStore()
    try:
        return _id(pipeline.evaluate(store.get(trained), trial.test, preset, store))
    except pipeline.OtherGarmentError as e:
        raise UserError(f"{e}; wanted scenes of that garment in the experiment's train = [...]") from e


def _id(run: Run) -> str | Reused:
    return Reused(run.id) if run.reused else run.id


@dataclass(frozen=True)
class Column:
    """A column of measured values: a metric at a horizon (None: the longest there is)."""

    metric: str
    horizon: int | None = None

    @property
    def title(self) -> str:
        name = f"rollout-{self.horizon}" if self.metric == "rollout_l2" else metric(self.metric).title
        unit = metric(self.metric).unit.replace("^2", "²")
        return name if unit == "1" else f"{name} [{unit}]"


def accuracy_table(found: list[Line], title: str) -> Table:
    """Methods on one scene: errors by horizon, each with the paper's where it has one, and what else was measured."""
    columns = errors(found) + measured_columns(found, MAIN)
    header = ["method"]
    rows = [[Cell("reference", note=True)]] + [[Cell(line.label)] for line in found]
    unsettled = compared = False
    for column in columns:
        header.append(column.title)
        values = [line.value(column.metric, column.horizon) for line in found]
        methods = [value for line, value in zip(found, values, strict=True) if line.method not in SIMULATED]
        winner = best(methods, column.metric)
        unsettled |= len(competing(methods)) > 1 and not all(value.settled for value in competing(methods))
        cells = [_reference_cell(values)] + [value_cell(v, bold=v is winner and v is not None) for v in values]
        papers = [paper_cell(line, column.metric, column.horizon) for line in found]
        shown = any(cell.text for cell in papers)
        header += ["paper"] if shown else []
        compared |= shown and metric(column.metric).unit == "cm"
        for row, cell, paper in zip(rows, cells, [Cell(note=True), *papers], strict=True):
            row += [cell, paper] if shown else [cell]
    header.append("status")
    rows[0].append(Cell(note=True))
    for row, line in zip(rows[1:], found, strict=True):
        row.append(status_cell(line))
    first = found[0]
    return Table(
        f"{first.experiment}-{first.scene}",
        f"{title}: {first.garment.replace('_', ' ')}, {first.motion}{_role(first)}",
        _caption(found, unsettled, any(cell.bold for row in rows for cell in row)) + (PAPER if compared else ""),
        header,
        rows,
        frozenset({0, len(header) - 1}),
    )


def _role(line: Line) -> str:
    """What a scene is where it is no test: settings are chosen on it."""
    return " (validation, no test)" if (line.rows.split == "validation").any() else ""


def errors(found: list[Line]) -> list[Column]:
    """The columns of errors: one step, and the roll-out at each horizon that any of the lines has."""
    horizons = sorted({int(h) for line in found for h in line.rows.horizon[line.rows.metric == "rollout_l2"].dropna()})
    return measured_columns(found, ("one_step_l2",)) + [Column("rollout_l2", h) for h in horizons]


def measured_columns(found: list[Line], metrics: tuple[str, ...]) -> list[Column]:
    """A column for each metric that any of the lines has."""
    return [Column(m) for m in metrics if any((line.rows.metric == m).any() for line in found)]


def _reference_cell(values: list[Value | None]) -> Cell:
    """The reference's own value of a metric, where it has one."""
    for value in values:
        if value is not None and not math.isnan(value.reference):
            return Cell(number(value.reference), note=True)
    return Cell(ABSENT, note=True)


def _caption(found: list[Line], unsettled: bool, bold: bool) -> str:
    """What the table's cells hold. `unsettled`: in some columns nothing is bold, for a value of a single training with
    chance in it; `bold`: something is bold."""
    methods = [line for line in found if line.method not in SIMULATED]
    seeds = max((line.rows.seed.nunique() for line in methods), default=1)
    ran = [line for line in methods if line.run_ids]
    once = "methods whose training has chance in it were trained once, and by how much another training would move them"
    if seeds > 1:
        interval = f"mean over {seeds} seeds ± half the 95 % confidence interval"
    elif ran and not any(line.random for line in ran):
        interval = "none of the methods has chance in its training, so one seed of each"
    else:
        interval = "one seed"
    if unsettled and not bold:
        rule = f"nothing is bold, since {once} isn't known"
    else:
        rule = "bold: better than every other method by more than the spread, with intervals that do not overlap"
        rule += f"; nothing in other columns, where {once} isn't known" if unsettled else ""
    return (
        f"Scene {found[0].scene}{_regime(found)}; {interval}. 1-step and roll-out are mean distances to the run of the "
        "reference that the method begins in, whose own values stand in the first line; error is that to all its runs. "
        f"Another run of the simulator errs by the spread, and nobody need do better; {rule}."
    )


def _regime(found: list[Line]) -> str:
    """Whether the scene is contracting or chaotic, as its further runs say; nothing where there are none."""
    growths = [value.mean for line in found if (value := line.value(PUSH_GROWTH.name)) is not None]
    return f", {regime(growths[0])} (a push of 1 mm is {growths[0]:.2g} mm in its last fifth)" if growths else ""


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
