"""The tables of error against run time: every point, and what the simulator needs for each method's error."""

import math
from collections.abc import Sequence
from dataclasses import replace

from garmentbench.evals.error_time.pareto import SIMULATOR, Point, dominated_by, exponent, front, needed
from garmentbench.evaluation.results import UNDER_LOAD
from garmentbench.metrics.ensemble import ERROR
from garmentbench.report.cells import ABSENT, number
from garmentbench.report.lines import Line, label
from garmentbench.report.table import Cell, Table

MINUTES, VERTICES, GROWTH_MS = "training_minutes", "vertices", "growth_ms"
ON = "_on_"  # a variant of the growth's lines is this, what is before it, and the mesh

UNQUIET = "The machine did other work meanwhile, so points are compared by the processor's time. "


def point(line: Line) -> Point:
    """A line of results as a point."""
    error, ms = line.value(ERROR.name), line.value("ms_per_frame")
    numbers = {name: line.value(name) for name in ("ms_per_frame_p95", "ms_processor", MINUTES)}
    p95, own, minutes = (math.nan if v is None else v.mean for v in numbers.values())
    endings = line.endings if error is None else [*error.endings, *error.notes]
    return Point(
        line.label,
        line.method,
        math.nan if error is None else error.mean,
        None if error is None else error.interval,
        math.nan if ms is None else ms.mean,
        math.nan if ms is None else ms.mean,
        p95,
        own,
        minutes,
        math.nan if error is None else error.spread,
        "; ".join(dict.fromkeys(e for e in endings if e != "ok")),
        ms is not None and UNDER_LOAD in ms.notes,
    )


def points_table(name: str, title: str, scene: str, points: Sequence[Point], frames: int, seeds: int) -> Table:
    """Every point, the fastest first."""
    rows = []
    for p in sorted(points, key=lambda p: (math.isnan(p.ms), p.ms)):
        better = dominated_by(p, points)
        rows.append([
            Cell(p.label, note=better is not None), _error(p),
            _ms(p.wall_ms, p.loaded), _ms(p.p95), _ms(p.processor_ms),
            Cell(ABSENT if math.isnan(p.minutes) else "0" if p.minutes == 0 else number(p.minutes)),
            Cell(ABSENT if better is None else better.label), Cell(p.ending or "ok", bad=bool(p.ending)),
        ])  # fmt: skip
    spread = _spread(points)
    floor = "unknown" if math.isnan(spread) else f"{number(spread)} cm"
    clock = UNQUIET if any(p.loaded for p in points) else ""
    over = f"mean ± half the 95 % confidence interval over {seeds} seeds" if seeds > 1 else "one seed"
    return Table(
        name,
        f"{title}: {scene}",
        f"Mean distance to the runs of the reference over the first {frames} frames ({over}) against time a frame "
        f"(wall time, median and 95th percentile; one thread). Another run of the simulator errs by {floor}: errors "
        "below that count as that. The simulator is given fewer queries of the nearest point, XPBD's substeps, or a "
        "coarser mesh that is carried to the full one, and starts elsewhere than the reference. A point is dominated "
        "if another is no slower and errs no more; what broke, or is marked, doesn't compete. "
        f"{clock}{verdict(points)}",
        ["point", "error [cm]", "time a frame [ms]", "95th percentile [ms]", "processor [ms]", "training [min]",
         "dominated by", "status"],
        rows,
        frozenset({0, 6, 7}),
    )  # fmt: skip


def headline_table(name: str, title: str, scene: str, points: Sequence[Point]) -> Table:
    """What the simulator needs for each method's error."""
    simulated, rows = front([p for p in points if p.of_simulator]), []
    for p in sorted((p for p in points if p.competes and not p.of_simulator), key=lambda p: p.floored):
        if not simulated:
            rows.append([Cell(p.label), _error(p), _ms(p.ms), Cell("no budget ended well", bad=True), Cell(ABSENT)])
            continue
        asked = needed(p.floored, simulated)
        said, ratio = {
            "between": (number(asked.ms), number(asked.ms / p.ms)),
            "cheapest": (f"at most {number(asked.ms)}: it is already better at its cheapest point",
                         f"at most {number(asked.ms / p.ms)}"),
            "never": ("the simulator never gets there within the budget tried", ABSENT),
        }[asked.how]  # fmt: skip
        rows.append([Cell(p.label), _error(p), _ms(p.ms), Cell(said), Cell(ratio)])
    return Table(
        name,
        f"{title}, at equal error: {scene}",
        "For each method's error, the time that the simulator takes for it: on its own front of budgets, between "
        "neighbouring points the logarithm of the time is linear in the error. Speed-up: the simulator's time over the "
        "method's; below 1 the simulator is faster. Training is not counted."
        + (f" {UNQUIET.rstrip()}" if any(p.loaded for p in points) else ""),
        ["point", "error [cm]", "time a frame [ms]", "simulator at that error [ms]", "speed-up"],
        rows,
        frozenset({0, 3}),
    )


def verdict(points: Sequence[Point]) -> str:
    """One sentence: what the methods are worth against the simulator's budgets."""
    simulated = front([p for p in points if p.of_simulator])
    methods = [p for p in points if p.competes and not p.of_simulator]
    if not simulated or not methods:
        return "Too little ended well here to compare methods with the simulator."
    found = [(p, needed(p.floored, simulated)) for p in methods]
    ahead = [(n.ms / p.ms, p, n) for p, n in found if n.how == "between" and n.ms > p.ms]
    never = [p for p, n in found if n.how == "never"]
    behind = [p for p, n in found if n.how != "never" and n.ms < p.ms]
    parts = []
    if ahead:
        ratio, p, n = max(ahead, key=lambda each: each[0])
        parts.append(
            f"at equal error {len(ahead)} of {len(methods)} method points are faster than the simulator, "
            f"the most {p.label} ({number(ratio)} times: {number(p.ms)} against {number(n.ms)} ms "
            f"at {number(p.error)} cm)"
        )
    else:
        parts.append(f"at equal error none of {len(methods)} method points is known to be faster than the simulator")
    if behind:
        parts.append(f"{len(behind)} are slower")
    if never:
        parts.append(f"{len(never)} err less than any budget tried")
    least = min(methods, key=lambda p: p.floored)
    below = [p for p in simulated if p.floored < least.floored]
    if below:
        parts.append(f"below {number(least.floored)} cm, from {number(below[0].ms)} ms on, there is only the simulator")
    said = "; ".join(parts)
    return f"{said[0].upper()}{said[1:]}."


def growth_table(name: str, title: str, lines: Sequence[Line]) -> Table:
    """Time a frame by mesh, and the exponent of its growth."""
    known: dict[str, dict[int, float]] = {}
    for line in lines:
        vertices, ms = line.value(VERTICES), line.value(GROWTH_MS)
        found = known.setdefault(label(replace(line, variant=line.variant.partition(ON)[0])), {})
        if vertices is not None and ms is not None:
            found[round(vertices.mean)] = ms.mean
    meshes = sorted({v for found in known.values() for v in found})
    rows = []
    for what, found in sorted(known.items(), key=lambda item: (not item[0].startswith(SIMULATOR), item[0])):
        power = exponent(list(found), list(found.values()))
        times = [Cell(number(found[v]) if v in found else ABSENT) for v in meshes]
        rows.append([Cell(what), *times, Cell(ABSENT if math.isnan(power) else number(power))])
    return Table(
        name,
        f"{title}: growth with the mesh",
        "Median processor time a frame [ms] of the simulator and of methods with the networks of one size, on meshes "
        "of one garment, and the exponent p of time ~ vertices^p (least squares of logarithms). The networks are "
        "trained for a tenth of their steps, since times don't depend on what was learnt.",
        ["what", *(f"{v} vertices [ms]" for v in meshes), "exponent"],
        rows,
    )


def _spread(points: Sequence[Point]) -> float:
    return next((p.spread for p in points if math.isfinite(p.spread)), math.nan)


def _error(p: Point) -> Cell:
    if math.isnan(p.error):
        return Cell(ABSENT, bad=True)
    return Cell(number(p.error) + ("" if p.interval is None else f" ± {number(p.interval)}"), bad=bool(p.ending))


def _ms(ms: float, loaded: bool = False) -> Cell:
    return Cell(ABSENT if math.isnan(ms) else number(ms) + (f" ({UNDER_LOAD})" if loaded else ""), bad=loaded)
