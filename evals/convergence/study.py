"""Trust in the reference: how far it moves when its step is halved, its start is pushed and its mesh is refined.

Every run is of the scene's first frames, after the whole warm-up, so that what is measured is what methods are measured
against. Runs with other steps are compared with the finest one; runs with another start or mesh with the chosen setting.
A start pushed by a micrometre shows what rounding alone does: differences of that size say nothing about the step.

The mesh is refined by the middles of its edges: the same rest surface, the same vertices and more between them, so that
nothing but the discretisation differs. Garments baked at another size would have another rest shape too.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from garmentbench.evals.convergence.table import CHOSEN, CONVERGENCE, FINEST, ROUNDING
from garmentbench.evals.rows import about, failed_row
from garmentbench.evals.study import Study
from garmentbench.metrics.difference import DIFFERENCES
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene, load_scene
from garmentbench.storage.atomic import written_whole
from garmentbench.storage.jobs import Failure, Job
from garmentbench.storage.runs import RunStore, run_id

FRAMES = 90
SCENES = (
    "tshirt-armspace-90",
    "bodysuit-armspace-90",
    "pleated_skirt-armspace-90",
    "dress-armspace-90",
    "over_skirt-armspace-90",
    "sheet-stick-b",
)
POSITIONS = "positions.npy"


@dataclass(frozen=True)
class Variant:
    """One way of running the reference simulation.

    Attributes:
        name: The variant in results.csv.
        substeps: Times as many substeps as the chosen setting.
        start_noise: Every vertex is pushed so far at the start, beyond the scene's own push [m].
        refined: On the mesh with every triangle cut in four.
    """

    name: str
    substeps: int = 1
    start_noise: float = 0.0
    refined: bool = False

    @property
    def compared_with(self) -> str:
        """The variant that it is compared with."""
        return CHOSEN if self.start_noise or self.refined else FINEST


VARIANTS = {
    v.name: v
    for v in (
        Variant(CHOSEN),
        Variant("substeps_x2", substeps=2),
        Variant("substeps_x4", substeps=4),
        Variant(FINEST, substeps=8),
        Variant(ROUNDING, start_noise=1e-6),
        Variant("start_1mm", start_noise=1e-3),
        Variant("start_1cm", start_noise=1e-2),
        Variant("mesh_fine", refined=True),
    )
}


def simulate_variant(scene_name: str, preset: Preset, variant: Variant) -> str:
    """Simulate a scene's first frames in one way, unless that is done; the id of the run.

    Its folder holds the positions of the coarse mesh's vertices [m], shape (T, V, 3), as long as they are finite; its
    results are substeps, ms_per_frame, status and first_bad_frame.
    """
    from garmentbench.device import has_cuda, quiet_warp
    from garmentbench.evals.convergence.rerun import simulate_again

    with RunStore().open(CONVERGENCE, _identity(scene_name, preset, variant)) as run:
        if not run.finished:
            quiet_warp()
            scene = _scene(scene_name, variant)
            positions, told = simulate_again(scene, preset, variant.refined, "cuda:0" if has_cuda() else "cpu")
            with written_whole(run.folder / POSITIONS) as partial, partial.open("wb") as file:
                np.save(file, positions)
            run.finish(told)
    return run.id


def _identity(scene_name: str, preset: Preset, variant: Variant) -> dict:
    from garmentbench.device import device_name
    from garmentbench.reference import sequence_identity
    from garmentbench.storage.fingerprint import fingerprint

    scene = _scene(scene_name, variant)
    return {
        "scene": scene.name,
        "preset": preset.name,
        "variant": variant,
        "reference": sequence_identity(scene, preset),
        "code": fingerprint("garmentbench.evals.convergence.rerun"),
        "device": device_name(),
    }


def _scene(name: str, variant: Variant) -> Scene:
    """The scene's first frames, its settings changed."""
    scene = load_scene(name)
    own = scene.simulation
    changed = {
        "substep_factor": variant.substeps * own.get("substep_factor", 1),
        "start_noise": variant.start_noise + own.get("start_noise", 0.0),
    }
    return replace(scene, frames=min(FRAMES, scene.frames), simulation=own | changed)


def _jobs(preset: Preset) -> dict[tuple, Job]:
    """One job a scene and variant; what costs most first."""
    return {
        _key(scene, v): Job(_key(scene, v), f"{scene}, {v.name}", simulate_variant, (), (scene, preset, v), _cost(v))
        for scene in SCENES
        for v in VARIANTS.values()
    }


def _cost(variant: Variant) -> float:
    """Rough seconds: four times the vertices take about twice the substeps."""
    return 4.0 * variant.substeps * (8 if variant.refined else 1)


def _runs(preset: Preset) -> dict[tuple, str]:
    return {
        _key(scene, v): run_id(CONVERGENCE, _identity(scene, preset, v)) for scene in SCENES for v in VARIANTS.values()
    }


def _key(scene: str, variant: Variant) -> tuple:
    return (CONVERGENCE, scene, variant.name)


def _rows(preset: Preset, results: dict) -> list[dict]:
    return [row for scene in SCENES for v in VARIANTS.values() for row in _variant_rows(scene, v, preset, results)]


def _variant_rows(scene_name: str, variant: Variant, preset: Preset, results: dict) -> list[dict]:
    """The rows of one run: how far it is from the one that it is compared with, and what it cost."""
    columns = about(CONVERGENCE, preset, load_scene(scene_name), "reference", variant.name, None, 0)
    made, compared = (results[CONVERGENCE, scene_name, name] for name in (variant.name, variant.compared_with))
    failure = next((r for r in (made, compared) if isinstance(r, Failure)), None)
    if failure:
        return [failed_row(columns, failure) | {"metric": "difference"}]
    store = RunStore()
    run, other = store.get(made), store.get(compared)
    positions = np.load(run.folder / POSITIONS)
    values = {"ms_per_frame": (run.results["ms_per_frame"], "ms"), "substeps": (run.results["substeps"], "1")}
    if variant.name != variant.compared_with:
        values |= distances(positions, np.load(other.folder / POSITIONS))
    columns |= {"horizon": len(positions), "run_id": run.id} | {
        k: run.results[k] for k in ("status", "first_bad_frame")
    }
    return [columns | {"metric": name, "value": float(value), "unit": unit} for name, (value, unit) in values.items()]


def distances(positions: np.ndarray, others: np.ndarray) -> dict[str, tuple[float, str]]:
    """Value and unit of each metric of two runs' positions [m], shape (T, V, 3); NaN where one ended before the other."""
    whole = len(positions) == len(others)
    return {m.name: (m.compute(positions, others) if whole else math.nan, m.unit) for m in DIFFERENCES}


STUDY = Study(CONVERGENCE, _jobs, _rows, _runs)
