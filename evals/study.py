"""Studies of the reference itself: run when they are named, kept in the report while their runs are those of this code."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from garmentbench.scenes.presets import Preset
from garmentbench.storage.jobs import Job
from garmentbench.storage.runs import RunStore


@dataclass(frozen=True)
class Study:
    """A study.

    Attributes:
        name: Also its name in results.csv.
        jobs: Its jobs at a preset, by key; the result of each is the id of a finished run.
        rows: Its rows of results.csv, of a preset and the jobs' results (a run's id or a `Failure`).
        runs: The id of the run that each job makes, by the job's key, without making it.
        require: Raises `UserError` where something that it needs is not there.
        always: It is cheap, and runs with the experiments when nothing is named.
    """

    name: str
    jobs: Callable[[Preset], dict[tuple, Job]]
    rows: Callable[[Preset, dict[tuple, Any]], list[dict]]
    runs: Callable[[Preset], dict[tuple, str]]
    require: Callable[[], None] = lambda: None
    always: bool = False


def finished_rows(study: Study, preset: Preset) -> list[dict]:
    """The rows of a study all of whose runs are finished, by this code; none otherwise."""
    store, ids = RunStore(), study.runs(preset)
    if not all((store.root / i / "run.json").is_file() and store.get(i).finished for i in ids.values()):
        return []
    return study.rows(preset, ids)
