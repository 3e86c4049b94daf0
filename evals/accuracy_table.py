"""The table of a comparison's accuracy: methods on one scene, errors by horizon and what else was measured."""

import math
from dataclasses import dataclass

from garmentbench.evals.paper_numbers import paper_cell
from garmentbench.metrics import metric
from garmentbench.metrics.push_growth import PUSH_GROWTH, regime
from garmentbench.report.cells import ABSENT, best, competing, number, status_cell, value_cell
from garmentbench.report.lines import SIMULATED, Line, Value
from garmentbench.report.table import Cell, Table

MAIN = (  # the main table's columns after the errors against the first run
    "error",
    "error_over_spread",
    "interpenetration_before",
    "interpenetration",
    "self_intersection",
    "liveliness",
    "jitter",
    "skill",
    "novelty_correlation",
    "ms_per_frame",
)
PAPER = (
    " The paper does not define its L2; were it a mean over coordinates, it would be half of ours. Its columns show an "
    "order of magnitude."
)


@dataclass(frozen=True)
class Column:
    """A column of measured values: a metric at a horizon (None: the longest there is)."""

    metric: str
    horizon: int | None = None

    @property
    def title(self) -> str:
        name = f"rollout-{self.horizon}" if self.metric == "rollout_l2" else metric(self.metric).title
        unit = metric(self.metric).unit.replace("^2", "²")
        return name if unit == "1" else f"{name} [{unit}]"


def accuracy_table(found: list[Line], title: str) -> Table:
    """Methods on one scene: errors by horizon, each with the paper's where it has one, and what else was measured."""
    columns = errors(found) + measured_columns(found, MAIN)
    header = ["method"]
    rows = [[Cell("reference", note=True)]] + [[Cell(line.label)] for line in found]
    unsettled = compared = False
    for column in columns:
        header.append(column.title)
        values = [line.value(column.metric, column.horizon) for line in found]
        methods = [value for line, value in zip(found, values, strict=True) if line.method not in SIMULATED]
        winner = best(methods, column.metric)
        unsettled |= len(competing(methods)) > 1 and not all(value.settled for value in competing(methods))
        cells = [_reference_cell(values)] + [value_cell(v, bold=v is winner and v is not None) for v in values]
        papers = [paper_cell(line, column.metric, column.horizon) for line in found]
        shown = any(cell.text for cell in papers)
        header += ["paper"] if shown else []
        compared |= shown and metric(column.metric).unit == "cm"
        for row, cell, paper in zip(rows, cells, [Cell(note=True), *papers], strict=True):
            row += [cell, paper] if shown else [cell]
    header.append("status")
    rows[0].append(Cell(note=True))
    for row, line in zip(rows[1:], found, strict=True):
        row.append(status_cell(line))
    first = found[0]
    return Table(
        f"{first.experiment}-{first.scene}",
        f"{title}: {first.garment.replace('_', ' ')}, {first.motion}{_role(first)}",
        _caption(found, unsettled, any(cell.bold for row in rows for cell in row)) + (PAPER if compared else ""),
        header,
        rows,
        frozenset({0, len(header) - 1}),
    )


def _role(line: Line) -> str:
    """What a scene is where it is no test: settings are chosen on it."""
    return " (validation, no test)" if (line.rows.split == "validation").any() else ""


def errors(found: list[Line]) -> list[Column]:
    """The columns of errors: one step, and the roll-out at each horizon that any of the lines has."""
    horizons = sorted({int(h) for line in found for h in line.rows.horizon[line.rows.metric == "rollout_l2"].dropna()})
    return measured_columns(found, ("one_step_l2",)) + [Column("rollout_l2", h) for h in horizons]


def measured_columns(found: list[Line], metrics: tuple[str, ...]) -> list[Column]:
    """A column for each metric that any of the lines has."""
    return [Column(m) for m in metrics if any((line.rows.metric == m).any() for line in found)]


def _reference_cell(values: list[Value | None]) -> Cell:
    """The reference's own value of a metric, where it has one."""
    for value in values:
        if value is not None and not math.isnan(value.reference):
            return Cell(number(value.reference), note=True)
    return Cell(ABSENT, note=True)


def _caption(found: list[Line], unsettled: bool, bold: bool) -> str:
    """What the table's cells hold. `unsettled`: in some columns nothing is bold, for a value of a single training with
    chance in it; `bold`: something is bold."""
    methods = [line for line in found if line.method not in SIMULATED]
    seeds = max((line.rows.seed.nunique() for line in methods), default=1)
    ran = [line for line in methods if line.run_ids]
    once = "methods whose training has chance in it were trained once, and by how much another training would move them"
    if seeds > 1:
        interval = f"mean over {seeds} seeds ± half the 95 % confidence interval"
    elif ran and not any(line.random for line in ran):
        interval = "none of the methods has chance in its training, so one seed of each"
    else:
        interval = "one seed"
    if unsettled and not bold:
        rule = f"nothing is bold, since {once} isn't known"
    else:
        rule = "bold: better than every other method by more than the spread, with intervals that do not overlap"
        rule += f"; nothing in other columns, where {once} isn't known" if unsettled else ""
    return (
        f"Scene {found[0].scene}{_regime(found)}; {interval}. 1-step and roll-out are mean distances to the run of the "
        "reference that the method begins in, whose own values stand in the first line; error is that to all its runs. "
        f"Another run of the simulator errs by the spread, and nobody need do better; {rule}."
    )


def _regime(found: list[Line]) -> str:
    """Whether the scene is contracting or chaotic, as its further runs say; nothing where there are none."""
    growths = [value.mean for line in found if (value := line.value(PUSH_GROWTH.name)) is not None]
    return f", {regime(growths[0])} (a push of 1 mm is {growths[0]:.2g} mm in its last fifth)" if growths else ""
