"""The table of what scenes do not need: a line a part, with what leaving it out saves and what the error is then."""

import math
from typing import Any

import numpy as np

from garmentbench.evals.left_out.costs import PREFIX
from garmentbench.evals.left_out.otherwise import OtherwiseMotionGuided
from garmentbench.report.cells import ABSENT, number
from garmentbench.report.lines import Results, confidence_95
from garmentbench.report.table import Cell, Table

UNITS = {"ms": "ms a frame", "MB": "MB", "parameters": "parameters", "s": "s of training", "columns": "columns"}
ERROR = "rollout_l2"
CAPTION = (
    "What a scene does not need is not built for it. Saved: with the part less without it, negative where leaving it "
    "out costs time. Errors are those of free roll-outs [cm]; for parts of the simulator the difference is how far the "
    "cloth is from where it was, on average over 60 frames, and in brackets how far a push of 1 mm moves it. "
    "Lines of tuned are at the end, on the scene and on one for validation. "
)


def left_out_table(name: str, title: str, results: Results) -> Table:
    """The table of the rows of an experiment, and what it says of parts that change nothing."""
    rows = results.table[results.table.experiment == name]
    cells, silent = [], []
    for scene in dict.fromkeys(rows.scene):
        of_scene = rows[rows.scene == scene]
        parts = _reasons(of_scene, results)
        for part in dict.fromkeys(of_scene.metric[of_scene.metric.str.startswith(PREFIX)]):
            word = part.removeprefix(PREFIX)
            needed, because = parts.get(word, (None, ABSENT))
            shown, changes = _change(of_scene, word, part)
            told = word.replace("_", " ")
            cells.append([Cell(scene), Cell(told), Cell(_word(needed)), Cell(because), *_saved(of_scene, part), *shown])
            if needed and changes is False:
                silent.append(f"{told} on {scene}")
        cells += _tuned(scene, of_scene)
    saved = [f"saved [{unit}]" for unit in UNITS.values()]
    header = ["scene", "part", "needed", "because", *saved, "error with [cm]", "error without [cm]", "difference [cm]"]
    nothing = f"Needed, and it changes nothing that can be told: {'; '.join(silent)}." if silent else ""
    return Table(name, title, (CAPTION + nothing).strip(), header, cells, frozenset({0, 1, 2, 3}))


def _word(needed: bool | None) -> str:
    return ABSENT if needed is None else "yes" if needed else "no"


def _reasons(rows: Any, results: Results) -> dict[str, tuple[bool, str]]:
    """Of each part of a scene whether it is needed and why, as its run says."""
    runs = rows.run_id[rows.metric.str.startswith(PREFIX)].unique()
    kept = [part for run in runs if run for part in results.record(run).get("results", {}).get("parts", [])]
    return {part["name"]: (part["needed"], part["because"]) for part in kept}


def _saved(rows: Any, part: str) -> list[Cell]:
    """What leaving it out saves, in each unit."""
    cells = []
    for unit in UNITS:
        values = rows.value[(rows.metric == part) & (rows.unit == unit)]
        whole = unit in ("parameters", "columns")
        cells.append(Cell(ABSENT if values.empty else f"{values.mean():,.0f}" if whole else number(values.mean())))
    return cells


def _change(rows: Any, word: str, part: str) -> tuple[list[Cell], bool | None]:
    """Error with, without, and the difference; whether it changes anything, None where that isn't known."""
    direct = rows[(rows.metric == part) & (rows.unit == "cm")]
    if len(direct):
        apart, spread = float(direct.value.iloc[0]), float(direct.spread.iloc[0])
        push = "" if math.isnan(spread) else f" ({number(spread)})"
        limit = 0.0 if math.isnan(spread) else spread
        return [Cell(ABSENT), Cell(ABSENT), Cell("equal" if apart == 0 else number(apart) + push)], apart > limit
    ours = rows[(rows.method == OtherwiseMotionGuided.name) & (rows.metric == ERROR)]
    other = ours[ours.variant.isin([f"no_{word}", f"with_{word}"])]
    if other.empty:
        return [Cell(ABSENT)] * 3, None
    errors = [_errors(ours[ours.variant == "full"]), _errors(other)]
    built, left = errors if other.variant.iloc[0].startswith("no_") else errors[::-1]
    return _compared(built, left)


def _tuned(scene: str, rows: Any) -> list[list[Cell]]:
    """Lines of the parts of `tuned`, that it has anyway."""
    tuned = rows[(rows.method == "tuned") & (rows.metric == ERROR)]
    full = _errors(tuned[tuned.variant == "full"])
    where = " (validation)" if (rows.split == "validation").all() else ""
    cells = []
    for variant in (v for v in dict.fromkeys(tuned.variant) if v != "full"):
        shown, _ = _compared(full, _errors(tuned[tuned.variant == variant]))
        part = f"tuned: {variant.removeprefix('no_').replace('_', ' ')}"
        head = [Cell(scene + where), Cell(part), Cell(ABSENT), Cell(ABSENT)]
        cells.append([*head, *[Cell(ABSENT)] * len(UNITS), *shown])
    return cells


def _errors(rows: Any) -> dict[int, float]:
    """By seed, over the whole scene [cm]."""
    whole = rows[rows.horizon == rows.horizon.max()]
    return dict(zip(whole.seed, whole.value, strict=True))


def _compared(built: dict[int, float], left: dict[int, float]) -> tuple[list[Cell], bool | None]:
    """Mean errors with and without, and the mean difference of the same seeds with its 95 % interval."""
    both = [seed for seed in built if seed in left]
    change = np.array([left[seed] - built[seed] for seed in both])
    means = [float(np.mean([errors[s] for s in both])) if both else math.nan for errors in (built, left)]
    if not both or not np.isfinite(change).all():
        return [
            *(Cell(ABSENT if math.isnan(m) else number(m)) for m in means),
            Cell("failed or diverged", bad=True),
        ], None
    mean = float(change.mean())
    if not change.any():
        return [*(Cell(number(m)) for m in means), Cell("equal")], False
    interval = confidence_95(change) if len(change) > 1 else None
    shown = number(mean) + ("" if interval is None else f" ± {number(interval)}")
    return [*(Cell(number(m)) for m in means), Cell(shown)], None if interval is None else abs(mean) > interval
