"""The validation table: a problem a row, what the simulator says at each mesh size, and what is true."""

import math
from dataclasses import dataclass

from garmentbench.evals.validation.case import order
from garmentbench.report.cells import ABSENT, number
from garmentbench.report.lines import Results
from garmentbench.report.table import Cell, Table

VALIDATION = "validation"
SIMULATED, LOW, HIGH = "simulated", "low", "high"
BAND = "band"  # the variant of the rows that say within what a value passes
SIZES = 3


@dataclass(frozen=True)
class Found:
    """What is known of a case.

    Attributes:
        name: Of the case.
        unit: Of its values.
        wanted: The exact value; NaN where there is only a band.
        low, high: Within what the finest value passes.
        values: By mesh size, from coarse to fine.
        message: Why there are none.
    """

    name: str
    unit: str
    wanted: float
    low: float
    high: float
    values: dict[str, float]
    message: str = ""

    @property
    def finest(self) -> float:
        """The value that is judged; NaN where there is none."""
        return next(reversed(self.values.values()), math.nan)

    @property
    def passed(self) -> bool:
        """Does the finest value lie where it must?"""
        return math.isfinite(self.finest) and self.low <= self.finest <= self.high


def read_cases(results: Results) -> list[Found]:
    """The cases of results.csv that the suite knows, in the suite's order."""
    from garmentbench.evals.validation.cases import CASES

    table = results.table[results.table.experiment == VALIDATION]
    found = []
    for name, case in CASES.items():
        rows = table[table.scene == name]
        if len(rows) == 0:
            continue
        values = {row.variant: row.value for row in rows[rows.metric == SIMULATED].itertuples()}
        bounds = {row.metric: row.value for row in rows[rows.variant == BAND].itertuples()}
        if LOW not in bounds:
            found.append(Found(name, case.unit, math.nan, math.nan, math.nan, {}, rows.run_id.iloc[0].strip("()")))
            continue
        ordered = {label: values[label] for label in case.sizes if label in values}
        wanted = float(rows.reference_value.dropna().iloc[0]) if rows.reference_value.notna().any() else math.nan
        found.append(Found(name, case.unit, wanted, bounds[LOW], bounds[HIGH], ordered))
    return found


def validation_table(found: list[Found]) -> Table:
    """A row a case; one that fails stays, red."""
    from garmentbench.evals.validation.cases import CASES

    rows = []
    for case in found:
        about = CASES[case.name]
        values = [(label, value) for label, value in case.values.items()]
        cells = [Cell(ABSENT)] * (SIZES - len(values)) + [Cell(_at(label, value)) for label, value in values]
        verdict = Cell("yes") if case.passed else Cell(f"no{': ' + case.message if case.message else ''}", bad=True)
        rows.append(
            [Cell(about.title), Cell(case.unit), *cells, Cell(_wanted(case)), Cell(_off(case), bad=not case.passed)]
            + [Cell(_order(case)), verdict, Cell(about.source)]
        )
    passed = sum(case.passed for case in found)
    return Table(
        VALIDATION,
        f"Validation: {passed} of {len(found)} pass",
        "The reference simulator on problems whose answers are known, the mesh finer from column to column (its edges, "
        "or their part of the length, stand in parentheses). Exact values are computed from the equations of "
        "the source. Off: of the finest value, in per cent of the exact one, or of its unit where that is 0. Order: of "
        "convergence, from the two finest; none where the error is as small as rounding, or does not fall. What fails "
        "stays in the table.",
        ["case", "unit", "coarse", "medium", "fine", "exact", "off [%]", "order", "passes", "source"],
        rows,
        frozenset({0, 1, 8, 9}),
    )


def _at(label: str, value: float) -> str:
    text = precise(value)
    return f"{text} ({label})" if label else text


def precise(value: float) -> str:
    """Four significant digits."""
    if not math.isfinite(value):
        return "not finite"
    return f"{value:.4g}".replace("-", "−") if abs(value) >= 5e-5 else "0"


def _wanted(case: Found) -> str:
    if math.isnan(case.low):
        return ABSENT
    return f"{case.low:g} to {case.high:g}" if math.isnan(case.wanted) else precise(case.wanted)


def _off(case: Found) -> str:
    if math.isnan(case.wanted) or not math.isfinite(case.finest):
        return ABSENT
    error = case.finest - case.wanted
    unit = "" if case.unit == "1" else f" {case.unit}"
    return number(100 * error / abs(case.wanted)) if case.wanted else f"{precise(error)}{unit}"


def _order(case: Found) -> str:
    if math.isnan(case.wanted):
        return ABSENT
    from garmentbench.evals.validation.cases import CASES

    sizes = [CASES[case.name].sizes[label] for label in case.values]
    found = order([value - case.wanted for value in case.values.values()], sizes, case.high - case.wanted)
    return ABSENT if math.isnan(found) else number(found)
