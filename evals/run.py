"""From experiments to results.csv and the report: what is missing is computed, what is finished is reused."""

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from garmentbench import paths
from garmentbench import pipeline as work
from garmentbench.errors import UserError, unknown_name
from garmentbench.evals import EXPERIMENTS, STUDIES
from garmentbench.evals.data import card_rows
from garmentbench.evals.experiment import Entry, Experiment
from garmentbench.evals.left_out import NEEDS_TABLE, left_out
from garmentbench.evals.rows import about, failed_row, merged, write_results
from garmentbench.evals.stability import UNSTRESSED, method_measures, simulator_measures
from garmentbench.evals.study import finished_rows
from garmentbench.evaluation.rollout import RollOut
from garmentbench.report.card import read_card
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene, load_scene
from garmentbench.storage.jobs import Failure, Job, run_jobs
from garmentbench.storage.machine import core_count
from garmentbench.storage.runs import Run, RunStore


@dataclass(frozen=True)
class Line:
    """One line of a table before it is computed: an entry of an experiment, a seed and a test scene."""

    experiment: Experiment
    entry: Entry | None  # None: the reference simulation itself
    seed: int
    scene: str

    @property
    def trained(self) -> tuple:
        return ("train", self.experiment.train, self.entry, self.seed)

    @property
    def evaluated(self) -> tuple:
        return ("evaluate", self.trained, self.scene)


def run(names: list[str], preset: Preset, seeds: int, data_only: bool = False) -> None:
    """Compute the named experiments and studies (all experiments, if none is named) and write `reports/<preset>/`.

    Without names a study keeps its place in the report if it is finished, by this code; a cheap one is run. Raises
    `UserError` at the end if a job failed; its line is in the tables all the same.
    """
    for name in names:
        if name not in EXPERIMENTS | STUDIES:
            raise unknown_name("experiment", name, [*EXPERIMENTS, *STUDIES])
    work.require_device(preset)
    experiments = [EXPERIMENTS[name] for name in names or EXPERIMENTS if name in EXPERIMENTS]
    wanted = [s for s in STUDIES.values() if s.name in names or (s.always and not names)]
    studies = [] if data_only else wanted
    for study in studies:
        study.require()
    lines = [line for experiment in experiments for line in _lines(experiment, preset, seeds)]
    jobs = _jobs(experiments, lines, preset, data_only) | {
        k: job for study in studies for k, job in study.jobs(preset).items()
    }
    os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"))
    results = run_jobs(jobs, core_count())
    if not data_only:
        rows = [row for line in lines for row in _rows(line, preset, results)]
        rows += [
            row for experiment in experiments if experiment.needs for row in _needs_rows(experiment, preset, results)
        ]
        rows += [row for study in studies for row in study.rows(preset, results)]
        rows += _data_rows(results)
        path = paths.reports() / preset.name / "results.csv"
        if names:
            rows = merged(path, rows, [study.name for study in studies])
        else:
            rows += [row for study in STUDIES.values() if study not in studies for row in finished_rows(study, preset)]
        write_results(path, rows)
        from garmentbench.evals.report import make_report  # matplotlib is not for the workers

        make_report(preset.name, paths.reports(), paths.runs())
        print(f"report: {path.with_name('index.html')}")
    failed = [r for r in results.values() if isinstance(r, Failure)]
    if failed:
        raise UserError(f"{len(failed)} of {len(jobs)} jobs failed, the first: {failed[0].label}: {failed[0].message}")


def _lines(experiment: Experiment, preset: Preset, seeds: int) -> list[Line]:
    lines = [
        Line(experiment, entry, seed, scene)
        for scene in experiment.tests
        for entry in experiment.entries
        for seed in range(seeds if _choice(entry, preset).random else 1)
    ]
    if experiment.simulator:
        lines += [Line(experiment, None, 0, scene) for scene in experiment.tests]
    return lines


def _jobs(experiments: list[Experiment], lines: list[Line], preset: Preset, data_only: bool) -> dict[tuple, Job]:
    jobs = {}

    def add(job: Job) -> None:
        jobs.setdefault(job.key, job)

    for scene in {s: None for e in experiments for s in (e.train, *e.tests)}:
        frames = load_scene(scene).frames
        add(Job(("sequence", scene), f"simulate {scene}", _sequence, (), (scene, preset), cost=0.2 * frames))
    if data_only:
        return jobs
    for scene in {e.train for e in experiments if e.needs}:
        add(Job(("needs", scene), f"what {scene} does not need", left_out, (("sequence", scene),), (preset,)))
    trainings = {line.trained for line in lines if line.entry is not None}
    for line in lines:
        if line.entry is None:
            continue
        train, test = line.experiment.train, line.scene
        name = f"{line.entry.method} {line.entry.label}" + (f" seed {line.seed}" if line.seed else "")
        cost = 600.0 if _choice(line.entry, preset).random else 10.0
        arguments = (line.entry, train, preset, line.seed)
        full = replace(line, entry=replace(line.entry, variant="full")).trained  # shares stages with its variants
        after = (full,) if full != line.trained and full in trainings else ()
        add(Job(line.trained, f"train {name} on {train}", _train, (("sequence", train),), arguments, cost, after))
        add(
            Job(
                line.evaluated,
                f"evaluate {name} on {test}",
                _evaluate,
                (line.trained, ("sequence", test)),
                (test, preset),
                cost=0.1 * load_scene(test).frames,
            )
        )
    return jobs


def _sequence(scene: str, preset: Preset) -> Path:
    return work.make_sequence(scene, preset)


def _train(_: Path, entry: Entry, scene: str, preset: Preset, seed: int) -> str:
    return work.train(_choice(entry, preset), (scene,), preset, entry.train_frames, seed, RunStore()).id


def _choice(entry: Entry, preset: Preset) -> work.MethodChoice:
    return work.choose_method(entry.method, entry.variant, preset)


def _evaluate(trained: str, _: Path, scene: str, preset: Preset) -> str:
    store = RunStore()
    return work.evaluate(store.get(trained), scene, preset, store).id


def _rows(line: Line, preset: Preset, results: dict) -> list[dict]:
    """The rows of results.csv for one line: what its run measured, or that it failed."""
    scene, table, entry = load_scene(line.scene), line.experiment.table, line.entry
    simulated = results[("sequence", line.scene)]
    if entry is None:
        columns = about(table, preset, scene, "reference", "full", None, 0)
        unstressed = results[("sequence", UNSTRESSED)]
        failure = _first_failure(simulated, unstressed)
        return (
            [failed_row(columns, failure)]
            if failure
            else [columns | r for r in simulator_measures(scene, simulated, unstressed)]
        )
    frames = min(entry.train_frames, preset.frame_limit or entry.train_frames)
    columns = about(table, preset, scene, entry.method, entry.label, frames, line.seed)
    failure = _first_failure(simulated, results[line.trained], results[line.evaluated])
    if failure:
        return [failed_row(columns, failure)]
    run = RunStore().get(results[line.evaluated])
    measured = run.results["rows"]
    if line.experiment.simulator:
        measured = measured + _stress_rows(scene, simulated, run, results.get(("evaluate", line.trained, UNSTRESSED)))
    return [columns | row | {"run_id": run.id} for row in measured]


def _needs_rows(experiment: Experiment, preset: Preset, results: dict) -> list[dict]:
    """The rows that say what was left out for an experiment's training scene."""
    columns = about(NEEDS_TABLE, preset, load_scene(experiment.train), "motion_guided", "full", None, 0)
    measured = results[("needs", experiment.train)]
    return [failed_row(columns, measured)] if isinstance(measured, Failure) else [columns | row for row in measured]


def _data_rows(results: dict) -> list[dict]:
    """The data card of every sequence."""
    made = [path for key, path in results.items() if key[0] == "sequence" and not isinstance(path, Failure)]
    return [row for path in made for row in card_rows(read_card(path))]


def _stress_rows(scene: Scene, simulated: Path, run: Run, unstressed: str | Failure) -> list[dict]:
    if isinstance(unstressed, Failure):
        return []
    plain = RunStore().get(unstressed).folder / "rollout.h5"
    return method_measures(scene, simulated, RollOut.load(run.folder / "rollout.h5"), RollOut.load(plain))


def _first_failure(*results: Any) -> Failure | None:
    return next((r for r in results if isinstance(r, Failure)), None)
