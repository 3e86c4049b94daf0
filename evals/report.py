"""Making a preset's report: everything in its folder but results.csv, from that file and the runs alone."""

import json
from pathlib import Path

from garmentbench.errors import UserError
from garmentbench.evals.data import DATA, FOLDER, card_files, cards_in
from garmentbench.evals.tables import NEEDS, all_tables
from garmentbench.evaluation.excerpt import FILE, read_material
from garmentbench.report.lines import REFERENCE, Line, ending, lines, read_results
from garmentbench.report.page import Ended, Section, page
from garmentbench.report.table import html_table, latex, markdown
from garmentbench.storage.atomic import written_whole

FORMS = {"md": markdown, "tex": latex, "html": html_table}
MADE = ("tables", "plots", "strips", FOLDER)  # folders that hold nothing else


def make_report(preset: str, reports_root: Path, runs_root: Path) -> Path:
    """Make `reports_root/<preset>` anew from its results.csv and from the runs it names; the same bytes every time.

    Returns:
        The page.

    Raises:
        UserError: results.csv is missing or wrong, or runs that it names are missing; nothing is changed then.
    """
    from garmentbench.evals.pictures import all_pictures  # Matplotlib and Warp: not for those who only write material

    folder = reports_root / preset
    results = read_results(folder / "results.csv")
    found = [line for experiment in dict.fromkeys(results.experiment) for line in lines(results, experiment)]
    found = [line for line in found if line.experiment != NEEDS and line.method != REFERENCE]
    _require_runs(found, runs_root, preset)
    runs = list(dict.fromkeys(run for line in found for run in line.run_ids))
    materials = {run: read_material(runs_root / run) for run in runs}
    records = {run: json.loads((runs_root / run / "run.json").read_text()) for run in runs}

    cards = card_files(cards_in(results))
    made: dict[str, bytes] = dict(cards)
    sections = []
    for table, its_lines in all_tables(results):
        made |= {f"tables/{table.name}.{form}": write(table).encode() for form, write in FORMS.items()}
        ran = [line for line in its_lines if line.run_ids]
        pictures = all_pictures(table.name, results, ran, materials, runs_root)
        made |= {picture.path: data for picture, data in pictures}
        sections.append(Section(table, [picture for picture, _ in pictures], list(cards) if table.name == DATA else []))
    made["index.html"] = page(preset, sections, _ended(found, records), _machines(records)).encode()
    _replace(folder, made)
    return folder / "index.html"


def _require_runs(found: list[Line], runs_root: Path, preset: str) -> None:
    """Raise `UserError` if a run that results.csv names is not whole: part of a report would pass for all of it."""
    named = dict.fromkeys(run for line in found for run in line.run_ids)
    missing = [run for run in named if not all((runs_root / run / file).is_file() for file in ("run.json", FILE))]
    if missing:
        raise UserError(
            f"{runs_root}: {len(missing)} of the {len(named)} runs named in results.csv are missing, the first: "
            f"{missing[0]}; the report stays as it is; `make evals PRESET={preset}` makes the runs and then the report"
        )


def _ended(found: list[Line], records: dict[str, dict]) -> list[Ended]:
    """Lines that did not end well, with what they said; one that never ran carries its message in place of a run."""
    ended = []
    for line in found:
        for row in line.rows[line.rows.status != "ok"].drop_duplicates("run_id").itertuples():
            ran = row.run_id in records
            message = records[row.run_id]["results"].get("message", "") if ran else row.run_id[1:-1]
            name = line.label + (f", seed {row.seed}" if line.rows.seed.nunique() > 1 else "")
            ended.append(Ended(line.scene, name, ending(row), message))
    return list(dict.fromkeys(ended))


def _machines(records: dict[str, dict]) -> list[str]:
    """What the runs were made on."""
    machines = [record["machine"] for record in records.values()]
    return sorted({m["cuda"] or f"{m['cpu']}, threads: {m['threads'] or 1}" for m in machines})


def _replace(folder: Path, made: dict[str, bytes]) -> None:
    """Put the report's files into its folder, the page last, and remove what an earlier report left there."""
    for path, data in sorted(made.items(), key=lambda item: item[0] == "index.html"):
        with written_whole(folder / path) as partial:
            partial.write_bytes(data)
    for sub in MADE:
        for file in (folder / sub).glob("*"):
            if f"{sub}/{file.name}" not in made:
                file.unlink()
