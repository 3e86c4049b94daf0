"""The simulator with a budget in a method's place, and both measured over the same first frames of a scene."""

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from garmentbench import sequence_file
from garmentbench.errors import UserError
from garmentbench.evals.error_time.carry import Carrier
from garmentbench.evals.error_time.points import SIZES, Budget
from garmentbench.evaluation.broken import judged
from garmentbench.evaluation.excerpt import write_excerpt
from garmentbench.evaluation.results import Row
from garmentbench.evaluation.rollout import BROKEN, DIVERGED, OK, ROLL_OUT, RollOut
from garmentbench.evaluation.score import predicted, score
from garmentbench.method import HISTORY
from garmentbench.metrics.ensemble import ERROR
from garmentbench.metrics.ms_per_frame import TIMES
from garmentbench.progress import track
from garmentbench.scenes.garments import scene_garment
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.sequence import Sequence
from garmentbench.simulation.drive import STRAIN_LIMIT, Simulated, drive
from garmentbench.simulation.ensemble import PUSH, Push
from garmentbench.simulation.outfit import Outfit

MEASURED = (ERROR, *TIMES)
# A push that no run of the reference has: the reference's own solver is then another run, and errs by the spread.
OTHER_START = Push(0, PUSH, seed=1)


def roll_out_of(scene: Scene, preset: Preset, budget: Budget, sequence: Sequence, device: str) -> RollOut:
    """Simulate a scene with its whole warm-up, as far as `sequence` goes, and carry it to the preset's mesh.

    Its time is the simulator's for a frame and that of carrying it over. It is broken where it is strained beyond what
    the simulator calls stable. Raises `UserError` for a scene of two layers.
    """
    if scene.worn_over is not None:
        raise UserError(f"{scene.name}: budgets are for one garment, and it is worn over another; take another scene")
    queries = scene.simulation.queries if budget.queries is None else budget.queries
    mesh = replace(preset.mesh, name=SIZES[SIZES.index(preset.mesh.name) - budget.coarser])
    changed = replace(scene, simulation=replace(scene.simulation, queries=queries))
    outfit = Outfit.of(changed, replace(preset, mesh=mesh))
    (layer,), start, frames = outfit.layers, outfit.animation.warm_up, len(sequence)
    inputs = (layer.garment, layer.start, outfit.animation.body, outfit.animation.positions[: start + frames])
    ticks: list[tuple[float, float]] = []
    with track(start + frames - 1, f"simulate {scene.name}, {budget.label}") as step:

        def tick() -> None:
            ticks.append(_clocks())
            step()

        run = drive(
            *inputs, outfit.fps, layer.material, layer.settings, device,
            budget=budget.substeps, push=OTHER_START, step=tick,
        )  # fmt: skip
    ms = 1e3 * np.diff(np.array(ticks), axis=0)[-frames:]
    moved = run.positions[start:]
    if budget.coarser:
        carry, carried = Carrier.of(layer.garment, scene_garment(scene, preset.mesh)), []
        for t, positions in enumerate(moved):
            begun = _clocks()
            carried.append(carry(positions))
            ms[t] += 1e3 * np.subtract(_clocks(), begun)
        moved = np.array(carried)
    return _ended(run, start, moved.astype(np.float32), ms, device)


def _ended(run: Simulated, start: int, moved: np.ndarray, ms: np.ndarray, device: str) -> RollOut:
    finite = np.isfinite(moved).all(axis=(1, 2))
    strained = ~(run.strain[start:, 1] <= STRAIN_LIMIT)
    ending: tuple[str, int | None, str] = (OK, None, "")
    if not finite.all():
        ending = (DIVERGED, int(np.argmin(finite)), "positions are not finite")
        moved[ending[1] :] = np.nan
    elif strained.any():
        at = int(np.argmax(strained))
        said = f"the 99th percentile of the strain is {run.strain[start + at, 1]:.0%}, beyond what is called stable"
        ending = (BROKEN, at, said)
    parts = np.zeros((len(moved), 3))
    parts[:, 1] = ms[:, 0]
    own = ms[:, 1] if device == "cpu" else None
    return RollOut(ROLL_OUT, HISTORY, moved, None, parts, *ending, processor_ms=own)


def _clocks() -> tuple[float, float]:
    return time.perf_counter(), time.process_time()


def simulator_rows(
    scene: Scene, preset: Preset, budget: Budget, path: Path, frames: int, folder: Path, device: str
) -> tuple[list[Row], dict[str, Any]]:
    """Error and times of the simulator with a budget over a scene's first frames, and how it ended; what the report
    draws is written into a folder. path: the reference's."""
    sequence = sequence_file.load(path, frames)
    roll = roll_out_of(scene, preset, budget, sequence, device)
    roll = judged(roll, predicted(roll, sequence))
    write_excerpt(folder, sequence, roll)
    ending = {"status": roll.status, "first_bad_frame": roll.first_bad_frame, "message": roll.message}
    return _rows(roll, sequence), ending


def method_rows(evaluated: Path, path: Path, frames: int) -> list[Row]:
    """Error and times of a method over the first frames of its roll-out, which lies in the folder `evaluated`."""
    sequence, roll = sequence_file.load(path, frames), RollOut.load(evaluated / "rollout.h5")
    later = roll.first_bad_frame is not None and roll.first_bad_frame >= len(sequence)
    ending = {"status": OK, "first_bad_frame": None, "message": ""} if later else {}
    own = None if roll.processor_ms is None else roll.processor_ms[: len(sequence)]
    cut = replace(
        roll, garment=roll.garment[: len(sequence)], before_collision=None, ms=roll.ms[: len(sequence)],
        processor_ms=own, novelty=None, **ending,
    )  # fmt: skip
    return _rows(cut, sequence)


def _rows(roll: RollOut, sequence: Sequence) -> list[Row]:
    rows = score(roll, None, sequence, only=lambda metric: metric in MEASURED)
    return [row for row in rows if row.metric != ERROR.name or row.horizon == len(sequence)]
