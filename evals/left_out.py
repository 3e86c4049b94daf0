"""What a scene does not need is not built. Here it is built all the same, once, to say what leaving it out saves.

A sequence without a human body is given one in name only: its object, or its inner garment, is called human and its
vertices get part labels. Then everything that depends on a human body is built and runs. The two are trained for a few steps (sizes and times do
not depend on what was learnt) and compared. Nothing of this touches the other experiments.
"""

import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch

from garmentbench import sequence_file
from garmentbench.evaluation.rollout import OK, roll_out
from garmentbench.evaluation.score import score
from garmentbench.methods.motion_guided import MotionGuided
from garmentbench.methods.motion_guided.config import Config, config_for
from garmentbench.methods.motion_guided.training import WEIGHTS, load
from garmentbench.scenes.presets import Preset
from garmentbench.sequence import HUMAN, Sequence
from garmentbench.storage.runs import RunStore

NEEDS_TABLE = "needs"
FRAMES = 40
PARTS = 5
STEPS = 2


def left_out(path: Path, preset: Preset) -> list[dict]:
    """Rows "left_out:<part>" of a scene: the parameters, MB and ms a frame that each part would have cost.

    A scene that needs everything has a row that says so.
    """
    sequence = sequence_file.load(path, FRAMES)
    needs = sequence.template.needs
    if needs.body and needs.part_radii and needs.collision_stage and needs.interpenetration:
        return [_row("nothing", 0, "parameters")]
    lean, whole = _build(sequence, preset), _build(_as_human(sequence), preset)
    rows = [
        (needs.part_radii, _row("part_radii", whole.radii - lean.radii, "parameters")),
        (needs.body, _row("SDF_0", whole.sdf_parameters - lean.sdf_parameters, "parameters")),
        (needs.body, _row("SDF_0", whole.sdf_mb - lean.sdf_mb, "MB")),
        (needs.collision_stage, _row("collision_stage", whole.collide_ms - lean.collide_ms, "ms")),
        (needs.interpenetration, _row("interpenetration_metrics", whole.measure_ms - lean.measure_ms, "ms")),
    ]
    return [row for needed, row in rows if not needed]


@dataclass(frozen=True)
class _Built:
    """What a model and its evaluation cost: parameters, MB on the disk, ms a frame."""

    radii: int
    sdf_parameters: int
    sdf_mb: float
    collide_ms: float
    measure_ms: float


def _build(sequence: Sequence, preset: Preset) -> _Built:
    """Train a model of the preset's sizes for a few steps, roll it out and measure the roll-out."""
    with tempfile.TemporaryDirectory() as folder:
        with RunStore(Path(folder)).open("train", {"what": "needs"}) as run:
            method = MotionGuided.fit((sequence,), _few_steps(config_for(preset.name)), run)
        files = list(Path(folder).glob(f"sdf-*/{WEIGHTS}"))
        sdf = sum(w.numel() for file in files for w in load(file, torch.device("cpu")).values())
        megabytes = sum(file.stat().st_size for file in files) / 1e6
    roll = roll_out(method, sequence)
    begun = time.perf_counter()
    score(roll, None, sequence)
    measure_ms = 1e3 * (time.perf_counter() - begun) / len(sequence)
    return _Built(
        method.generative.log_radii.numel(),
        sdf,
        megabytes,
        float(np.nanmean(np.nan_to_num(roll.ms[roll.start :, 2]))),
        measure_ms,
    )


def _few_steps(config: Config) -> Config:
    return replace(
        config,
        **{
            name: replace(stage, training=replace(stage.training, steps=STEPS))
            for name in ("sdf", "stage1", "stage2")
            for stage in [getattr(config, name)]
        },
    )


def _as_human(sequence: Sequence) -> Sequence:
    """The same sequence, its object called a human body with parts (bands of vertices)."""
    body = sequence.template.body
    bands = (np.arange(len(body.rest)) * PARTS // len(body.rest)).astype(np.int8)
    human = replace(body, kind=HUMAN, labels=bands, part_names=tuple(f"part_{k}" for k in range(PARTS)))
    return replace(sequence, template=replace(sequence.template, body=human))


def _row(part: str, value: float, unit: str) -> dict:
    return {"metric": f"left_out:{part}", "value": float(value), "unit": unit, "status": OK}
