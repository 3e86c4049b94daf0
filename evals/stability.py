"""The stress ladder: stiff cloth, fast, frozen, pushed, heavy and far-away bodies, for simulator and methods alike.

The methods are the ones trained for the main table, on nothing of all this.
"""

from pathlib import Path

import numpy as np

from garmentbench import sequence_file
from garmentbench.evals.experiment import FULL, Entry, Experiment
from garmentbench.evaluation.results import Row
from garmentbench.evaluation.rollout import DIVERGED, OK, RollOut
from garmentbench.metrics import metric
from garmentbench.metrics.change import change
from garmentbench.metrics.energy_left import energy_left
from garmentbench.metrics.liveliness import vertex_areas
from garmentbench.scenes.scene import Scene
from garmentbench.sequence import Sequence

UNSTRESSED = "tshirt-armspace-90"
CASES = ("stiff-10", "stiff-100", "speed-2", "speed-4", "frozen", "push", "heavy", "far")
UNCHANGED = ("stress-push", "stress-far")  # scenes that should end up as the unstressed one

STABILITY = Experiment(
    name="stability",
    table="stability",
    train="tshirt-armspace-75",
    tests=(UNSTRESSED, *(f"stress-{case}" for case in CASES)),
    entries=(Entry("skinning"), Entry("linear_subspace"), FULL),
    simulator=True,
)


def simulator_measures(scene: Scene, path: Path, unstressed: Path) -> list[dict]:
    """Rows of the reference simulation's own line: is it finite, how far is it stretched, does it come to rest?"""
    sequence = sequence_file.load(path)
    simulated = sequence.info["simulation"]
    plain = sequence_file.load(unstressed, len(sequence)).garment
    values = sequence.scores | _stress_values(scene, sequence, sequence.garment, plain)
    columns = {
        "horizon": len(sequence),
        "uncertainty": sequence.uncertainty_cm,
        "status": OK if simulated["status"] == "ok" else DIVERGED,
        "first_bad_frame": simulated["first_bad_frame"],
    }
    return [Row.of(metric(name), value, **columns).measured for name, value in values.items()]


def method_measures(scene: Scene, path: Path, roll_out: RollOut, unstressed: RollOut) -> list[dict]:
    """Rows that a method's line has beside its usual ones."""
    if roll_out.status != OK:
        return []
    sequence = sequence_file.load(path)
    values = _stress_values(scene, sequence, roll_out.garment, unstressed.garment)
    return [Row.of(metric(name), value, horizon=len(sequence)).measured for name, value in values.items()]


def _stress_values(scene: Scene, sequence: Sequence, garment: np.ndarray, plain: np.ndarray) -> dict[str, float]:
    """Values that only some cases have. garment, plain: [m], shape (T, V, 3), stressed and not."""
    values = {}
    template = sequence.template.garment
    if scene.motion.freeze_after is not None and len(garment) > scene.motion.freeze_after:
        values["energy_left"] = energy_left(
            garment, scene.motion.freeze_after, vertex_areas(template.rest, template.faces)
        )
    if scene.name in UNCHANGED:
        values["change"] = change(garment, plain, scene.motion.turn, scene.motion.translate)
    return values
