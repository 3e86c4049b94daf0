"""From measured values to what stands in a cell."""

import math

from garmentbench.evals.paper_numbers import paper_number
from garmentbench.metrics import metric
from garmentbench.report.lines import Line, Value
from garmentbench.report.table import Cell

ABSENT = "–"


def number(value: float, whole: bool = False) -> str:
    """Three significant digits or so: two decimals below 10, one below 100, none above or for `whole` numbers.

    >>> [number(x) for x in (0.004, 0.0, 1.234, 45.67, 1150.0)]
    ['< 0.01', '0.00', '1.23', '45.7', '1150']
    """
    if whole:
        return f"{value:.0f}"
    size = abs(value)
    if 0 < size < 0.005:
        return "< 0.01" if value > 0 else "> −0.01"
    text = f"{value:.{2 if size < 9.995 else 1 if size < 99.95 else 0}f}"
    return text.replace("-", "−")


def value_cell(value: Value | None, bold: bool = False, whole: bool = False) -> Cell:
    """Mean ± interval; "diverged" or "failed" where there is no value; both where only some seeds have one."""
    if value is None:
        return Cell(ABSENT)
    ended = "; ".join(dict.fromkeys(ending.split(" at ")[0] for ending in value.endings if ending != "ok"))
    if math.isnan(value.mean):
        return Cell(ended or ABSENT, bad=bool(ended))
    text = number(value.mean, whole) + (f" ± {number(value.interval, whole)}" if value.interval is not None else "")
    if ended:
        return Cell(f"{text} ({len(value.endings)} of {value.seeds} {ended})", bad=True)
    return Cell(text, bold=bold)


def status_cell(line: Line) -> Cell:
    """How a line's roll-outs ended: "ok", or each way with its first bad frame."""
    endings = line.endings
    if set(endings) == {"ok"}:
        return Cell("ok")
    if len(endings) == 1:
        return Cell(endings[0], bad=True)
    return Cell("; ".join(f"{endings.count(e)} {e}" for e in dict.fromkeys(endings)), bad=True)


def paper_cell(line: Line, metric: str, horizon: int) -> Cell:
    """The paper's number beside ours, where it has one: for the full model, by its training length."""
    if line.method != "motion_guided" or not (line.variant == "full" or line.variant.startswith("train_")):
        return Cell(note=True)
    found = paper_number(line.garment, line.motion, line.train_frames, metric, horizon)
    return Cell(number(found.value) if found else "", note=True)


def best(values: list[Value | None], name: str) -> Value | None:
    """The best of a metric's values, if it is so by more than the reference's uncertainty; None if none is, or where
    that isn't known. What failed in some seeds doesn't compete."""
    merit = {"low": lambda x: -x, "high": lambda x: x, "one": lambda x: -abs(x - 1.0)}[metric(name).best]
    running = [v for v in values if v is not None and not v.endings]
    if len(running) < 2:
        return None
    first, second = sorted(running, key=lambda v: -merit(v.mean))[:2]
    return first if abs(first.mean - second.mean) > first.uncertainty else None  # no where the uncertainty is NaN
