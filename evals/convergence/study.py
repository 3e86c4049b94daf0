"""Trust in the reference: how far it moves when its step is halved, its start is pushed and its mesh is refined;
and, for comparison, how far when the cloth, the air or the body is another.

Every run is of the scene's first frames, after the whole warm-up, so that what is measured is what methods are measured
against. Runs with other steps are compared with the finest one; runs with another start or mesh with the chosen
setting. A start pushed by a micrometre shows what rounding alone does: differences of that size say nothing about the
step.

The mesh is refined by the middles of its edges: the same rest surface, the same vertices and more between them, so that
nothing but the discretisation differs. Garments baked at another size would have another rest shape too.
"""

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from garmentbench.evals.convergence.table import (
    CHOSEN,
    CONVERGENCE,
    FINEST,
    ROUNDING,
    convergence_table,
    sensitivity_table,
    studies,
    trust_table,
)
from garmentbench.evals.experiment import Experiment, Work, about, failed_row, first_failure
from garmentbench.evaluation.results import Row
from garmentbench.metrics.difference import DIFFERENCES
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.storage.atomic import written_whole
from garmentbench.storage.jobs import Job
from garmentbench.storage.runs import RunStore

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section

FRAMES = 90
CAPTION = (
    "Difference from the finest run against substeps (left) and run time (right); lines: what another start and a "
    "finer mesh change, and a third of the full model's error. The star is the chosen setting."
)
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
        queries: Times as many queries of the nearest point, in as many substeps as they then need.
        start_noise: Every vertex is pushed so far at the start, beyond the scene's own push [m].
        refined: On the mesh with every triangle cut in four.
        material: Factors by which quantities of the material are changed.
        body: Another size of the body, or None.
    """

    name: str
    substeps: int = 1
    queries: int = 1
    start_noise: float = 0.0
    refined: bool = False
    material: tuple[tuple[str, float], ...] = ()
    body: str | None = None

    @property
    def compared_with(self) -> str:
        """The variant that it is compared with."""
        return FINEST if self in STEPS else CHOSEN


STEPS = (
    Variant(CHOSEN),
    Variant("substeps_x2", substeps=2),
    Variant("substeps_x4", substeps=4),
    Variant(FINEST, substeps=8),
)
VARIANTS = {
    v.name: v
    for v in (
        *STEPS,
        Variant("queries_x8", queries=8),
        Variant(ROUNDING, start_noise=1e-6),
        Variant("start_1mm", start_noise=1e-3),
        Variant("start_1cm", start_noise=1e-2),
        Variant("mesh_fine", refined=True),
        Variant("drag_half", material=(("drag", 0.5),)),
        Variant("drag_double", material=(("drag", 2.0),)),
        Variant("friction_half", material=(("friction", 0.5),)),
        Variant("compression_third", material=(("compression", 0.3),)),
        Variant("bending_half", material=(("bending", 0.5),)),
        Variant("bending_double", material=(("bending", 2.0),)),
        Variant("body_full", body="full"),
    )
}


def simulate_variant(scene: Scene, preset: Preset, variant: Variant) -> str:
    """Simulate a scene's first frames in one way, unless that is done; the id of the run.

    Its folder holds the positions of the coarse mesh's vertices [m], shape (T, V, 3), as long as they are finite; its
    results are substeps, ms_per_frame, status and first_bad_frame.
    """
    from garmentbench.device import has_cuda, quiet_warp
    from garmentbench.evals.convergence.rerun import rerun_scene

    with RunStore().open(CONVERGENCE, _identity(scene, preset, variant)) as run:
        if not run.finished:
            quiet_warp()
            device = "cuda:0" if has_cuda() else "cpu"
            positions, outcome = rerun_scene(*changed(scene, preset, variant), variant.refined, device)
            with written_whole(run.folder / POSITIONS) as partial, partial.open("wb") as file:
                np.save(file, positions)
            run.finish(outcome)
    return run.id


def _identity(scene: Scene, preset: Preset, variant: Variant) -> dict:
    from garmentbench.device import device_name
    from garmentbench.reference import reference_identity
    from garmentbench.storage.fingerprint import fingerprint

    scene, preset = changed(scene, preset, variant)
    return {
        "scene": scene.name,
        "preset": preset.name,
        "variant": variant,
        "reference": reference_identity(scene, preset),
        "code": fingerprint("garmentbench.evals.convergence.rerun"),
        "device": device_name(),
    }


def changed(scene: Scene, preset: Preset, variant: Variant) -> tuple[Scene, Preset]:
    """The scene's first frames and the preset, changed; of two layers both are."""
    own, beneath = scene.simulation, scene.worn_over
    settings = replace(
        own,
        substep_factor=variant.substeps * own.substep_factor,
        queries=variant.queries * own.queries,
        start_noise=variant.start_noise + own.start_noise,
    )
    factors = {name: factor * getattr(scene.material, name) for name, factor in variant.material}
    scene = replace(
        scene,
        frames=min(FRAMES, scene.frames),
        simulation=settings,
        material=replace(scene.material, **factors),
        worn_over=None if beneath is None else changed(beneath, preset, variant)[0],
    )
    body = variant.body or preset.mesh.body_size
    return scene, replace(preset, mesh=replace(preset.mesh, body_size=body))


class Convergence(Experiment):
    """One job a scene and variant; its plot and second table show the full model's error too."""

    def work(self, preset: Preset, seeds: int) -> Work:
        scenes = [load_scene(name) for name in SCENES]
        wanted = {(CONVERGENCE, scene.name, v.name): (scene, v) for scene in scenes for v in VARIANTS.values()}
        jobs = {
            key: Job(key, f"{scene.name}, {v.name}", simulate_variant, (), (scene, preset, v), _cost(v))
            for key, (scene, v) in wanted.items()
        }

        def rows(results: dict) -> list[Row]:
            return [row for scene, v in wanted.values() for row in _variant_rows(scene, v, preset, results)]

        return Work(jobs, rows)

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.evals.convergence.plot import convergence_plot
        from garmentbench.report.page import Picture, Section

        found = studies(results)
        plot = Picture(f"plots/{CONVERGENCE}.svg", CAPTION, convergence_plot(found))
        return [
            Section(convergence_table(found), [plot]),
            Section(trust_table(found)),
            Section(sensitivity_table(found)),
        ]


def _cost(variant: Variant) -> float:
    """Rough seconds: four times the vertices take about twice the substeps."""
    return 4.0 * variant.substeps * (1 + variant.queries / 2) * (8 if variant.refined else 1)


def _variant_rows(scene: Scene, variant: Variant, preset: Preset, results: dict) -> list[Row]:
    """The rows of one run: how far it is from the one that it is compared with, and what it cost."""
    columns = about(CONVERGENCE, preset, scene, "reference", variant=variant.name)
    made, compared = (results[CONVERGENCE, scene.name, name] for name in (variant.name, variant.compared_with))
    failure = first_failure(made, compared)
    if failure:
        return [failed_row(columns, failure, "difference")]
    store = RunStore()
    run, other = store.get(made), store.get(compared)
    positions = np.load(run.folder / POSITIONS)
    values = {"ms_per_frame": (run.results["ms_per_frame"], "ms"), "substeps": (run.results["substeps"], "1")}
    if variant.name != variant.compared_with:
        values |= distances(positions, np.load(other.folder / POSITIONS))
    ended = {key: run.results[key] for key in ("status", "first_bad_frame")}
    columns = replace(columns, horizon=len(positions), run_id=run.id, **ended)
    return [replace(columns, metric=name, value=float(v), unit=unit) for name, (v, unit) in values.items()]


def distances(positions: np.ndarray, others: np.ndarray) -> dict[str, tuple[float, str]]:
    """Value and unit of each metric of two runs' positions [m], shape (T, V, 3).

    NaN where one ended before the other.
    """
    whole = len(positions) == len(others)
    return {m.name: (m.compute(positions, others) if whole else math.nan, m.unit) for m in DIFFERENCES}


STUDY = Convergence(name=CONVERGENCE, table=CONVERGENCE, title="Convergence of the reference", on_request=True)
