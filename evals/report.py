"""Making a report: everything in its folder but results.csv, from that file and the runs alone."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from garmentbench.errors import UserError
from garmentbench.evals import EXPERIMENTS
from garmentbench.evals.comparison import Comparison
from garmentbench.evals.experiment import Experiment
from garmentbench.evaluation.excerpt import FILE
from garmentbench.report import runs
from garmentbench.report.lines import REFERENCE, Line, Results, ending, read_results
from garmentbench.report.page import Ended, page
from garmentbench.report.table import FORMS, write
from garmentbench.storage.atomic import written_whole

FOLDERS = ("tables", "plots", "strips", "cards", "contact_sheets")  # which hold nothing but what is made here


def make_report(name: str, reports_root: Path, runs_root: Path, own: Iterable[Experiment] = ()) -> Path:
    """Make `reports_root/<name>` anew from its results.csv and from the runs it names; the same bytes every time.

    Args:
        name: A preset, or the name of a report of the user's own experiments.
        reports_root: The folder of all reports.
        runs_root: The folder of all runs.
        own: The user's own experiments; of those that are missing the tables are a comparison's.

    Returns:
        The page.

    Raises:
        UserError: results.csv is missing or wrong, or runs that it names are missing; nothing is changed then.
    """
    folder = reports_root / name
    results = Results(read_results(folder / "results.csv"), runs_root)
    lines = [line for experiment in results.experiments for line in results.lines(experiment)]
    ran = [line for line in lines if line.method != REFERENCE]
    _require_runs(ran, results, _command(results, name))
    sections = [section for shown in _shown(results.experiments, own) for section in shown.sections(results)]
    behind = {s.table.name: runs.runs_section(s.table.name, s.lines, results) for s in sections}
    behind = {name: section for name, section in behind.items() if section is not None}
    made: dict[str, bytes] = {runs.FILE: runs.runs_json(ran, results)} if behind else {}
    for section in (*sections, *behind.values()):
        made |= section.files | {picture.path: picture.content for picture in section.pictures}
    for table in (section.table for section in sections):
        made |= {f"tables/{table.name}.{form}": write(table, form).encode() for form in FORMS}
    title, ended, machines = _title(results, name), _ended(ran, results), _machines(ran, results)
    made["index.html"] = page(title, _command(results, name), machines, sections, behind, ended).encode()
    _replace(folder, made)
    return folder / "index.html"


def _shown(tables: list[str], own: Iterable[Experiment]) -> list[Experiment]:
    """Whom to ask for each table, in the report's order; those of a user's own experiments come first."""
    known: dict[str, Experiment] = {}
    for experiment in (*own, *EXPERIMENTS.values()):
        known.setdefault(experiment.table, experiment)
    unknown = [
        Comparison(name=t, table=t, title=t.replace("_", " ").capitalize(), train=(), tests=(), entries=())
        for t in tables
        if t not in known
    ]
    in_order = dict.fromkeys(e.table for e in (*own, *EXPERIMENTS.values()))
    return unknown + [known[table] for table in in_order if table in tables]


def _title(results: Results, name: str) -> str:
    preset = next(filter(None, results.table.preset), "")
    return f"preset {preset}" if name == preset else f"{name}"


def _command(results: Results, name: str) -> str:
    """What makes results.csv, its runs and the report."""
    preset = next(filter(None, results.table.preset), "")
    return f"make evals PRESET={preset}" if name == preset else f"garmentbench evals FILE --preset {preset}"


def _require_runs(lines: list[Line], results: Results, command: str) -> None:
    """Raise `UserError` if a run that results.csv names is not whole: part of a report would pass for all of it."""
    named = dict.fromkeys(run for line in lines for run in line.run_ids)
    missing = [run for run in named if not all((results.runs_root / run / f).is_file() for f in ("run.json", FILE))]
    if missing:
        raise UserError(
            f"{results.runs_root}: {len(missing)} of the {len(named)} runs named in results.csv are missing, the "
            f"first: {missing[0]}; the report stays as it is; `{command}` makes the runs and then the report"
        )


def _ended(lines: list[Line], results: Results) -> list[Ended]:
    """Lines that did not end well, with what they said; one that never ran carries its message in place of a run."""
    ended = []
    for line in lines:
        bad: Any = line.rows[line.rows.status != "ok"]  # a DataFrame, which its stubs take for an array
        for row in bad.drop_duplicates("run_id").itertuples():
            record = results.record(row.run_id) if row.run_id in line.run_ids else {}
            message = record["results"].get("message", "") if record else row.run_id[1:-1]
            name = line.label + (f", seed {row.seed}" if line.rows.seed.nunique() > 1 else "")
            ended.append(Ended(line.scene, name, ending(row), message))
    return list(dict.fromkeys(ended))


def _machines(lines: list[Line], results: Results) -> list[str]:
    """What the runs were made on."""
    machines = [results.record(run)["machine"] for line in lines for run in line.run_ids]
    return sorted({m["cuda"] or f"{m['cpu']}, threads: {m['threads'] or 1}" for m in machines})


def _replace(folder: Path, made: dict[str, bytes]) -> None:
    """Put the report's files into its folder, the page last, and remove what an earlier report left there."""
    for path, content in sorted(made.items(), key=lambda item: item[0] == "index.html"):
        with written_whole(folder / path) as partial:
            partial.write_bytes(content)
    for sub in FOLDERS:
        for file in (folder / sub).glob("*"):
            if f"{sub}/{file.name}" not in made:
                file.unlink()
