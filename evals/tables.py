"""The tables of a report."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from garmentbench.evals.convergence.table import CONVERGENCE, convergence_table, studies, trust_table
from garmentbench.evals.crosscheck.table import CROSSCHECK, crosscheck_table
from garmentbench.evals.data import DATA, cards_in, data_table
from garmentbench.evals.motions.table import MOTIONS, motions_table
from garmentbench.metrics import metric
from garmentbench.report.cells import ABSENT, best, number, paper_cell, status_cell, value_cell
from garmentbench.report.lines import REFERENCE, Line, Value, lines
from garmentbench.report.table import Cell, Table

if TYPE_CHECKING:
    import pandas

MAIN = (
    "interpenetration_before",
    "interpenetration",
    "self_intersection",
    "liveliness",
    "jitter",
    "skill",
    "ms_per_frame",
)
LADDER = (
    "change",
    "energy_left",
    "interpenetration",
    "self_intersection",
    "strain_p95",
    "strain_p99_max",
    "liveliness",
    "stable_frames",
)
STABILITY, NEEDS = "stability", "needs"
NAMES = {  # of the experiments, in the report's order; others follow under their own names
    "baselines": "Main table",
    "stick": "Sheet and stick",
    "ablations": "Ablations",
    "table3": "Wardrobe",
    "table4": "Training length",
    STABILITY: "Stress ladder",
    MOTIONS: "Motions",
    CONVERGENCE: "Convergence of the reference",
    CROSSCHECK: "Cross-check",
}
STRESS = "stress-"


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


def all_tables(results: "pandas.DataFrame") -> list[tuple[Table, list[Line]]]:
    """Every table of a report, in its order, with the lines that it is about."""
    present = list(dict.fromkeys(results.experiment))
    order = [e for e in NAMES if e in present] + [e for e in present if e not in (*NAMES, NEEDS, DATA)]
    made = []
    for experiment in order:
        found = lines(results, experiment)
        if experiment == STABILITY:
            made.append((stability_table(found), found))
            continue
        if experiment == CONVERGENCE:
            made += [(convergence_table(studies(results)), found), (trust_table(studies(results)), [])]
            continue
        if experiment == CROSSCHECK:
            made.append((crosscheck_table(found), found))
            continue
        if experiment == MOTIONS:
            made.append((motions_table(results), found))
            continue
        for scene in dict.fromkeys(line.scene for line in found):
            on_scene = [line for line in found if line.scene == scene]
            made.append((accuracy_table(on_scene), on_scene))
    made += [(needs_table(results), [])] if NEEDS in present else []
    return made + ([(data_table(cards_in(results)), [])] if DATA in present else [])


def accuracy_table(found: list[Line]) -> Table:
    """Methods on one scene: errors by horizon, each with the paper's where it has one, and what else was measured."""
    columns = _columns(found, MAIN)
    papers = [c for c in columns if any(_paper(line, c).text for line in found)]
    header = ["method"]
    rows = [[Cell("reference", note=True)]] + [[Cell(line.label)] for line in found]
    for column in columns:
        header.append(column.title)
        values = [line.value(column.metric, column.horizon) for line in found]
        winner = best(values, column.metric)
        cells = [_reference_cell(values)] + [value_cell(v, bold=v is winner and v is not None) for v in values]
        if column in papers:
            header.append("paper")
        for row, cell, line in zip(rows, cells, [None, *found], strict=True):
            row.append(cell)
            if column in papers:
                row.append(Cell(note=True) if line is None else _paper(line, column))
    header.append("status")
    rows[0].append(Cell(note=True))
    for row, line in zip(rows[1:], found, strict=True):
        row.append(status_cell(line))
    first = found[0]
    return Table(
        f"{first.experiment}-{first.scene}",
        f"{NAMES.get(first.experiment, first.experiment)}: {first.garment.replace('_', ' ')}, {first.motion}",
        _caption(found),
        header,
        rows,
        frozenset({0, len(header) - 1}),
    )


def _columns(found: list[Line], others: tuple[str, ...]) -> list[Column]:
    """The columns that any of the lines has a value for."""
    horizons = sorted({int(h) for line in found for h in line.rows.horizon[line.rows.metric == "rollout_l2"].dropna()})
    wanted = [Column("one_step_l2"), *(Column("rollout_l2", h) for h in horizons), *(Column(m) for m in others)]
    return [c for c in wanted if any((line.rows.metric == c.metric).any() for line in found)]


def _paper(line: Line, column: Column) -> Cell:
    rows = line.rows[line.rows.metric == column.metric]
    horizon = column.horizon if column.horizon is not None or len(rows) == 0 else int(rows.horizon.max())
    return paper_cell(line, column.metric, horizon)


def _reference_cell(values: list[Value | None]) -> Cell:
    """The reference's uncertainty where errors are measured against it, or its own value of a metric."""
    for value in values:
        if value is not None and not math.isnan(value.uncertainty):
            return Cell(f"± {value.uncertainty:.2g}", note=True)
        if value is not None and not math.isnan(value.reference):
            return Cell(number(value.reference), note=True)
    return Cell(ABSENT, note=True)


def _caption(found: list[Line]) -> str:
    seeds = max(line.rows.seed.nunique() for line in found)
    interval = (
        f"mean over {seeds} seeds ± half the 95 % confidence interval" if seeds > 1 else "one seed, hence no interval"
    )
    return (
        f"Scene {found[0].scene}; {interval}. Errors are mean distances to the reference, whose own uncertainty and values "
        "stand in the first line; bold: best by more than that uncertainty."
    )


def stability_table(found: list[Line]) -> Table:
    """The stress ladder: every case with every method, the simulator itself first, the unstressed scene first."""
    found = sorted(found, key=lambda line: (line.scene.startswith(STRESS), line.scene))
    columns = [c for c in _columns(found, LADDER) if c.metric not in ("one_step_l2", "rollout_l2")]
    rows = []
    for line in found:
        name = "reference (simulator)" if line.method == REFERENCE else line.label
        cells = [value_cell(line.value("rollout_l2"))]
        cells += [value_cell(line.value(c.metric), whole=metric(c.metric).unit == "frames") for c in columns]
        rows.append([Cell(case(line)), Cell(name), status_cell(line), *cells])
    return Table(
        STABILITY,
        NAMES[STABILITY],
        "Each case leaves what the methods were trained on in one way: stiffer cloth, a faster or frozen body, a pushed "
        "start, a heavier body, a scene far away and turned. The error is that of the whole roll-out.",
        ["case", "method", "status", "roll-out [cm]", *(c.title for c in columns)],
        rows,
        frozenset({0, 1, 2}),
    )


def case(line: Line) -> str:
    """The name of a stress case."""
    return line.scene.removeprefix(STRESS) if line.scene.startswith(STRESS) else "no stress"


def needs_table(results: "pandas.DataFrame") -> Table:
    """What was not built for a scene, and what that saved: metric "left_out:<part>", unit ms, MB or parameters."""
    rows = results[(results.experiment == NEEDS) & results.metric.str.startswith("left_out:")]
    units = ("ms", "MB", "parameters")
    cells = []
    for (scene, part), group in rows.groupby(["scene", "metric"], sort=True):
        saved = {unit: group.value[group.unit == unit].mean() for unit in units}
        counted = [number(v) if unit != "parameters" else f"{v:,.0f}" for unit, v in saved.items()]
        cells.append(
            [
                Cell(scene),
                Cell(part.removeprefix("left_out:").replace("_", " ")),
                *(Cell(ABSENT if math.isnan(saved[unit]) else text) for unit, text in zip(units, counted, strict=True)),
            ]
        )
    return Table(
        NEEDS,
        "What scenes do not need",
        "What a scene does not need is not built for it; the columns say what that saved against building it all the same.",
        ["scene", "left out", "saved [ms a frame]", "saved [MB]", "saved [parameters]"],
        cells,
        frozenset({0, 1}),
    )
