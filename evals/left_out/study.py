"""What a scene does not need is not built. Here each part is built and left out all the same, to say what that saves.

The cost of each part is measured on its own; the error with and without it takes trainings, which are shared with other
experiments. Nothing of this touches those.
"""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from garmentbench import sequence_file
from garmentbench.device import device_name
from garmentbench.evals.comparison import Comparison
from garmentbench.evals.experiment import Experiment, Work, about, failed_row, named
from garmentbench.evals.left_out.otherwise import PARTS, OtherwiseMotionGuided
from garmentbench.evals.trial import Entry, sequence_job
from garmentbench.evaluation.results import Row
from garmentbench.needs import of_template, scene_parts
from garmentbench.reference import scene_template
from garmentbench.report.lines import REFERENCE
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.jobs import Failure, Job
from garmentbench.storage.runs import RunStore

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section

LEFT_OUT = "left_out"
TUNED_PARTS = ("full", "no_push_out", "no_turns", "no_offset")


@dataclass(frozen=True)
class Case:
    """A scene, what models are trained on for it, and the scene on which settings of `tuned` are chosen.

    tuned_on: What `tuned` is trained on, as in other experiments, with which its trainings are shared.
    """

    scene: str
    train: str
    tuned_on: str
    validation: str


@dataclass(frozen=True, kw_only=True)
class LeftOut(Experiment):
    """What leaving out saves, for each of some scenes.

    Attributes:
        cases: The scenes.
        trained: Models are trained with and without each part, and tested.
    """

    cases: tuple[Case, ...]
    trained: bool = False

    def comparisons(self, preset: Preset) -> list[Comparison]:
        """The trainings with and without each part."""
        found = []
        for case in self.cases if self.trained else ():
            scene = load_scene(case.scene)
            parts = {p.name: p.needed for p in of_template(scene_template(scene, preset.mesh))} | {"heading_axes": True}
            variants = [f"{'no' if parts[part] else 'with'}_{part}" for part in PARTS if part in parts]
            ours = tuple(Entry(OtherwiseMotionGuided, variant) for variant in ("full", *variants))
            tuned = tuple(Entry("tuned", variant) for variant in TUNED_PARTS)
            for train, tests, entries in (
                ((case.train,), (case.scene,), ours),
                ((case.tuned_on,), (case.scene, case.validation), tuned),
            ):
                found.append(
                    Comparison(
                        name=self.name, table=self.table, title=self.title, train=train, tests=tests, entries=entries
                    )
                )
        return found

    def work(self, preset: Preset, seeds: int) -> Work:
        scenes = [load_scene(case.scene) for case in self.cases]
        works = [comparison.work(preset, seeds) for comparison in self.comparisons(preset)]
        jobs = {key: job for work in works for key, job in work.jobs.items()}
        jobs |= {job.key: job for scene in scenes for job in [sequence_job(scene, preset)]}
        for scene in scenes:
            key, label = (LEFT_OUT, scene.name), f"what {scene.name} can leave out"
            jobs[key] = Job(key, label, left_out, (("sequence", scene.name),), (scene, preset), 120.0)

        def rows(results: dict) -> list[Row]:
            found = [row for work in works for row in work.rows(results)]
            return found + [row for scene in scenes for row in self._rows(scene, preset, results[LEFT_OUT, scene.name])]

        return Work(jobs, rows)

    def _rows(self, scene: Scene, preset: Preset, made: str | Failure) -> list[Row]:
        """The rows of what was measured of a scene; those of the simulator, as all of the reference's, name a run that
        is no roll-out."""
        if isinstance(made, Failure):
            return [failed_row(about(self.table, preset, scene, "motion_guided"), made)]
        measured = RunStore().get(made).results
        return [
            named(row, about(self.table, preset, scene, method), made if method == REFERENCE else "")
            for method in ("motion_guided", REFERENCE)
            for row in measured[method]
        ]

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.evals.left_out.table import left_out_table
        from garmentbench.report.page import Section

        return [Section(left_out_table(self.table, self.title, results))]


_TSHIRT = Case("tshirt-armspace-90", "tshirt-armspace-75", "tshirt-armspace-75", "tshirt-armspace-60")
_STICK = Case("sheet-stick-b", "sheet-stick-a", "sheet-stick-a", "sheet-stick-c")
_SKIRT, _DRESS = (
    Case(f"{garment}-dance-latin-late", f"{garment}-dance-latin", f"{garment}@varied", f"{garment}-dance-latin-held")
    for garment in ("pleated_skirt", "dress")
)
LEAVING_OUT = LeftOut(name=LEFT_OUT, table=LEFT_OUT, title="What scenes do not need", cases=(_TSHIRT, _STICK))
LEAVING_OUT_WHOLE = LeftOut(
    name="left-out-whole",
    table="left_out_whole",
    title="What headline scenes do not need, with and without",
    cases=(_TSHIRT, _SKIRT, _DRESS, _STICK),
    trained=True,
    on_request=True,  # it trains some forty models
)


def left_out(path: Path, scene: Scene, preset: Preset) -> str:
    """Measure what a scene can leave out, unless that is done; the id of the run, which holds rows and reasons."""
    identity = {
        "scene": scene.name,
        "data": sequence_file.content_hash(path),
        "preset": preset.name,
        "code": fingerprint("garmentbench.evals.left_out.costs", "garmentbench.evals.left_out.simulator"),
        "device": device_name(),
    }
    with RunStore().open(LEFT_OUT, identity) as run:
        if not run.finished:
            from garmentbench.evals.left_out.costs import cost_rows
            from garmentbench.evals.left_out.simulator import simulator_rows

            parts = scene_parts(scene, preset)
            measured = {
                "motion_guided": cost_rows(path, parts, preset),
                REFERENCE: simulator_rows(scene, parts, preset),
            }
            rows = {method: [row.measured for row in rows] for method, rows in measured.items()}
            run.finish({**rows, "parts": [asdict(part) for part in parts]})
    return run.id
