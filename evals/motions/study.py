"""How the motions are distributed, in the manner of figure 5: the T-shirt's scenes on the base body, without any cloth."""

import numpy as np

from garmentbench.evals.motions.distribution import embed, nearest_cm, poses
from garmentbench.evals.motions.table import APART, MOTIONS, POINTS, TRAINED, motion_label
from garmentbench.evals.rows import about, failed_row
from garmentbench.evals.study import Study
from garmentbench.evaluation.rollout import OK
from garmentbench.scenes.choice import choose_scenes
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene, load_scene
from garmentbench.storage.atomic import written_whole
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.jobs import Failure, Job
from garmentbench.storage.runs import RunStore, run_id

CHOICE = ("tshirt-*", "body=base")
KEY = (MOTIONS,)


def distribute(preset: Preset) -> str:
    """Compare all poses of all scenes, unless that is done; the id of the run.

    Its folder holds every motion's points on the plane; its results are every motion's distances [cm] from the training
    motions.
    """
    with RunStore().open(MOTIONS, _identity(preset)) as run:
        if not run.finished:
            scenes = _scenes()
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
                np.savez_compressed(file, **dict(zip(found, plane, strict=True)))
            run.finish({name: {to: nearest_cm(p, found[to]) for to in TRAINED} for name, p in found.items()})
    return run.id


def _scenes() -> list[Scene]:
    return [load_scene(name) for name in choose_scenes(CHOICE)]


def _identity(preset: Preset) -> dict:
    return {
        "scenes": [(scene.name, scene.motion, scene.frames) for scene in _scenes()],
        "preset": preset.name,
        "code": fingerprint("garmentbench.evals.motions.distribution"),
    }


def _rows(preset: Preset, results: dict) -> list[dict]:
    rows = []
    for scene in _scenes():
        columns = about(MOTIONS, preset, scene, "reference", "full", None, 0)
        made = results[KEY]
        if isinstance(made, Failure):
            rows.append(failed_row(columns, made))
            continue
        columns |= {"unit": "cm", "status": OK, "run_id": made}
        measured = RunStore().get(made).results[motion_label(scene.name)]
        rows += [columns | {"metric": APART + name, "value": cm} for name, cm in measured.items()]
    return rows


STUDY = Study(
    MOTIONS,
    jobs=lambda preset: {KEY: Job(KEY, "distribution of motions", distribute, arguments=(preset,), cost=20.0)},
    rows=_rows,
    runs=lambda preset: {KEY: run_id(MOTIONS, _identity(preset))},
    always=True,
)
