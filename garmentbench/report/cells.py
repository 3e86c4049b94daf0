"""From measured values to what stands in a cell."""

import math

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
    """Mean ± interval, and what must be known of it: that it broke, in how many of the seeds; "diverged" or "failed"
    where there is no value."""
    if value is None:
        return Cell(ABSENT)
    ended = "; ".join(dict.fromkeys(ending.split(" at ")[0] for ending in value.endings if ending != "ok"))
    if math.isnan(value.mean):
        return Cell(ended or ABSENT, bad=bool(ended))
    text = number(value.mean, whole) + (f" ± {number(value.interval, whole)}" if value.interval is not None else "")
    if ended and len(value.endings) < value.seeds:
        ended = f"{len(value.endings)} of {value.seeds} {ended}"
    if said := [text for text in (ended, *value.notes) if text]:
        return Cell(f"{text} ({'; '.join(said)})", bad=True)
    return Cell(text, bold=bold)


def status_cell(line: Line) -> Cell:
    """How a line's roll-outs ended: "ok", or each way with its first bad frame."""
    endings = line.endings
    if set(endings) == {"ok"}:
        return Cell("ok")
    if len(endings) == 1:
        return Cell(endings[0], bad=True)
    return Cell("; ".join(f"{endings.count(e)} {e}" for e in dict.fromkeys(endings)), bad=True)


def best(values: list[Value | None], name: str) -> Value | None:
    """The value that is better than every other beyond doubt; None where there is none.

    Beyond doubt: it differs from every other by more than the spread (what another run of the simulator errs by), their
    intervals over the seeds do not overlap, and neither comes from a single training with chance in it, of which nobody
    knows how far another would move it. Nothing is best below the spread: what errs by no more than another run of the
    simulator can't be told from it, and all such values are a tie. What failed in some seeds, or has a note, doesn't
    compete; where the spread isn't known nothing is best.
    """
    merit = {"low": lambda x: -x, "high": lambda x: x, "one": lambda x: -abs(x - 1.0)}[metric(name).best]
    running = competing(values)
    if len(running) < 2 or not all(v.settled for v in running):
        return None
    first, *others = sorted(running, key=lambda v: -merit(v.mean))
    clear = all(abs(first.mean - v.mean) > max(first.spread, _both_intervals(first, v)) for v in others)
    return first if clear and first.mean > first.spread else None  # neither holds of NaN


def competing(values: list[Value | None]) -> list[Value]:
    """Those that may be best: all seeds have one, and nothing is noted."""
    return [v for v in values if v is not None and not v.endings and not v.notes]


def _both_intervals(one: Value, other: Value) -> float:
    return (one.interval or 0.0) + (other.interval or 0.0)
