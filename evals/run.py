"""From experiments to results.csv and the report: what is missing is computed, what is finished is reused."""

import math
import os
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

from garmentbench import paths
from garmentbench.device import require_device
from garmentbench.errors import UserError, unknown_name
from garmentbench.evals import CARDS, COMPANIONS, EXPERIMENTS
from garmentbench.evals.experiment import Experiment, finished_rows
from garmentbench.evals.own import read_experiments
from garmentbench.evaluation.results import COLUMNS, Row, warnings
from garmentbench.evaluation.rollout import COMPLETE
from garmentbench.metrics.skill import SKILL, skill
from garmentbench.report.lines import read_results
from garmentbench.scenes.presets import Preset
from garmentbench.storage.atomic import write_text
from garmentbench.storage.jobs import Failure, run_jobs
from garmentbench.storage.machine import core_count

WHOLE = ("train_frames", "horizon", "first_bad_frame")  # columns of whole numbers
NAMED = 5  # lines that a warning names, at most
LINE = ("experiment", "scene", "method", "variant", "train_scenes", "seed")  # what tells lines apart


def run(names: list[str], preset: Preset, seeds: int | None = None, data_only: bool = False) -> None:
    """Compute experiments of the suite (all but those on request, if none is named) and write `reports/<preset>/`.

    Without names an experiment on request that was run before keeps its place in the report as long as it would be run
    on the same data and by the same code; where it loses its place, that is said.

    Args:
        names: Of the experiments.
        preset: At which size.
        seeds: Trainings of each method that has chance in it; None: as the experiments say.
        data_only: Only simulate the scenes.

    Raises:
        UserError: A name is wrong; or at the end, if a job failed: its line is in the tables all the same.
    """
    for name in names:
        if name not in EXPERIMENTS:
            raise unknown_name("experiment", name, list(EXPERIMENTS))
    chosen = [e for e in EXPERIMENTS.values() if (e.name in names if names else not e.on_request)]
    path = paths.reports() / preset.name / "results.csv"

    def all_rows(rows: list[Row]) -> list[Row]:
        if names:
            return merged(path, rows, [e.table for e in chosen if e.on_request])
        return rows + [row for e in EXPERIMENTS.values() if e not in chosen for row in kept_rows(e, preset, path)]

    _compute(chosen, preset, seeds, data_only, path, all_rows)


def kept_rows(experiment: Experiment, preset: Preset, path: Path) -> list[Row]:
    """The rows of an experiment that was run before, which nobody asked for now: those that still hold. It says so
    where the results.csv at `path` has some, and none of them does."""
    table = read_results(path) if path.is_file() else None
    seeds = [] if table is None else table.seed[table.experiment == experiment.table].tolist()
    rows = finished_rows(experiment, preset, 1 + int(max(seeds, default=0)), CARDS)
    if seeds and not rows:
        print(
            f"warning: {experiment.name}: its part of the report is dropped, which was made by other code or of other "
            f"data; `garmentbench evals {experiment.name} --preset {preset.name}` makes it again"
        )
    return rows


def run_file(file: Path, preset: Preset, seeds: int | None = None, data_only: bool = False) -> None:
    """As `run`, all experiments of a user's own file; their report is `reports/<file's name>-<preset>`."""
    own = read_experiments(file)
    path = paths.reports() / own_report(file, preset) / "results.csv"
    _compute(own, preset, seeds, data_only, path, list)


def own_report(file: Path, preset: Preset) -> str:
    """The name of the report of a user's own experiments."""
    return f"{file.stem}-{preset.name}"


def _compute(
    chosen: list[Experiment],
    preset: Preset,
    seeds: int | None,
    data_only: bool,
    path: Path,
    all_rows: Callable[[list[Row]], list[Row]],
) -> None:
    """Compute experiments, write what `all_rows` makes of their rows into the results.csv at `path`, and report."""
    require_device(preset)
    for experiment in chosen:
        experiment.require()
    works = [experiment.work(preset, seeds or experiment.seeds) for experiment in chosen]
    sources = {source.name: source for work in works for source in work.sources}
    works += [companion.beside(sources.values(), preset) for companion in COMPANIONS]
    jobs = {key: job for work in works for key, job in work.jobs.items() if key[0] == "sequence" or not data_only}
    os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"))
    results = run_jobs(jobs, core_count())
    if not data_only:
        rows = [row for work in works for row in work.rows(results)]
        write_results(path, all_rows(rows))
        from garmentbench.evals.report import make_report  # matplotlib is not for the workers

        page = make_report(path.parent.name, paths.reports(), paths.runs(), chosen)
        for warning in noted(rows):
            print(f"warning: {warning}")
        print(f"report: {page}")
    failures = [r for r in results.values() if isinstance(r, Failure)]
    failed = [r for r in failures if not r.skipped]
    if failed:
        skipped = f", {len(failures) - len(failed)} that need them were skipped" if len(failures) > len(failed) else ""
        first = f"{failed[0].label}: {failed[0].message}"
        raise UserError(f"{len(failed)} of {len(jobs)} jobs failed{skipped}; the first: {first}")


def noted(rows: list[Row]) -> list[str]:
    """What has to be said of noted values, a line for each note: of which methods on which scenes."""
    said: dict[str, list[str]] = {}
    for row in rows:
        line = row.method if row.variant in ("", "full") else f"{row.method} {row.variant}"
        for warning in warnings([vars(row) | {"metric": f"{line} on {row.scene}"}]):
            where, _, what = warning.partition(": ")
            said.setdefault(what, []).append(where)
    named = {what: list(dict.fromkeys(where)) for what, where in said.items()}
    return [
        f"{', '.join(where[:NAMED])}{f' and {len(where) - NAMED} more' if len(where) > NAMED else ''}: {what}"
        for what, where in named.items()
    ]


def merged(path: Path, rows: list[Row], replaced: Iterable[str] = ()) -> list[Row]:
    """The rows, and those of the results.csv at `path` that are about other lines, but none of the experiments
    `replaced`."""

    def line(row: Row) -> tuple:
        return tuple(getattr(row, column) for column in LINE)

    if not path.is_file():
        return rows
    new, gone = {line(row) for row in rows}, set(replaced)
    table = read_results(path).astype(object)
    old = [Row(**row) for row in table.where(table.notna(), None).to_dict("records")]
    old = [replace(row, value=math.nan) if row.value is None else row for row in old]
    return rows + [row for row in old if line(row) not in new and row.experiment not in gone]


def with_skill(rows: list[Row]) -> list[Row]:
    """The rows and `skill` beside each rollout_l2: 1 - error / skinning's error on the same frames.

    It follows from the digits that results.csv keeps, so that it is the same whether a row was measured just now or
    read from there.
    """
    errors = [r for r in rows if r.metric == "rollout_l2" and r.status in COMPLETE]
    skinning = {(r.scene, r.horizon): _kept(r.value) for r in errors if r.method == "skinning"}
    skills = []
    for r in errors:
        if (r.scene, r.horizon) in skinning:
            value = skill(_kept(r.value), skinning[r.scene, r.horizon])
            skills.append(replace(r, metric=SKILL.name, value=value, unit=SKILL.unit, spread=None, note=""))
    return [r for r in rows if r.metric != SKILL.name] + skills


def _kept(value: float) -> float:
    """A number as results.csv keeps it: with 6 digits."""
    return float(f"{value:.6g}")


def write_results(path: Path, rows: list[Row]) -> None:
    """Write results.csv: rows in a fixed order, numbers with 6 digits."""
    import pandas

    table = pandas.DataFrame(map(vars, with_skill(rows)), columns=COLUMNS).astype(dict.fromkeys(WHOLE, "Int64"))
    table = table.sort_values([*COLUMNS[1:13], "train_scenes", "unit"]).drop_duplicates()
    write_text(path, table.to_csv(index=False, float_format="%.6g"))
