"""results.csv as the report reads it: lines of a table, each with its values over the seeds."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from garmentbench.errors import UserError
from garmentbench.evaluation.results import COLUMNS

if TYPE_CHECKING:
    import pandas

ADDED = ("train_scenes", "note")  # columns that reports made before them lack
TRAINING_LENGTH = "table4"  # the experiment that compares training lengths
REFERENCE = "reference"  # the method name of the reference simulation's own lines
METHOD_ORDER = ("reference", "skinning", "hold", "constant_velocity", "linear_subspace")


@dataclass(frozen=True)
class Value:
    """One measured value of a line, over its seeds.

    Attributes:
        mean: Over the seeds that have one; NaN where none has.
        interval: Half-width of the mean's 95 % confidence interval (Student's t); None with fewer than two values.
        endings: Status and first bad frame of every seed without a value ("diverged at frame 37", "failed").
        seeds: How many seeds there are.
        reference: The reference's own value, or NaN.
        uncertainty: The reference's uncertainty [cm], or NaN.
    """

    mean: float
    interval: float | None
    endings: tuple[str, ...]
    seeds: int
    reference: float
    uncertainty: float


@dataclass(frozen=True)
class Line:
    """One line of a table: a method's variant, trained on so many frames, on a scene. `rows`: all it has in results.csv."""

    experiment: str
    scene: str
    garment: str
    motion: str
    method: str
    variant: str
    train_frames: int | None
    rows: "pandas.DataFrame"

    @property
    def label(self) -> str:
        """Its name for people, e.g. "motion-guided, fixed weights"; where training lengths are compared, with its own."""
        own = self.experiment == TRAINING_LENGTH and self.variant == "full" and self.train_frames is not None
        return label(self.method, f"train_{self.train_frames}" if own else self.variant)

    def value(self, metric: str, horizon: int | None = None) -> Value | None:
        """A metric's value, at a horizon or at the longest; None where it was not measured at all."""
        rows = self.rows[self.rows.metric == metric]
        if len(rows) == 0:
            return None
        at = rows.horizon.max() if horizon is None else horizon
        rows = rows[(rows.horizon == at) | rows.horizon.isna()]
        return _value(rows) if len(rows) else None

    @property
    def endings(self) -> list[str]:
        """How each seed's roll-out ended, in the order of the seeds."""
        rows = self.rows[self.rows.metric != "one_step_l2"].drop_duplicates("seed").sort_values("seed")
        return [ending(row) for row in rows.itertuples()]

    @property
    def run_ids(self) -> list[str]:
        """Ids of its runs, in the order of the seeds; a run that could not be made has none."""
        return [i for i in self.rows.sort_values("seed").run_id.unique() if i and not i.startswith("(")]


def label(method: str, variant: str) -> str:
    """A method's name for people."""
    name = "motion-guided" if method == "motion_guided" else method.replace("_", " ")
    return name if variant in ("", "full") else f"{name}, {variant.replace('_', ' ')}"


def read_results(path: Path) -> "pandas.DataFrame":
    """Read results.csv. Raises `UserError` where it is missing or not what `make evals` writes."""
    import pandas

    if not path.is_file():
        raise UserError(f"{path}: no results yet; `make evals PRESET={path.parent.name}` makes them")
    numbers = {"train_frames", "seed", "horizon", "value", "reference_value", "uncertainty", "first_bad_frame"}
    table = pandas.read_csv(path, dtype={column: str for column in COLUMNS if column not in numbers})
    table = table.assign(**{column: "" for column in ADDED if column not in table.columns})
    missing = [c for c in COLUMNS if c not in table.columns]
    if missing:
        raise UserError(f"{path}: lacks the column '{missing[0]}'; run `make evals PRESET={path.parent.name}` again")
    return table.fillna({column: "" for column in ("variant", "body", "status", "run_id", *ADDED)})


def lines(results: "pandas.DataFrame", experiment: str, scene: str | None = None) -> list[Line]:
    """Lines of an experiment (of one scene), in the order of the tables: simple methods first, full before variants."""
    rows = results[results.experiment == experiment]
    rows = rows if scene is None else rows[rows.scene == scene]
    keys = ["experiment", "scene", "garment", "motion", "method", "variant", "train_frames"]
    found = [
        Line(*key[:-1], None if math.isnan(key[-1]) else int(key[-1]), group)
        for key, group in rows.groupby(keys, dropna=False, sort=True)
    ]
    return sorted(found, key=_order)


def _order(line: Line) -> tuple:
    known = METHOD_ORDER.index(line.method) if line.method in METHOD_ORDER else len(METHOD_ORDER)
    length = line.train_frames or 0
    if line.experiment == TRAINING_LENGTH:
        return known, line.method, length, line.variant, line.scene
    return known, line.method, line.variant != "full", length, line.variant, line.scene


def _value(rows: "pandas.DataFrame") -> Value:
    finite = rows.value[np.isfinite(rows.value)].to_numpy()
    ended = rows[~np.isfinite(rows.value)]
    return Value(
        mean=float(finite.mean()) if len(finite) else math.nan,
        interval=confidence_95(finite) if len(finite) > 1 else None,
        endings=tuple(ending(row) for row in ended.itertuples()),
        seeds=len(rows),
        reference=float(rows.reference_value.iloc[0]),
        uncertainty=float(rows.uncertainty.iloc[0]),
    )


def confidence_95(values: np.ndarray) -> float:
    """Half-width of the mean's 95 % confidence interval: t_{0.975, n-1} s / sqrt(n), of n > 1 values."""
    from scipy.stats import t

    n = len(values)
    return float(t.ppf(0.975, n - 1) * values.std(ddof=1) / math.sqrt(n))


def ending(row: tuple) -> str:
    """How a row's roll-out ended, e.g. "diverged at frame 37"."""
    return row.status if math.isnan(row.first_bad_frame) else f"{row.status} at frame {row.first_bad_frame:.0f}"
