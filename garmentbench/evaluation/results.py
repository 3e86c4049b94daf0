"""Rows of results.csv: one measured value each."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, fields, replace

from garmentbench.metrics import Metric
from garmentbench.metrics.l2 import ONE_STEP_L2, ROLLOUT_L2

BELOW_HALF_SPREAD = "below half the spread"
RUN_BROKE = "a run of the reference broke"
EXACTLY_ZERO = "exactly the reference"
TRAINED_ON_IT = "trained on this scene"
UNDER_LOAD = "timed under load"
BETWEEN = "; "  # of several notes on one value
WARNINGS = {  # what to say where a noted value is read
    BELOW_HALF_SPREAD: "no prediction that doesn't know this very run comes so near to it on average; does the method "
    "read the reference?",
    RUN_BROKE: "it is not finite in these frames and left out of the ensemble; simulate with smaller steps "
    "(step_margin under [simulation])",
    EXACTLY_ZERO: "no prediction hits every vertex to the last digit; does the method read the reference, or does "
    "nothing move?",
    TRAINED_ON_IT: "a training error, which says nothing of other motions; test on a scene that isn't trained on",
    UNDER_LOAD: "wall time is far above processor time; the machine did other work, or the method waits for something; "
    "delete the run's folder and evaluate again on an idle machine",
}


@dataclass(frozen=True)
class Row:
    """One measured value. Its fields are the columns of results.csv, in their order.

    Attributes:
        preset, experiment: Of which report and table.
        scene, split, garment, motion, body: What was predicted.
        method, variant, train_frames, seed: By what.
        metric, horizon, value, unit: What was measured, over how many frames; NaN where there is no value.
        reference_value: The reference's own value, by the same code; None where it has none.
        spread: What another run of the simulator errs by over the same frames [cm], beside errors of roll-outs; None
            beside other metrics, and where the reference is a single run.
        status, first_bad_frame: How the roll-out ended: "ok", "broken", "diverged", "failed".
        run_id: The run that measured it; a message in parentheses where none could be made.
        train_scenes: What the method was trained on, names joined by "+".
        note: What a reader must know of the value: keys of `WARNINGS` joined by `BETWEEN`, or nothing.
    """

    preset: str = ""
    experiment: str = ""
    scene: str = ""
    split: str = ""
    garment: str = ""
    motion: str = ""
    body: str = ""
    method: str = ""
    variant: str = ""
    train_frames: int | None = None
    seed: int = 0
    metric: str = ""
    horizon: int | None = None
    value: float = math.nan
    unit: str = ""
    reference_value: float | None = None
    spread: float | None = None
    status: str = "ok"
    first_bad_frame: int | None = None
    run_id: str = ""
    train_scenes: str = ""
    note: str = ""

    @classmethod
    def of(cls, metric: Metric, value: float, **columns) -> "Row":
        """A metric's value, with its unit and, for no error at all, which no honest prediction has, a note."""
        if metric in (ROLLOUT_L2, ONE_STEP_L2) and value == 0:
            columns.setdefault("note", EXACTLY_ZERO)
        return cls(metric=metric.name, value=float(value), unit=metric.unit, **columns)

    def noted(self, note: str) -> "Row":
        """The row with a further note."""
        return replace(self, note=BETWEEN.join(filter(None, (self.note, note))))

    @property
    def measured(self) -> dict:
        """What a run keeps of it, as plain values: `Row(**measured)` is the row of an unnamed roll-out."""
        return {name: value for name, value in vars(self).items() if name in _MEASURED}


_MEASURED = {
    "metric",
    "horizon",
    "value",
    "unit",
    "reference_value",
    "spread",
    "status",
    "first_bad_frame",
    "note",
}


def notes(kept: Iterable[str | None]) -> list[str]:
    """Each note once, of the rows' columns `note`."""
    return list(dict.fromkeys(note for text in kept if text for note in text.split(BETWEEN)))


def warnings(rows: list[dict]) -> list[str]:
    """What has to be said beside noted values, once a note; rows as `Row.measured` gives them."""
    noted: dict[str, list[str]] = {}
    for row in rows:
        for note in notes([row.get("note")]):
            noted.setdefault(note, []).append(row["metric"])
    return [
        f"{', '.join(dict.fromkeys(names))}: {note}: {WARNINGS.get(note, '')}".removesuffix(": ")
        for note, names in noted.items()
    ]


COLUMNS = [field.name for field in fields(Row)]
