"""The cross-check's table: the reference beside an independent engine on the same scenes."""

import math

from garmentbench.evals.convergence.table import centimetres
from garmentbench.report.cells import ABSENT, number, status_cell
from garmentbench.report.lines import Line, Value
from garmentbench.report.table import Cell, Table

CROSSCHECK = "crosscheck"
ENGINE = "newton_vbd"
COMPARED = {
    "full": "as it is",
    "substeps_x2": "Newton with twice the substeps",
}


def crosscheck_table(found: list[Line]) -> Table:
    """Each comparison: how far the engines are apart beside the spread of the reference's runs, and what each has of
    its own."""
    rows = []
    for line in found:
        apart, high = line.value("difference"), line.value("difference_p95")
        rows.append(
            [
                Cell(line.scene),
                Cell(COMPARED.get(line.variant, line.variant)),
                centimetres(_mean(apart), bold=line.variant == "full"),
                centimetres(_mean(high)),
                Cell(ABSENT) if apart is None or math.isnan(apart.spread) else centimetres(apart.spread),
                _both(line.value("interpenetration_strict")),
                _both(line.value("ms_per_frame")),
                _strips(line),
                status_cell(line),
            ]
        )
    return Table(
        CROSSCHECK,
        "Cross-check against Newton's VBD",
        "The same cloth on the same body in an independent engine, from the same start through the same warm-up. Its "
        "stiffness is fitted so that a hanging and a clamped strip end where the reference's do; what is left of their "
        "difference is in the column match. Where two values stand, the first is Newton's and the second the "
        "reference's.",
        [
            "scene",
            "compared",
            "apart [cm]",
            "95th percentile [cm]",
            "reference's spread [cm]",
            "inside [%]",
            "time a frame [ms]",
            "match: hanging, clamped [%]",
            "status",
        ],
        rows,
        frozenset({0, 1, 8}),
    )


def _mean(value: Value | None) -> float:
    return math.nan if value is None else value.mean


def _both(value: Value | None) -> Cell:
    """Newton's and the reference's own."""
    if value is None or math.isnan(value.mean):
        return Cell(ABSENT)
    return Cell(f"{number(value.mean)}, {ABSENT if math.isnan(value.reference) else number(value.reference)}")


def _strips(line: Line) -> Cell:
    values = [_mean(line.value(name)) for name in ("match_hanging", "match_cantilever")]
    return Cell(ABSENT) if any(map(math.isnan, values)) else Cell(", ".join(number(v) for v in values))
