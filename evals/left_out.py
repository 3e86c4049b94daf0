"""What a scene does not need is not built. Here it is built all the same, once, to say what leaving it out saves.

A sequence without a human body is given one in name only: its object, or its inner garment, is called human and its
vertices get part labels. Then everything that depends on a human body is built and runs. The two are trained for a few
steps (sizes and times do not depend on what was learnt) and compared. Nothing of this touches the other experiments.
"""

import math
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from garmentbench import sequence_file
from garmentbench.device import device_name
from garmentbench.evals.experiment import Experiment, Work, about, failed_row, named
from garmentbench.evals.trial import sequence_job
from garmentbench.evaluation.results import Row
from garmentbench.evaluation.rollout import roll_out
from garmentbench.evaluation.score import score
from garmentbench.report.cells import ABSENT, number
from garmentbench.report.table import Cell, Table
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.sequence import HUMAN, Sequence
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.jobs import Failure, Job
from garmentbench.storage.runs import RunStore

if TYPE_CHECKING:
    from garmentbench.methods.motion_guided.config import Config
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section

LEFT_OUT = "left_out"
PREFIX = "left_out:"  # a metric's name is this and the part's
UNITS = {"ms": "ms a frame", "MB": "MB", "parameters": "parameters"}
FRAMES = 40
PARTS = 5
STEPS = 2


@dataclass(frozen=True, kw_only=True)
class LeftOut(Experiment):
    """What leaving out saves, for each of some scenes."""

    scenes: tuple[str, ...]

    def work(self, preset: Preset, seeds: int) -> Work:
        scenes = [load_scene(name) for name in self.scenes]
        jobs = {job.key: job for scene in scenes for job in [sequence_job(scene, preset)]}
        for scene in scenes:
            key, label = (LEFT_OUT, scene.name), f"what {scene.name} does not need"
            jobs[key] = Job(key, label, left_out, (("sequence", scene.name),), (preset,))

        def rows(results: dict) -> list[Row]:
            found = []
            for scene in scenes:
                columns = about(self.table, preset, scene, "motion_guided")
                made = results[LEFT_OUT, scene.name]
                if isinstance(made, Failure):
                    found.append(failed_row(columns, made))
                else:
                    found += [named(row, columns) for row in RunStore().get(made).results["rows"]]
            return found

        return Work(jobs, rows)

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.report.page import Section

        rows = results.table[(results.table.experiment == self.table) & results.table.metric.str.startswith(PREFIX)]
        cells = []
        groups: Any = rows.groupby(["scene", "metric"], sort=True)
        for (scene, metric), group in groups:
            saved = {unit: group.value[group.unit == unit].mean() for unit in UNITS}
            texts = [
                ABSENT if math.isnan(v) else f"{v:,.0f}" if unit == "parameters" else number(v)
                for unit, v in saved.items()
            ]
            cells.append([Cell(scene), Cell(metric.removeprefix(PREFIX).replace("_", " ")), *map(Cell, texts)])
        table = Table(
            self.table,
            self.title,
            "What a scene does not need is not built for it; the columns say what that saved against building it all "
            "the same.",
            ["scene", "left out", *(f"saved [{unit}]" for unit in UNITS.values())],
            cells,
            frozenset({0, 1}),
        )
        return [Section(table)]


LEAVING_OUT = LeftOut(
    name=LEFT_OUT,
    table=LEFT_OUT,
    title="What scenes do not need",
    scenes=("tshirt-armspace-75", "sheet-stick-a"),
)


def left_out(path: Path, preset: Preset) -> str:
    """Measure what leaving out saves for a scene, unless that is done; the id of the run, which holds the rows."""
    identity = {
        "data": sequence_file.content_hash(path),
        "preset": preset.name,
        "code": fingerprint("garmentbench.evals.left_out"),
        "device": device_name(),
    }
    with RunStore().open(LEFT_OUT, identity) as run:
        if not run.finished:
            run.finish({"rows": [row.measured for row in measured(path, preset)]})
    return run.id


def measured(path: Path, preset: Preset) -> list[Row]:
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
    import torch

    from garmentbench.methods.motion_guided import MotionGuided
    from garmentbench.methods.motion_guided.config import config_for
    from garmentbench.methods.training import WEIGHTS, load

    with tempfile.TemporaryDirectory() as folder:
        with RunStore(Path(folder)).open("train", {"what": LEFT_OUT}) as run:
            method = MotionGuided.fit((sequence,), _few_steps(config_for(preset.model)), run)
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


def _few_steps(config: "Config") -> "Config":
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
    assert body is not None, "what has no body leaves nothing out for it"
    bands = (np.arange(len(body.rest)) * PARTS // len(body.rest)).astype(np.int8)
    human = replace(body, kind=HUMAN, labels=bands, part_names=tuple(f"part_{k}" for k in range(PARTS)))
    return replace(sequence, template=replace(sequence.template, body=human))


def _row(part: str, value: float, unit: str) -> Row:
    return Row(metric=f"{PREFIX}{part}", value=float(value), unit=unit)
