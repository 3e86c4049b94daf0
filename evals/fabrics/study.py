"""The named fabrics in the tests that textile laboratories do: Cusick's drape, a cantilever. One job a fabric."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from garmentbench.evals.experiment import Experiment, Work, failed_row
from garmentbench.evals.fabrics.table import FABRICS, METRICS, SHAPE, fabrics_table, shapes
from garmentbench.evaluation.results import Row
from garmentbench.report.lines import REFERENCE
from garmentbench.scenes.fabrics import fabric, fabrics
from garmentbench.scenes.presets import Preset
from garmentbench.storage.atomic import written_whole
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.jobs import Failure, Job
from garmentbench.storage.runs import RunStore

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section

CAPTION = "Each fabric's disc of 30 cm over the table of 18 cm, from above and from the side, on the finer mesh."


def try_fabric(name: str) -> str:
    """Put a fabric through all tests, unless that is done; the id of the run, whose folder holds the draped disc."""
    from garmentbench.device import quiet_warp
    from garmentbench.evals.fabrics.measure import measure

    with RunStore().open(FABRICS, _identity(name)) as run:
        if not run.finished:
            quiet_warp()
            found, made = measure(name)
            with written_whole(run.folder / SHAPE) as partial, partial.open("wb") as file:
                np.savez_compressed(file, positions=made.positions.astype(np.float32), faces=made.faces)
            run.finish(found)
    return run.id


def _identity(name: str) -> dict:
    return {"name": name, "fabric": fabric(name), "code": fingerprint("garmentbench.evals.fabrics.measure")}


class FabricTests(Experiment):
    """A table of all fabrics, and their drapes."""

    def work(self, preset: Preset, seeds: int) -> Work:
        jobs = {(FABRICS, n): Job((FABRICS, n), f"fabric {n}", try_fabric, (), (n,), 60.0) for n in fabrics()}

        def rows(results: dict[tuple, Any]) -> list[Row]:
            return [row for name in fabrics() for row in _rows(name, preset, results[FABRICS, name])]

        return Work(jobs, rows)

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.evals.fabrics.plot import drapes_plot
        from garmentbench.report.page import Picture, Section

        draped = shapes(results)
        pictures = [Picture(f"plots/{FABRICS}.svg", CAPTION, drapes_plot(draped))] if draped else []
        return [Section(fabrics_table(results), pictures)]


def _rows(name: str, preset: Preset, made: str | Failure) -> list[Row]:
    columns = Row(preset=preset.name, experiment=FABRICS, scene=name, method=REFERENCE)
    if isinstance(made, Failure):
        return [failed_row(columns, made, METRICS[0])]
    found = RunStore().get(made).results
    return [replace(columns, metric=m, value=found[m], unit=unit, run_id=made) for m, unit in UNITS.items()]


UNITS = dict(zip(METRICS, ("%", "%", "deg", "1", "ms"), strict=True))
STUDY = FabricTests(name=FABRICS, table=FABRICS, title="Fabrics", on_request=True)
