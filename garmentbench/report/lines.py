"""What a report is made from.

results.csv, as lines of tables with their values over the seeds, and the runs it names.
"""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from garmentbench.errors import UserError
from garmentbench.evaluation.another_run import ANOTHER_RUN
from garmentbench.evaluation.results import COLUMNS, notes
from garmentbench.evaluation.rollout import BROKEN

if TYPE_CHECKING:
    from garmentbench.evaluation.excerpt import Excerpt

NUMBERS = ("train_frames", "seed", "horizon", "value", "reference_value", "spread", "first_bad_frame")
Frame = Any  # a pandas.DataFrame, whose types don't follow what is selected from it
REFERENCE = "reference"  # the method name of the reference simulation's own lines
SIMULATED = (REFERENCE, ANOTHER_RUN)  # lines in which nothing was trained
ADDED = ("train_scenes", "note", "spread")  # columns that an older results.csv lacks


@dataclass(frozen=True)
class Value:
    """One measured value of a line, over its seeds.

    Attributes:
        mean: Over the seeds that have one; NaN where none has.
        interval: Half-width of the mean's 95 % confidence interval (Student's t); None with fewer than two values.
        endings: Status and first bad frame of every seed that did not end well: without a value ("diverged at frame
            37", "failed"), or with one that is not of cloth ("broken at frame 12").
        seeds: How many seeds there are.
        reference: The reference's own value, or NaN.
        spread: What another run of the simulator errs by over the same frames [cm], or NaN.
        settled: Is it known how far another training would change it? Not where chance was in the only one.
        notes: What a reader must know of it, of any seed's (see `garmentbench.evaluation.results`).
    """

    mean: float
    interval: float | None
    endings: tuple[str, ...]
    seeds: int
    reference: float
    spread: float
    settled: bool = True
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Line:
    """One line of a table: a method's variant with its training scenes and their number of frames, on a test scene.

    Attributes:
        label: Its name for people, e.g. "motion-guided, fixed weights".
        random: Does chance decide what the method learns?
        rows: All it has in results.csv.
    """

    experiment: str
    scene: str
    garment: str
    motion: str
    method: str
    variant: str
    train_scenes: str
    train_frames: int | None
    rows: Frame
    random: bool = False
    label: str = ""

    def value(self, metric: str, horizon: int | None = None) -> Value | None:
        """A metric's value, at a horizon or at the longest; None where it was not measured at all."""
        rows = self.rows[self.rows.metric == metric]
        if len(rows) == 0:
            return None
        at = rows.horizon.max() if horizon is None else horizon
        rows = rows[(rows.horizon == at) | rows.horizon.isna()]
        return _value(rows, self.random) if len(rows) else None

    @property
    def endings(self) -> list[str]:
        """How each seed's roll-out ended, in the order of the seeds."""
        rows = self.rows[self.rows.metric != "one_step_l2"].drop_duplicates("seed").sort_values("seed")
        return [ending(row) for row in rows.itertuples()]

    @property
    def run_ids(self) -> list[str]:
        """Ids of its runs, in the order of the seeds; a run that could not be made has none."""
        return [i for i in self.rows.sort_values("seed").run_id.unique() if i and not i.startswith("(")]


def label(line: Line) -> str:
    """A line's name for people."""
    name = line.method.replace("motion_guided", "motion-guided").replace("_", " ")
    return name if line.variant in ("", "full") else f"{name}, {line.variant.replace('_', ' ')}"


def order(line: Line) -> tuple:
    """Lines of a method together, its full variant first, then by training length."""
    plain = line.variant == "full"
    return (
        *(line.method != m for m in SIMULATED),
        line.method,
        not plain,
        line.train_frames or 0,
        line.variant,
        line.scene,
    )


class Results:
    """results.csv and the runs that it names.

    Attributes:
        table: results.csv.
        runs_root: The folder of all runs.
    """

    def __init__(self, table: Frame, runs_root: Path) -> None:
        self.table, self.runs_root = table, runs_root
        self.excerpt, self.record = cache(self._excerpt), cache(self._record)

    @property
    def experiments(self) -> list[str]:
        """Names of the experiments in results.csv."""
        return list(dict.fromkeys(self.table.experiment))

    def lines(
        self, experiment: str, label: Callable[[Line], str] = label, order: Callable[[Line], tuple] = order
    ) -> list[Line]:
        """The lines of an experiment, in that order, under these names."""
        keys = ["experiment", "scene", "garment", "motion", "method", "variant", "train_scenes", "train_frames"]
        rows = self.table[self.table.experiment == experiment]
        lines = []
        for _, group in rows.groupby(keys, dropna=False, sort=True):
            about = {key: group[key].iloc[0] for key in keys}
            about["train_frames"] = None if math.isnan(about["train_frames"]) else int(about["train_frames"])
            line = Line(**about, rows=group)
            trained = next((self.training(run) for run in line.run_ids), {})
            random = trained.get("results", {}).get("random", line.method not in SIMULATED)
            lines.append(replace(line, random=random, label=label(line)))
        return sorted(lines, key=order)

    def training(self, run: str) -> dict[str, Any]:
        """What the run.json of an evaluation's training says; nothing where there is none."""
        trained = self.record(run).get("identity", {}).get("trained")
        return self.record(trained) if trained else {}

    def _record(self, run: str) -> dict[str, Any]:
        """What a run's run.json says; nothing where it is missing."""
        path = self.runs_root / run / "run.json"
        return json.loads(path.read_text()) if path.is_file() else {}

    def _excerpt(self, run: str) -> "Excerpt":
        """What a run's roll-out looks like. Raises `UserError` where it is damaged."""
        from garmentbench.evaluation.excerpt import read_excerpt

        return read_excerpt(self.runs_root / run)


def read_results(path: Path) -> Frame:
    """Read results.csv. Raises `UserError` where it is missing or not what `garmentbench evals` writes."""
    import pandas

    if not path.is_file():
        raise UserError(f"{path}: no results yet; `garmentbench evals --preset {path.parent.name}` makes them")
    words = [column for column in COLUMNS if column not in NUMBERS]
    table = pandas.read_csv(path, dtype=dict.fromkeys(words, str))
    missing = [c for c in COLUMNS if c not in table.columns and c not in ADDED]
    if missing:
        raise UserError(
            f"{path}: lacks the column '{missing[0]}'; run `garmentbench evals --preset {path.parent.name}` again"
        )
    table = table.reindex(columns=COLUMNS)
    return table.assign(**{column: table[column].astype(object).fillna("") for column in words})


def _value(rows: Frame, random: bool) -> Value:
    finite = rows.value[np.isfinite(rows.value)].to_numpy()
    broken = (rows.status == BROKEN) & (rows.unit != "ms")  # a time is none the worse for it
    ended = rows[~np.isfinite(rows.value) | broken]
    return Value(
        mean=float(finite.mean()) if len(finite) else math.nan,
        interval=confidence_95(finite) if len(finite) > 1 else None,
        endings=tuple(ending(row) for row in ended.itertuples()),
        seeds=len(rows),
        reference=float(rows.reference_value.iloc[0]),
        spread=float(rows.spread.iloc[0]),
        settled=len(finite) > 1 or not random,
        notes=tuple(notes(rows.note)),
    )


def confidence_95(values: np.ndarray) -> float:
    """Half-width of the mean's 95 % confidence interval: t_{0.975, n-1} s / sqrt(n), of n > 1 values."""
    from scipy.stats import t

    n = len(values)
    return float(t.ppf(0.975, n - 1) * values.std(ddof=1) / math.sqrt(n))


def ending(row: Any) -> str:
    """How a row's roll-out ended, e.g. "diverged at frame 37"."""
    return row.status if math.isnan(row.first_bad_frame) else f"{row.status} at frame {row.first_bad_frame:.0f}"
