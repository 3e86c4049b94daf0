"""One job a sequence that is tested on draws its row of pictures; the report puts a garment's rows together."""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentbench import sequence_file
from garmentbench.evals.contact_sheets.table import COUNTS, FRAME, NAME, ROW, sheets_table
from garmentbench.evals.experiment import Companion, Work, about, failed_row, first_failure, named
from garmentbench.evals.trial import sequence_job
from garmentbench.evaluation.results import Row
from garmentbench.reference import Source, stored
from garmentbench.report.lines import REFERENCE
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.wardrobe import load_scene, scene_names
from garmentbench.storage.atomic import written_whole
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.jobs import Job
from garmentbench.storage.runs import RunStore

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section


class ContactSheets(Companion):
    """It makes no sequences: it draws those of the experiments beside it, and by itself all that are stored."""

    def work(self, preset: Preset, seeds: int) -> Work:
        """The stored sequences that are up to date, as they are."""
        tests = [scene for scene in map(load_scene, scene_names()) if _shown(scene) and stored(scene, preset)]
        return Work({job.key: job for scene in tests for job in [sequence_job(scene, preset)]}, lambda results: [])

    def beside(self, sources: Iterable[Source], preset: Preset) -> Work:
        shown = [source for source in sources if _shown(source)]
        jobs = {_key(s): Job(_key(s), f"draw {s.name}", draw, (("sequence", s.name),), cost=3.0) for s in shown}

        def rows(results: dict[tuple, Any]) -> list[Row]:
            return [row for source in shown for row in self._rows(source, preset, results)]

        return Work(jobs, rows)

    def _rows(self, source: Source, preset: Preset, results: dict[tuple, Any]) -> list[Row]:
        made, simulated = results[_key(source)], results["sequence", source.name]
        if first_failure(simulated):
            return []  # there is nothing to draw, and the tables that it is tested in say so
        columns = about(self.table, preset, source, REFERENCE)
        if first_failure(made):
            return [failed_row(columns, made, FRAME)]
        found = RunStore().get(made).results
        return [
            named(Row(metric=name, value=found[name], unit=unit), columns, made)
            for name, unit in COUNTS.items()
            if name in found
        ]

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.evals.contact_sheets.sheets import sheets
        from garmentbench.report.page import Section

        lines = results.lines(self.table)
        return [Section(sheets_table(lines, self.title), sheets(lines, results.runs_root))]


SHEETS = ContactSheets(name="contact-sheets", table=NAME, title="Every garment in every motion")


def _shown(source: Source) -> bool:
    return not isinstance(source, Scene) or source.split == "test"


def _key(source: Source) -> tuple:
    return (NAME, source.name)


def draw(path: Path) -> str:
    """Draw a sequence, unless that is done; the id of the run, whose folder holds the row of pictures."""
    from PIL import Image

    from garmentbench.device import quiet_warp
    from garmentbench.evals.contact_sheets.draw import faults, four_sides, lively_frame

    identity = {
        "data": sequence_file.content_hash(path),
        "code": fingerprint("garmentbench.evals.contact_sheets.draw", "garmentbench.viewing.render"),
    }
    with RunStore().open(NAME, identity) as run:
        if not run.finished:
            quiet_warp()
            sequence = sequence_file.load(path)
            frame = lively_frame(sequence.garment)
            with written_whole(run.folder / ROW) as partial:
                Image.fromarray(four_sides(sequence, frame)).save(partial, "PNG")
            run.finish({FRAME: frame, **faults(sequence, frame)})
    return run.id
