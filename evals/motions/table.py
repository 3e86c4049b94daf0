"""The motions' table: how far each is from those that methods are trained on."""

import math

import numpy as np

from garmentbench.errors import UserError
from garmentbench.report.cells import ABSENT, number, status_cell
from garmentbench.report.lines import Line, Results
from garmentbench.report.table import Cell, Table

MOTIONS = "motions"
POINTS = "motions.npz"  # in the run's folder: a motion's points on the plane, shape (poses, 2), under its label
SPLITS = ("train", "validation", "test")
TRAINED = ("armspace-75", "dance-latin")
APART = "apart_from:"  # a metric's name is this and a training motion's


def motion_label(scene: str) -> str:
    """A motion's name for people: the scene's without the garment.

    Recorded clips are all called "clip", their scenes not.
    """
    return scene.split("-", 1)[-1]


def motions_table(lines: list[Line]) -> Table:
    """Distances of each motion's poses from the nearest training pose.

    Those trained on first, then those that settings are chosen on; the nearest first.
    """
    rows = []
    for line in lines:
        values = [line.value(APART + name) for name in TRAINED]
        apart = [math.nan if value is None else value.mean for value in values]
        rows.append((line.rows.split.iloc[0], min(apart), line, apart))
    rows.sort(key=lambda row: (SPLITS.index(row[0]), row[1], row[2].scene))
    return Table(
        MOTIONS,
        "Motions",
        "How far the poses of each motion are from the nearest pose of the two motions that most is trained on: mean "
        "distance of 64 points on the base body, whatever its place and heading. The map shows the same poses, nearest "
        "ones side by side (t-SNE, in the manner of figure 5 of the paper; its axes have no unit and distances between "
        "far groups no meaning).",
        ["motion", "split", *(f"from {name} [cm]" for name in TRAINED), "status"],
        [
            [Cell(motion_label(line.scene)), Cell(split), *map(_distance, apart), status_cell(line)]
            for split, _, line, apart in rows
        ],
        frozenset({0, 1, 2 + len(TRAINED)}),
    )


def _distance(cm: float) -> Cell:
    return Cell(ABSENT if math.isnan(cm) else number(cm))


def read_points(results: Results) -> dict[str, tuple[str, np.ndarray]]:
    """Each motion's split and points on the plane, shape (poses, 2); none where it failed.

    Raises `UserError` where the run is missing.
    """
    rows = results.table[(results.table.experiment == MOTIONS) & (results.table.status == "ok")]
    if len(rows) == 0:
        return {}
    path = results.runs_root / rows.run_id.iloc[0] / POINTS
    if not path.is_file():
        raise UserError(f"{path}: named in results.csv, but missing; `garmentbench evals {MOTIONS}` makes it")
    with np.load(path) as file:
        found = sorted({(motion_label(scene), split) for scene, split in zip(rows.scene, rows.split, strict=True)})
        return {motion: (split, file[motion]) for motion, split in found}
