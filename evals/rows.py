"""results.csv: one row a measured value, in the columns and order that design fixes."""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from garmentbench.evaluation.results import COLUMNS
from garmentbench.metrics.skill import SKILL, skill
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.storage.atomic import write_text
from garmentbench.storage.jobs import Failure


def about(
    table: str, preset: Preset, scene: Scene, method: str, variant: str, train_frames: int | None, seed: int
) -> dict:
    """The columns that say what a row is about."""
    return {
        "preset": preset.name,
        "experiment": table,
        "scene": scene.name,
        "split": scene.split,
        "garment": scene.garment,
        "motion": scene.motion.name,
        "body": scene.body,
        "method": method,
        "variant": variant,
        "train_frames": train_frames,
        "seed": seed,
    }


def failed_row(columns: dict, failure: Failure) -> dict:
    """The row of a line that could not be computed at all: it stays in the tables, with its status."""
    return columns | {
        "metric": "rollout_l2",
        "value": math.nan,
        "unit": "cm",
        "status": "failed",
        "run_id": f"({failure.message})",
    }


def with_skill(rows: list[dict]) -> list[dict]:
    """The rows and `skill` beside each rollout_l2: 1 - error / skinning's error on the same frames."""

    def frames(row: dict) -> tuple:
        return row["scene"], row["horizon"]

    errors = [r for r in rows if r["metric"] == "rollout_l2" and r["status"] == "ok"]
    skinning = {frames(r): r["value"] for r in errors if r["method"] == "skinning"}
    skills = [
        r
        | {"metric": SKILL.name, "value": skill(r["value"], skinning[frames(r)]), "unit": SKILL.unit}
        | {"uncertainty": None, "note": ""}
        for r in errors
        if frames(r) in skinning
    ]
    return [r for r in rows if r["metric"] != SKILL.name] + skills


def merged(path: Path, rows: list[dict], replaced: Iterable[str] = ()) -> list[dict]:
    """The rows, and those of the results.csv at `path` that are about other lines, but none of the experiments `replaced`."""
    import pandas

    def line(row: dict) -> tuple:
        return tuple(str(row[c]) for c in ("experiment", "scene", "method", "variant", "seed"))

    if not path.is_file():
        return rows
    new, gone = {line(row) for row in rows}, set(replaced)
    old = pandas.read_csv(path, dtype={"horizon": "Int64", "train_frames": "Int64", "first_bad_frame": "Int64"})
    return rows + [row for row in old.to_dict("records") if line(row) not in new and row["experiment"] not in gone]


def write_results(path: Path, rows: Iterable[dict[str, Any]]) -> None:
    """Write results.csv: rows in a fixed order, numbers with 6 digits."""
    import pandas

    table = pandas.DataFrame(with_skill(list(rows)), columns=COLUMNS)
    table = table.astype({"horizon": "Int64", "train_frames": "Int64", "first_bad_frame": "Int64"})
    table = table.sort_values(list(COLUMNS[1:13])).drop_duplicates()
    write_text(path, table.to_csv(index=False, float_format="%.6g"))
