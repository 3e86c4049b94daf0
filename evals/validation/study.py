"""Validation: the simulator on problems whose answers are known. One job a case, on a CPU, whatever the preset."""

import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from garmentbench.evals.experiment import Experiment, Work, failed_row
from garmentbench.evals.validation.table import BAND, HIGH, LOW, SIMULATED, VALIDATION, read_cases, validation_table
from garmentbench.evaluation.results import Row
from garmentbench.report.lines import REFERENCE
from garmentbench.scenes.presets import Preset
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.jobs import Failure, Job
from garmentbench.storage.runs import RunStore

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section

KIND = "validation"


def validate(name: str) -> str:
    """Simulate a case at all its sizes, unless that is done; the id of the run.

    Its results: `wanted`, `low` and `high` (within what the finest value passes), `values` and `seconds` by size.
    """
    from garmentbench.device import quiet_warp
    from garmentbench.evals.validation.cases import CASES

    with RunStore().open(KIND, _identity(name)) as run:
        if not run.finished:
            quiet_warp()
            case, values, seconds = CASES[name], {}, {}
            wanted = case.wanted()
            with run.track(len(case.sizes), name) as step:
                for label, size in case.sizes.items():
                    begin = time.process_time()
                    values[label] = case.simulate(size)
                    seconds[label] = time.process_time() - begin
                    step()
            low, high = case.band(wanted)
            run.finish({"wanted": wanted, "low": low, "high": high, "values": values, "seconds": seconds})
    return run.id


def _identity(name: str) -> dict:
    return {"case": name, "code": fingerprint("garmentbench.evals.validation.cases")}


class Validation(Experiment):
    """All cases, and one table."""

    def work(self, preset: Preset, seeds: int) -> Work:
        from garmentbench.evals.validation.cases import CASES

        jobs = {(KIND, c.name): Job((KIND, c.name), c.title, validate, (), (c.name,), c.cost) for c in CASES.values()}

        def rows(results: dict[tuple, Any]) -> list[Row]:
            return [row for name in CASES for row in _rows(name, preset, results[KIND, name])]

        return Work(jobs, rows)

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.report.page import Section

        return [Section(validation_table(read_cases(results)))]


def _rows(name: str, preset: Preset, made: str | Failure) -> list[Row]:
    columns = Row(preset=preset.name, experiment=VALIDATION, scene=name, method=REFERENCE)
    if isinstance(made, Failure):
        return [failed_row(replace(columns, variant=BAND), made, SIMULATED)]
    from garmentbench.evals.validation.cases import CASES

    found, unit = RunStore().get(made).results, CASES[name].unit
    wanted = None if isinstance(found["wanted"], list) else found["wanted"]
    columns = replace(columns, unit=unit, run_id=made, reference_value=wanted)
    rows = [replace(columns, variant=BAND, metric=metric, value=found[metric]) for metric in (LOW, HIGH)]
    for label, value in found["values"].items():
        seconds = replace(columns, variant=label, metric="seconds", value=found["seconds"][label], unit="s")
        rows += [replace(columns, variant=label, metric=SIMULATED, value=value), replace(seconds, reference_value=None)]
    return rows


STUDY = Validation(name=VALIDATION, table=VALIDATION, title="Validation", on_request=True)
