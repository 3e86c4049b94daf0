"""The stress ladder: stiff cloth, fast, frozen, pushed, heavy and far-away bodies, for simulator and methods alike.

The methods are the ones trained for the main table, on nothing of all this.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from garmentbench import sequence_file
from garmentbench.evals.accuracy_table import measured_columns
from garmentbench.evals.comparison import Comparison
from garmentbench.evals.experiment import Work, about, failed_row, first_failure, named
from garmentbench.evals.trial import FULL, Entry, Trial
from garmentbench.evaluation.results import Row
from garmentbench.evaluation.rollout import COMPLETE, DIVERGED, OK, RollOut
from garmentbench.geometry.cloth_rest import cloth_at_rest
from garmentbench.metrics import metric
from garmentbench.metrics.change import change
from garmentbench.metrics.energy_left import energy_left
from garmentbench.metrics.liveliness import vertex_areas
from garmentbench.report.cells import status_cell, value_cell
from garmentbench.report.lines import REFERENCE, Line
from garmentbench.report.table import Cell, Table
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.sequence import Sequence
from garmentbench.storage.jobs import Failure
from garmentbench.storage.runs import Run, RunStore

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section

UNSTRESSED = "tshirt-armspace-90"
STRESS = "stress-"  # how the names of the stressed scenes begin
CASES = ("stiff-denim", "stiff-leather", "stiff-1000", "speed-2", "speed-4", "frozen", "push", "heavy", "far")
QUICK = ("stiff-denim", "speed-4", "frozen", "push", "heavy", "far")  # the stiff end takes most of the time
UNCHANGED = ("stress-push", "stress-far")  # scenes that should end up as the unstressed one
COLUMNS = (
    "change",
    "energy_left",
    "interpenetration",
    "self_intersection",
    "strain_p95",
    "strain_p99_max",
    "liveliness",
    "stable_frames",
)
LADDER = (
    "The stress cases, each two thirds into the roll-out: the reference above, below it the methods, coloured by their "
    "error."
)


@dataclass(frozen=True, kw_only=True)
class Stability(Comparison):
    """A comparison with the simulator's own line in every case, and all cases in one table.

    Attributes:
        first_look: The test scenes where sequences are cut short: there time is short, too.
    """

    first_look: tuple[str, ...]

    def work(self, preset: Preset, seeds: int) -> Work:
        if preset.mesh.frame_limit is not None and self.tests != self.first_look:
            return replace(self, tests=self.first_look).work(preset, seeds)
        work, tests = super().work(preset, seeds), [load_scene(name) for name in self.tests]

        def rows(results: dict) -> list[Row]:
            return work.rows(results) + [row for scene in tests for row in self._simulator_rows(scene, preset, results)]

        return Work(work.jobs, rows)

    def _simulator_rows(self, scene: Scene, preset: Preset, results: dict[tuple, Any]) -> list[Row]:
        """The rows of the reference simulation's own line."""
        columns = about(self.table, preset, scene, REFERENCE)
        paths = results["sequence", scene.name], results["sequence", UNSTRESSED]
        failure = first_failure(*paths)
        return (
            [failed_row(columns, failure)]
            if failure
            else [named(r, columns) for r in simulator_measures(scene, *paths)]
        )

    def measured(self, trial: Trial, run: Run, results: dict[tuple, Any]) -> list[Row]:
        """What a method's roll-out measured, and beside it what only some cases have."""
        rows, plain = super().measured(trial, run, results), results["evaluate", trial.trained, UNSTRESSED]
        if isinstance(plain, Failure) or not isinstance(trial.test, Scene):
            return rows
        stressed, unstressed = (RollOut.load(r.folder / "rollout.h5") for r in (run, RunStore().get(plain)))
        return rows + method_measures(trial.test, results["sequence", trial.test.name], stressed, unstressed)

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.report.page import Picture, Section
        from garmentbench.report.strips import stress_strip

        lines = sorted(results.lines(self.table, self.label, self.order), key=_case_order)
        ran = [line for line in lines if line.run_ids]
        cases = {case(line): [other for other in ran if other.scene == line.scene] for line in ran}
        strip = [Picture(f"strips/{self.name}.jpg", LADDER, stress_strip(cases, results.excerpt))] if ran else []
        return [Section(stability_table(lines, self.title), strip, lines=lines)]


STABILITY = Stability(
    name="stability",
    table="stability",
    title="Stress ladder",
    train=("tshirt-armspace-75",),
    tests=(UNSTRESSED, *(f"{STRESS}{case}" for case in CASES)),
    first_look=(UNSTRESSED, *(f"{STRESS}{case}" for case in QUICK)),
    entries=(Entry("skinning"), Entry("linear_subspace"), FULL),
)


def _case_order(line: Line) -> tuple:
    return line.scene.startswith(STRESS), line.scene


def case(line: Line) -> str:
    """The name of a stress case."""
    return line.scene.removeprefix(STRESS) if line.scene.startswith(STRESS) else "no stress"


def stability_table(lines: list[Line], title: str) -> Table:
    """Every case with every method, the simulator itself first, the unstressed scene first."""
    columns = measured_columns(lines, COLUMNS)
    rows = []
    for line in lines:
        name = "reference (simulator)" if line.method == REFERENCE else line.label
        cells = [value_cell(line.value("rollout_l2"))]
        cells += [value_cell(line.value(c.metric), whole=metric(c.metric).unit == "frames") for c in columns]
        rows.append([Cell(case(line)), Cell(name), status_cell(line), *cells])
    return Table(
        STABILITY.name,
        title,
        "Each case leaves what the methods were trained on in one way: stiffer cloth, a faster or frozen body, a "
        "pushed start, a heavier body, a scene far away and turned. The error is that of the whole roll-out.",
        ["case", "method", "status", "roll-out [cm]", *(c.title for c in columns)],
        rows,
        frozenset({0, 1, 2}),
    )


def simulator_measures(scene: Scene, path: Path, unstressed: Path) -> list[Row]:
    """Rows of the reference simulation's own line: is it finite, how far is it stretched, does it come to rest?"""
    sequence = sequence_file.load(path)
    simulated = sequence.info["simulation"]
    plain = sequence_file.load(unstressed, len(sequence)).garment
    values = sequence.scores | _stress_values(scene, sequence, sequence.garment, plain)
    columns = {
        "horizon": len(sequence),
        "status": OK if simulated["status"] == "ok" else DIVERGED,
        "first_bad_frame": simulated["first_bad_frame"],
    }
    return [Row.of(metric(name), value, **columns) for name, value in values.items()]


def method_measures(scene: Scene, path: Path, roll_out: RollOut, unstressed: RollOut) -> list[Row]:
    """Rows that a method's line has beside its usual ones."""
    if roll_out.status not in COMPLETE:
        return []
    sequence = sequence_file.load(path)
    values = _stress_values(scene, sequence, roll_out.garment, unstressed.garment)
    columns = {"horizon": len(sequence), "status": roll_out.status, "first_bad_frame": roll_out.first_bad_frame}
    return [Row.of(metric(name), value, **columns) for name, value in values.items()]


def _stress_values(scene: Scene, sequence: Sequence, garment: np.ndarray, plain: np.ndarray) -> dict[str, float]:
    """Values that only some cases have. garment, plain: [m], shape (T, V, 3), stressed and not."""
    values = {}
    template = sequence.template.garment
    if scene.motion.freeze_after is not None and len(garment) > scene.motion.freeze_after:
        values["energy_left"] = energy_left(
            garment, scene.motion.freeze_after, vertex_areas(cloth_at_rest(template), template.faces)
        )
    if scene.name in UNCHANGED:
        values["change"] = change(garment, plain, scene.motion.turn, scene.motion.translate)
    return values
