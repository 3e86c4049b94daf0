"""The table of methods by what they were trained on, and the points of its plot."""

from garmentbench.evaluation.another_run import ANOTHER_RUN
from garmentbench.report.cells import ABSENT, value_cell
from garmentbench.report.lines import Line
from garmentbench.report.table import Cell, Table

NAME = "training_data"


def training_data_table(lines: list[Line], title: str) -> Table:
    """A row for each method and training set, a column for each test."""
    tests = list(dict.fromkeys(line.scene for line in lines))
    found = {(line.label, line.train_frames, line.train_scenes, line.scene): line for line in lines}
    kinds = sorted({key[:3] for key in found}, key=lambda k: (k[0] != "another run", k[0], k[1] or 0))
    rows = []
    for label, frames, trained in kinds:
        cells = [Cell(label), Cell(trained or ABSENT), Cell(f"{frames:,}" if frames else ABSENT)]
        of_tests = [found.get((label, frames, trained, test)) for test in tests]
        cells += [value_cell(None if line is None else line.value("rollout_l2")) for line in of_tests]
        rows.append(cells)
    return Table(
        NAME,
        title,
        "Every method keeps its number of optimiser steps whatever it is trained on, so what differs is what it saw.",
        ["method", "trained on", "frames", *(f"{test} [cm]" for test in tests)],
        rows,
        frozenset({0, 1}),
    )


def curves(lines: list[Line], scene: str) -> dict[str, list[tuple[int, float, float]]]:
    """Training frames, error [cm] and half its interval (0 where unknown) of each method on a scene, by its label, in
    the order of frames; methods that have no value at all are left out."""
    found: dict[str, list[tuple[int, float, float]]] = {}
    for line in lines:
        value = line.value("rollout_l2")
        if line.scene == scene and line.method != ANOTHER_RUN and value is not None and line.train_frames:
            found.setdefault(line.label, []).append((line.train_frames, value.mean, value.interval or 0.0))
    return {label: sorted(points) for label, points in found.items()}
