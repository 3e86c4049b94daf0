"""Trust in the reference: the same scenes in an independent engine (Newton's VBD), with the cloth matched by two
strips.

The difference is reported, not hidden. Rest shape, creases and the air's drag are the same in both. One scene is run
with twice the other engine's substeps, to say how far it agrees with itself.
"""

from dataclasses import asdict, dataclass, replace
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING

import numpy as np

from garmentbench.evals.convergence.study import SCENES  # one a garment
from garmentbench.evals.crosscheck.match_material import match
from garmentbench.evals.crosscheck.model import VbdSettings
from garmentbench.evals.crosscheck.table import CROSSCHECK, ENGINE, crosscheck_table
from garmentbench.evals.crosscheck.vbd import drive_vbd, require_newton
from garmentbench.evals.experiment import Experiment, Work, about, failed_row, named
from garmentbench.evaluation.results import Row
from garmentbench.evaluation.rollout import ROLL_OUT, RollOut
from garmentbench.geometry.mesh import edge_lengths, unique_edges
from garmentbench.metrics import Motion, metric, scores
from garmentbench.metrics.difference import DIFFERENCES
from garmentbench.metrics.interpenetration_strict import PENETRATION
from garmentbench.metrics.spread import SPREAD
from garmentbench.reference import reference_identity
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.sequence import Sequence
from garmentbench.storage.atomic import written_whole
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.jobs import Failure, Job
from garmentbench.storage.runs import Run, RunStore

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section
    from garmentbench.simulation.outfit import Outfit

FRAMES = 60
CAPTION = "Frames of {scene}: the reference above, below it the other engine, coloured by how far they are apart."
POSITIONS = "positions.npy"


@dataclass(frozen=True)
class Variant:
    """One comparison.

    Attributes:
        name: The variant in results.csv.
        substeps: Times as many substeps in the other engine.
        scenes: On which scenes.
    """

    name: str
    substeps: int = 1
    scenes: tuple[str, ...] = SCENES


VARIANTS = (
    Variant("full"),
    Variant("substeps_x2", substeps=2, scenes=SCENES[:1]),  # one scene says how far the other engine agrees with itself
)


def compare(scene: Scene, preset: Preset, variant: Variant) -> str:
    """Simulate a scene's first frames in both engines and compare them, unless that is done; the id of the run.

    Raises `UserError` where Newton is not installed.
    """
    with RunStore().open(CROSSCHECK, _identity(scene, preset, variant)) as run:
        if not run.finished:
            _compare(run, scene, preset, variant)
    return run.id


def _compare(run: Run, whole: Scene, preset: Preset, variant: Variant) -> None:
    from garmentbench import sequence_file
    from garmentbench.device import quiet_warp
    from garmentbench.evaluation.excerpt import write_excerpt
    from garmentbench.reference import make_reference

    quiet_warp()
    scene = replace(whole, frames=min(FRAMES, whole.frames))
    made = sequence_file.load(make_reference(whole, preset).path, scene.frames)
    other, matched = _other(run, scene, preset, variant.substeps)
    garment = np.load(other.folder / POSITIONS)
    write_excerpt(run.folder, made, RollOut(ROLL_OUT, 0, garment, None, np.full((len(garment), 3), np.nan)))
    run.finish(
        {
            "rows": _measures(garment, other.results["ms_per_frame"], made, SPREAD.compute(Motion.of(made))),
            "match": matched,
            "message": "",
        }
    )


def _other(run: Run, scene: Scene, preset: Preset, times: int) -> tuple[Run, dict]:
    """The scene in the other engine, with `times` its substeps, and the match of its cloth; shared by comparisons.

    It goes from the same start through the same warm-up. Of two layers it is the outer one; the one beneath is the
    reference's.
    """
    from garmentbench.simulation.outfit import Outfit

    outfit = Outfit.of(scene, preset)
    outer, plain = outfit.layers[-1], VbdSettings()
    plain = replace(plain, substeps=times * plain.substeps)
    edge = round(float(np.median(edge_lengths(outer.garment.rest, unique_edges(outer.garment.faces)))), 3)
    common = {"material": outer.material, "settings": outer.settings} | _code()
    strips = run.stage("strips", common | {"vbd": plain, "edge": edge})
    if not strips.finished:
        strips.finish(asdict(match(outer.material, outer.settings, plain, edge)))
    fitted = VbdSettings(**strips.results["settings"])
    ran = run.stage("newton", common | {"vbd": fitted, "scene": reference_identity(scene, preset)})
    if not ran.finished:
        positions, ms = _vbd(outfit, scene.name, fitted)
        with written_whole(ran.folder / POSITIONS) as partial, partial.open("wb") as file:
            np.save(file, positions)
        ran.finish({"ms_per_frame": ms})
    return ran, {key: strips.results[key] for key in ("hanging", "cantilever")}


def _vbd(outfit: "Outfit", name: str, vbd: VbdSettings) -> tuple[np.ndarray, float]:
    """Positions after the warm-up [m], shape (T, V, 3), and ms a frame, in the other engine."""
    from garmentbench.progress import track
    from garmentbench.simulation.obstacle import Obstacle

    body, positions, outer = outfit.animation.body, outfit.animation.positions, outfit.layers[-1]
    count, beneath = outfit.animation.warm_up + outfit.frames, None
    if len(outfit.layers) > 1:
        worn = replace(outfit, layers=outfit.layers[:-1]).simulate(outfit.frames, "cpu")[-1]
        beneath = (worn.body, worn.surface[:count])
    obstacle = Obstacle.of(body, positions[:count], beneath)
    with track(count - 1, f"simulate {name} in Newton") as step:
        ran = drive_vbd(
            outer.garment, outer.start, obstacle, count, outfit.fps, outer.material, outer.settings, vbd, step
        )
    return ran.positions[outfit.animation.warm_up :], ran.ms_per_frame


def _measures(garment: np.ndarray, ms: float, reference: Sequence, spread: float) -> list[dict]:
    """Rows of one comparison: each metric of the other engine's garment, with the reference's own."""
    truth = Motion.of(reference)
    rows = [Row.of(m, m.compute(garment, reference.garment), spread=spread) for m in DIFFERENCES]
    rows.append(Row.of(metric("ms_per_frame"), ms, reference_value=reference.scores["ms_per_frame"]))
    if reference.template.needs.body:
        theirs, ours = (scores(m, *PENETRATION) for m in (replace(truth, predicted=garment), truth))
        rows += [Row.of(metric(name), value, reference_value=ours[name]) for name, value in theirs.items()]
    return [row.measured for row in rows]


def _identity(scene: Scene, preset: Preset, variant: Variant) -> dict:
    return {
        "scene": scene.name,
        "preset": preset.name,
        "variant": {"name": variant.name, "substeps": variant.substeps},
        "frames": FRAMES,
        "reference": reference_identity(scene, preset),
    } | _code()


def _code() -> dict:
    """What the other engine is."""
    try:
        engine = version("newton")
    except PackageNotFoundError:
        engine = None
    return {"code": fingerprint("garmentbench.evals.crosscheck", "garmentbench.evaluation.excerpt"), "newton": engine}


def _key(scene: Scene, variant: Variant) -> tuple:
    return (CROSSCHECK, scene.name, variant.name)


class CrossCheck(Experiment):
    """One job a scene and variant."""

    def require(self) -> None:
        require_newton()

    def work(self, preset: Preset, seeds: int) -> Work:
        jobs, scenes = {}, [load_scene(name) for name in SCENES]
        comparisons = [(scene, v) for scene in scenes for v in VARIANTS if scene.name in v.scenes]
        for scene, v in comparisons:
            key, name, plain = _key(scene, v), f"cross-check {scene.name}, {v.name}", _key(scene, VARIANTS[0])
            after = (plain,) if key != plain and v.substeps == 1 else ()  # it shares the other engine's run with that
            jobs[key] = Job(key, name, compare, (), (scene, preset, v), 60.0 * v.substeps, after)

        def rows(results: dict) -> list[Row]:
            return [row for scene, v in comparisons for row in _variant_rows(scene, v, preset, results)]

        return Work(jobs, rows)

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.report.page import Picture, Section
        from garmentbench.report.strips import frame_strip

        lines = results.lines(self.table)
        pictures = [
            Picture(
                f"strips/{CROSSCHECK}-{line.scene}.jpg",
                CAPTION.format(scene=line.scene),
                frame_strip([line], results.excerpt),
            )
            for line in lines
            if line.variant == "full" and line.run_ids
        ]
        return [Section(crosscheck_table(lines), pictures, lines=lines)]


def _variant_rows(scene: Scene, variant: Variant, preset: Preset, results: dict) -> list[Row]:
    """The rows of one comparison, and how well the strips agree [%]."""
    columns = about(CROSSCHECK, preset, scene, ENGINE, variant=variant.name)
    result = results[_key(scene, variant)]
    if isinstance(result, Failure):
        return [failed_row(columns, result, "difference")]
    run = RunStore().get(result)
    strips = [
        {"metric": f"match_{name}", "value": 100 * abs(value), "unit": "%"}
        for name, value in run.results["match"].items()
    ]
    return [named(row | {"horizon": FRAMES}, columns, run.id) for row in run.results["rows"] + strips]


STUDY = CrossCheck(name=CROSSCHECK, table=CROSSCHECK, title="Cross-check", on_request=True)
