"""How the motions are distributed, in the manner of figure 5.

The T-shirt's scenes on the base body, without any cloth.
"""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from garmentbench.evals.experiment import Experiment, Work, about, failed_row
from garmentbench.evals.motions.distribution import embed, nearest_cm, poses
from garmentbench.evals.motions.table import APART, MOTIONS, POINTS, TRAINED, motion_label, motions_table, read_points
from garmentbench.evaluation.results import Row
from garmentbench.scenes.choice import choose_scenes
from garmentbench.scenes.presets import Preset
from garmentbench.storage.atomic import written_whole
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.jobs import Failure, Job
from garmentbench.storage.runs import RunStore

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section

CHOICE = ("tshirt-*", "body=base")
KEY = (MOTIONS,)
CAPTION = "Poses of all motions, nearest ones side by side (t-SNE). Large: the two that most is trained on."


def distribute(preset: Preset) -> str:
    """Compare all poses of all scenes, unless that is done; the id of the run.

    Its folder holds every motion's points on the plane; its results are every motion's distances [cm] from the training
    motions.
    """
    with RunStore().open(MOTIONS, _identity(preset)) as run:
        if not run.finished:
            scenes = choose_scenes(CHOICE)
            with run.track(len(scenes) + 1, MOTIONS) as step:
                found = {}
                for scene in scenes:
                    found[motion_label(scene.name)] = poses(scene, preset)
                    step()
                plane = np.split(
                    embed(np.concatenate(list(found.values()))), np.cumsum([len(p) for p in found.values()])[:-1]
                )
                step()
            with written_whole(run.folder / POINTS) as partial, partial.open("wb") as file:
                arrays: dict[str, Any] = dict(zip(found, plane, strict=True))
                np.savez_compressed(file, **arrays)
            run.finish({name: {to: nearest_cm(p, found[to]) for to in TRAINED} for name, p in found.items()})
    return run.id


def _identity(preset: Preset) -> dict:
    return {
        "scenes": [(scene.name, scene.motion, scene.frames) for scene in choose_scenes(CHOICE)],
        "preset": preset.name,
        "code": fingerprint("garmentbench.evals.motions.distribution"),
    }


class MotionMap(Experiment):
    """One job, a table and a map."""

    def work(self, preset: Preset, seeds: int) -> Work:
        job = Job(KEY, "distribution of motions", distribute, arguments=(preset,), cost=20.0)
        return Work({KEY: job}, lambda results: _rows(preset, results[KEY]))

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.evals.motions.plot import motions_plot
        from garmentbench.report.page import Picture, Section

        lines, points = results.lines(self.table), read_points(results)
        pictures = [Picture(f"plots/{MOTIONS}.svg", CAPTION, motions_plot(points))] if points else []
        return [Section(motions_table(lines), pictures)]


def _rows(preset: Preset, made: str | Failure) -> list[Row]:
    rows = []
    for scene in choose_scenes(CHOICE):
        columns = about(MOTIONS, preset, scene, "reference")
        if isinstance(made, Failure):
            rows.append(failed_row(columns, made))
            continue
        measured = RunStore().get(made).results[motion_label(scene.name)]
        rows += [replace(columns, metric=APART + n, value=cm, unit="cm", run_id=made) for n, cm in measured.items()]
    return rows


STUDY = MotionMap(name=MOTIONS, table=MOTIONS, title="Motions")
