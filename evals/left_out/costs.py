"""What each part costs a model and its evaluation: built and left out, in turn.

Models are trained for a fiftieth of their steps and rolled out over a few frames: sizes and times don't depend on what
was learnt. Two such trainings, of other lengths, give the seconds of a whole one.
"""

import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from garmentbench import sequence_file
from garmentbench.evals.left_out.otherwise import PARTS, Otherwise, OtherwiseMotionGuided, config_for, said
from garmentbench.evaluation.results import Row
from garmentbench.evaluation.rollout import RollOut, roll_out
from garmentbench.evaluation.score import score
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.methods.motion_guided.body_surface import BodySurface
from garmentbench.methods.training import WEIGHTS
from garmentbench.needs import Part
from garmentbench.pipeline.bench import shortened
from garmentbench.scenes.presets import Preset
from garmentbench.sequence import Sequence
from garmentbench.storage.runs import RunStore

PREFIX = "left_out:"  # a metric's name is this and the part's
FRAMES = 40
SHARES = (1 / 200, 1 / 50)  # of a training
TOUCHED = {  # what a part can change; the rest is the same network, or the same time, twice
    "interaction_force": ("ms", "MB", "parameters", "s"),
    "velocity": ("ms", "s"),
    "collision_stage": ("ms",),
    "sdf": ("MB", "parameters", "s"),
    "part_radii": ("parameters",),
    "far_seeds": ("ms", "MB", "parameters", "s"),
    "heading_axes": ("ms", "s"),
}


@dataclass(frozen=True)
class Cost:
    """Processor ms a frame (median), MB on the disk, parameters (SDF_0's among them), and processor seconds of a whole
    training. Processor time, since other work on the machine would be most of a difference of wall times."""

    ms: float
    MB: float
    parameters: float
    s: float


def row(part: str, value: float, unit: str, spread: float | None = None) -> Row:
    """A measured number of a part."""
    return Row(metric=f"{PREFIX}{part}", value=float(value), unit=unit, spread=spread)


def cost_rows(path: Path, parts: tuple[Part, ...], preset: Preset) -> list[Row]:
    """What leaving each part out saves (negative: what it costs), as rows "left_out:<part>".

    Args:
        path: The reference sequence.
        parts: What the scene needs; of those that a model does not have nothing is measured here.
        preset: Sizes.
    """
    sequence, config = sequence_file.load(path, FRAMES), config_for(preset.model)
    cost(sequence, config)  # compilers and allocators do their first work here
    as_needed, roll = cost(sequence, config)
    rows, needed = [], {part.name: part.needed for part in parts}
    for part in (name for name in PARTS if name in needed):
        other, _ = cost(sequence, replace(config, part=part, built=not needed[part]))
        built, left = (as_needed, other) if needed[part] else (other, as_needed)
        rows += [row(part, getattr(built, unit) - getattr(left, unit), unit) for unit in TOUCHED[part]]
    rows += _evaluation_rows(roll, sequence)
    return rows + (_far_rows(sequence) if "far_body" in needed else [])


def cost(sequence: Sequence, config: Otherwise) -> tuple[Cost, RollOut]:
    """What a model costs, and what it made of a sequence."""
    few, more = (_trained(sequence, config, share) for share in SHARES)
    method = more.method
    roll = roll_out(method, sequence)
    parameters = more.sdf + sum(p.numel() for m in (method.generative, method.dynamics) for p in m.parameters())
    times = roll.ms.sum(axis=1) if roll.processor_ms is None else roll.processor_ms
    ms = float(np.nanmedian(times[roll.start :]))
    return Cost(ms, more.MB, parameters, (more.s - few.s) / (SHARES[1] - SHARES[0])), roll


@dataclass(frozen=True)
class _Trained:
    """A model, the processor seconds of its training, what it and SDF_0 take on the disk [MB], SDF_0's parameters."""

    method: OtherwiseMotionGuided
    s: float
    MB: float
    sdf: int


def _trained(sequence: Sequence, config: Otherwise, share: float) -> _Trained:
    """A model trained for a share of its steps."""
    with tempfile.TemporaryDirectory() as folder:
        with RunStore(Path(folder)).open("train", {"share": share}) as run:
            begun = time.process_time()
            method = OtherwiseMotionGuided.fit((sequence,), shortened(config, share), run)
            seconds = time.process_time() - begun
            (run.folder / "method").mkdir()
            method.save(run.folder / "method")
        of_sdf = [*Path(folder).glob(f"sdf-*/{WEIGHTS}")]
        kept = [*of_sdf, *(file for file in Path(folder).glob("train-*/method/*") if file.is_file())]
        megabytes = sum(file.stat().st_size for file in kept) / 1e6
        return _Trained(method, seconds, megabytes, sum(map(_weights, of_sdf)))


def _weights(file: Path) -> int:
    import torch

    from garmentbench.methods.training import load

    return sum(w.numel() for w in load(file, torch.device("cpu")).values())


def _evaluation_rows(roll: RollOut, sequence: Sequence) -> list[Row]:
    """What the metrics of interpenetration, and their channels in a recording, cost: time a frame, columns, MB."""
    from garmentbench.viewing.recording import write_recording

    part, found = "interpenetration", []
    for built in (True, False):
        told = replace(sequence, template=said(sequence.template, part, built))
        score(roll, None, told)  # compilers do their first work here
        begun = time.process_time()
        columns = len({r.metric for r in score(roll, None, told)})
        ms = 1e3 * (time.process_time() - begun) / len(sequence)
        with tempfile.TemporaryDirectory() as folder:
            write_recording(Path(folder) / "recording.rrd", told, roll, part)
            megabytes = (Path(folder) / "recording.rrd").stat().st_size / 1e6
        found.append((("ms", ms), ("columns", columns), ("MB", megabytes)))
    return [row(part, b - left, unit) for (unit, b), (_, left) in zip(*found, strict=True)]


def _far_rows(sequence: Sequence) -> list[Row]:
    """Nearest body vertices among all, and among those that can be: time a frame, and how far the found ones are from
    each other [cm]."""
    body, surface = (
        sequence.body_positions,
        BodySurface(sequence.template.required_body, sequence.template.garment.rest),
    )
    ms, found = [], []
    for nearest in (lambda g, b: nearest_vertices(g, b)[1], surface.nearest):
        times, indices = [], []
        for g, b in zip(sequence.garment, body, strict=True):
            begun = time.process_time()
            indices.append(nearest(g, b))
            times.append(1e3 * (time.process_time() - begun))
        ms.append(float(np.median(times)))
        found.append(np.array([b[i] for b, i in zip(body, indices, strict=True)]))
    apart = 100 * float(np.linalg.norm(found[0] - found[1], axis=-1).mean())
    return [row("far_body", ms[0] - ms[1], "ms"), row("far_body", apart, "cm")]
