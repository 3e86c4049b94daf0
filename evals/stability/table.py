"""The ladder's tables: a sentence about each method and simulator, and every line with all its numbers."""

from garmentbench.evals.stability.standing import Standing
from garmentbench.report.cells import ABSENT, number
from garmentbench.report.table import Cell, Table

HEADER = (
    "rung",
    "method",
    "passed",
    "95 % interval [%]",
    "first bad frame",
    "rule",
    "largest strain [%]",
    "most inside [%]",
    "growth [1/s]",
    "energy",
    "energy left [%]",
    "moved by [cm]",
)
WORDS = frozenset({0, 1, 2, 3, 5})
VALUES = ("strain_p99_max", "inside_max", "growth_rate", "energy_max", "energy_left", "change")
NAMED = 4  # rungs that a sentence names


def ladder_table(found: list[Standing], name: str, title: str) -> Table:
    """Every rung with every method, the simulators first."""
    rows = [[Cell(s.rung.title), Cell(s.label), *_ended(s), *(_cell(s.value(v), v) for v in VALUES)] for s in found]
    most = max((s.count for s in found), default=0)
    return Table(
        name,
        f"{title}: every line",
        f"A rung is passed where all of its {most} starts are (fewer where the table says so). The interval is "
        "Wilson's, of the share of starts that pass. First bad frame: the earliest of all starts, and the rule that "
        "broke. Largest strain, most inside: the worst frame of all starts, its 99th percentile of the edges, its "
        "share of the vertices. Growth: at which rate two starts that differ by a push come apart (above 0) or "
        "together. Energy: the liveliest frame's, over the reference's liveliest. Energy left: of the motion, a second "
        "and more after the body has come to rest. Moved by: how far it ends from where it would be unmoved.",
        list(HEADER),
        rows,
        WORDS,
    )


def _ended(standing: Standing) -> list[Cell]:
    """How many starts passed, their interval, the first bad frame and its rule."""
    if not standing.count:
        return [Cell("failed", bad=True), *(Cell(ABSENT) for _ in range(3))]
    low, high = standing.interval
    count = Cell(f"{standing.passed} of {standing.count}", bad=not standing.whole)
    interval = Cell(f"{100 * low:.0f} to {100 * high:.0f}")
    first = standing.first
    if first is None:
        return [count, interval, Cell(ABSENT), Cell(ABSENT)]
    return [count, interval, Cell(f"{first['first_bad_frame']:.0f}"), Cell(first["rule"])]


def _cell(value: float | None, name: str) -> Cell:
    if value is None:
        return Cell(ABSENT)
    return Cell(f"{value:.3g}" if abs(value) >= 1e4 else number(value))


def verdict_table(found: list[Standing], name: str, title: str) -> Table:
    """A sentence about each method and simulator."""
    by_label: dict[str, list[Standing]] = {}
    for standing in found:
        by_label.setdefault(standing.label, []).append(standing)
    return Table(
        name,
        title,
        "Each rung leaves what the methods were trained on in one way, and is climbed from several starts: moments of "
        "the step, and small pushes. A start is passed where the cloth stays finite, near the body, stretched to less "
        "than twice its length, less than a quarter of it inside the body, and no faster than three times the body. "
        "The simulators are judged as the methods are. What passes is stable, and may still be wrong.",
        ["method", "verdict"],
        [[Cell(label), Cell(verdict(of))] for label, of in by_label.items()],
        frozenset({0, 1}),
    )


def verdict(of: list[Standing]) -> str:
    """What the numbers say of one method or simulator, in a sentence."""
    starts, passed = sum(s.count for s in of), sum(s.passed for s in of)
    bad = sorted((s for s in of if not s.whole), key=lambda s: s.passed / max(s.count, 1))
    climbed = f"{len(of) - len(bad)} of {len(of)} rungs ({passed} of {starts} starts)"
    if not bad:
        low, _ = min(s.interval for s in of)
        return f"Passes {climbed}; on each of them {100 * (1 - low):.0f} % of all starts could still fail."
    named = "; ".join(_failed(s) for s in bad[:NAMED])
    more = f"; and {len(bad) - NAMED} more" if len(bad) > NAMED else ""
    return f"Passes {climbed}. It does not pass: {named}{more}."


def _failed(standing: Standing) -> str:
    first = standing.first
    if first is None:
        return f"{standing.rung.title} (could not be run)"
    failed = f"{standing.count - standing.passed} of {standing.count}"
    return f"{standing.rung.title} ({failed}, {first['rule']} at frame {first['first_bad_frame']})"
