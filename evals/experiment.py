"""What an experiment is: something to compute by its name, and the part of the report that shows it."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from garmentbench.evaluation.results import Row
from garmentbench.reference import SequenceFile, Source
from garmentbench.report.card import read_card
from garmentbench.scenes.presets import Preset
from garmentbench.storage.jobs import Failure, Job, run_here
from garmentbench.storage.runs import UnfinishedError, only_finished

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section


@dataclass(frozen=True)
class Work:
    """What an experiment computes at a preset, every name in it resolved.

    Attributes:
        jobs: By key; experiments may share jobs. The key of a reference sequence is ("sequence", scene).
        rows: Its rows of results.csv, of the results of all jobs.
    """

    jobs: dict[tuple, Job]
    rows: Callable[[dict[tuple, Any]], list[Row]]

    @property
    def sources(self) -> list[Source]:
        """Whose reference sequences it has."""
        return [job.arguments[0] for key, job in self.jobs.items() if key[0] == "sequence"]


@dataclass(frozen=True, kw_only=True)
class Experiment(ABC):
    """An experiment.

    Attributes:
        name: What the user types.
        table: Its name in results.csv; several experiments may share lines and a part of the report.
        title: Of its part of the report.
        on_request: It runs only when it is named; what it made stays in the report while data and code are the same.
        seeds: Trainings of each method that has chance in it, where the user doesn't say.
    """

    name: str
    table: str
    title: str
    on_request: bool = False
    seeds: int = 1

    def require(self) -> None:  # noqa: B027 - most need nothing
        """Raises `UserError` where something that it needs is not installed."""

    @abstractmethod
    def work(self, preset: Preset, seeds: int) -> Work:
        """Its jobs and rows; `seeds` trainings of a method that has chance in it. Raises `UserError`."""

    @abstractmethod
    def sections(self, results: "Results") -> "list[Section]":
        """Its part of the report, of `results` alone."""


@dataclass(frozen=True, kw_only=True)
class Companion(Experiment):
    """An experiment about whatever sequences those beside it have; it runs whenever any of these does."""

    def work(self, preset: Preset, seeds: int) -> Work:
        """What it has to do where it is named itself: by default nothing more."""
        return Work({}, lambda results: [])

    @abstractmethod
    def beside(self, sources: Iterable[Source], preset: Preset) -> Work:
        """Its jobs and rows for these sequences, for each of which there is a job ("sequence", its name)."""


def finished_rows(experiment: Experiment, preset: Preset, seeds: int = 1, *beside: Companion) -> list[Row]:
    """The rows of an experiment that was run before, of the same data and by the same code, and those that companions
    have of its sequences; none where a job has anything to do."""
    work = experiment.work(preset, seeds)
    try:
        with only_finished():
            results = run_here(work.jobs)
    except UnfinishedError:
        return []
    works = [work, *(companion.beside(work.sources, preset) for companion in beside)]
    return [row for each in works for row in each.rows(results)]


def about(table: str, preset: Preset, source: Source, method: str, **columns: Any) -> Row:
    """A row that says what it is about, and holds nothing measured yet. columns: of `Row`, e.g. the variant."""
    if isinstance(source, SequenceFile):
        card = read_card(source.path)
        predicted = {key: getattr(card, key) for key in ("split", "garment", "motion", "body")}
    else:
        predicted = {key: getattr(source, key) for key in ("split", "garment", "body")} | {"motion": source.motion.name}
    columns = {"variant": "full", "scene": source.name} | predicted | columns
    return Row(preset=preset.name, experiment=table, method=method, **columns)


def named(measured: Row | dict[str, Any], columns: Row, run: str = "") -> Row:
    """What was measured, under the columns that say what it is about."""
    measured = measured.measured if isinstance(measured, Row) else measured
    return replace(columns, **measured, run_id=run)


def failed_row(columns: Row, failure: Failure, metric: str = "rollout_l2") -> Row:
    """The row of a line that could not be computed at all.

    It stays in the tables, with its status and message.
    """
    return replace(columns, metric=metric, unit="cm", status="failed", run_id=f"({failure.message})")


def first_failure(*results: Any) -> Failure | None:
    """The first of some jobs' results that is a failure."""
    return next((r for r in results if isinstance(r, Failure)), None)
