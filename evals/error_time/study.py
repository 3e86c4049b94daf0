"""Error against run time: methods and the simulator on the same frames of a scene, each with more and with less."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentbench import sequence_file
from garmentbench.device import device_name, quiet_warp
from garmentbench.evals.error_time.growth import LINES, MESHES, grown
from garmentbench.evals.error_time.measure import method_rows, simulator_rows
from garmentbench.evals.error_time.pareto import SIMULATOR, comparable
from garmentbench.evals.error_time.points import NAME, Budget, budgets, settings
from garmentbench.evals.error_time.table import (
    GROWTH_MS,
    MINUTES,
    ON,
    VERTICES,
    growth_table,
    headline_table,
    point,
    points_table,
)
from garmentbench.evals.experiment import Experiment, Work, about, failed_row, first_failure, named
from garmentbench.evals.trial import Entry, Trial, sequence_job, trial_jobs
from garmentbench.evaluation.results import Row
from garmentbench.metrics.ensemble import ERROR
from garmentbench.pipeline.evaluate import EVALUATION
from garmentbench.reference import reference_identity, resolve_source
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.training_sets import MARK, expanded
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.jobs import Job
from garmentbench.storage.runs import RunStore

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section

SIMULATED, MEASURED, GROWTH = "budget", "setting", "growth"  # of jobs' keys
_HERE = "garmentbench.evals.error_time."
CAPTION = (
    "Error of the whole roll-out against time a frame. Coloured points on the line are what nothing else is better "
    "than in both; grey ones are dominated, crosses broke. Inside the shaded band differences mean nothing."
)


@dataclass(frozen=True, kw_only=True)
class ErrorTime(Experiment):
    """Settings of methods and budgets of the simulator, on some scenes.

    Attributes:
        scenes: What is trained on, and the test scene of it.
        frames: Over how many first frames of a test scene all is measured.
        growth: The test scene on whose garment's meshes times are compared; none: they are not.
    """

    scenes: tuple[tuple[str, str], ...]
    frames: int
    growth: str = ""

    def trials(self, preset: Preset, seeds: int) -> list[Trial]:
        """Every setting and seed on every scene."""
        found = []
        for learnt, tested in self.scenes:
            if preset.mesh.frame_limit is not None:  # there time is short, too
                learnt = learnt.replace(f"{MARK}varied", f"{MARK}walk-dance")
            names, lengths = expanded((learnt,))
            train, test = tuple(map(resolve_source, names)), resolve_source(tested)
            for setting in settings(preset):
                choice = setting.choice(preset)
                for seed in range(seeds if choice.random else 1):
                    found.append(Trial(Entry(choice.name, setting.label), choice, train, seed, test, lengths))
        return found

    def work(self, preset: Preset, seeds: int) -> Work:
        trials, jobs = self.trials(preset, seeds), {}
        tests = {t.test.name: t.test for t in trials if isinstance(t.test, Scene)}
        for scene in (scene for t in trials for scene in (*t.train, t.test)):
            jobs |= {job.key: job for job in [sequence_job(scene, preset)]}
        for trial in trials:
            beside = [t for t in trials if (t.choice.method, t.test) == (trial.choice.method, trial.test)]
            jobs |= {job.key: job for job in trial_jobs(trial, beside, preset)}
            needs = (trial.evaluated, ("sequence", trial.test.name))
            key = self._key(trial)
            jobs[key] = Job(key, f"measure {' '.join(map(str, key[1:3]))}", method_run, needs, (self.frames, self.name))
        for scene in tests.values():
            for budget in budgets(preset):
                key, needs = (SIMULATED, scene.name, budget.label, self.frames), (("sequence", scene.name),)
                arguments = (scene, preset, budget, self.frames, self.name)
                jobs[key] = Job(key, f"{scene.name}, {budget.label}", simulator_run, needs, arguments, 20.0)
        for mesh in MESHES if self.growth else ():
            key = (GROWTH, self.growth, mesh)
            jobs[key] = Job(key, f"times on the {mesh} mesh", growth_run, (), (self.growth, mesh, self.name), 600.0)

        def rows(results: dict) -> list[Row]:
            measured = [row for trial in trials for row in self._method_rows(trial, preset, results)]
            simulated = [row for scene in tests.values() for row in self._simulator_rows(scene, preset, results)]
            return measured + simulated + self._growth_rows(preset, results)

        return Work(jobs, rows)

    def _key(self, trial: Trial) -> tuple:
        return (MEASURED, trial.choice.name, trial.entry.label, trial.evaluated, self.frames)

    def _method_rows(self, trial: Trial, preset: Preset, results: dict[tuple, Any]) -> list[Row]:
        columns = about(
            self.table, preset, trial.test, trial.choice.name,
            variant=trial.entry.label, train_frames=trial.train_frames(preset), seed=trial.seed,
            train_scenes=trial.train_scenes,
        )  # fmt: skip
        keys = ("sequence", trial.test.name), trial.trained, trial.evaluated, self._key(trial)
        failure = first_failure(*(results[key] for key in keys))
        if failure:
            return [failed_row(columns, failure, ERROR.name)]
        rows = [named(row, columns, results[trial.evaluated]) for row in _rows_of(results[self._key(trial)])]
        learns = getattr(trial.choice.method, "learns", True)
        minutes = training_minutes(results[trial.trained]) if learns else 0.0
        return [*rows, replace(rows[0], metric=MINUTES, value=minutes, unit="min", horizon=None, spread=None, note="")]

    def _simulator_rows(self, scene: Scene, preset: Preset, results: dict[tuple, Any]) -> list[Row]:
        found = []
        for budget in budgets(preset):
            columns = about(self.table, preset, scene, SIMULATOR, variant=budget.label)
            made = results[SIMULATED, scene.name, budget.label, self.frames]
            failure = first_failure(results["sequence", scene.name], made)
            if failure:
                found.append(failed_row(columns, failure, ERROR.name))
            else:
                found += [named(row, columns, made) for row in _rows_of(made)]
        return found

    def _growth_rows(self, preset: Preset, results: dict[tuple, Any]) -> list[Row]:
        found = []
        for mesh in MESHES if self.growth else ():
            made, scene = results[GROWTH, self.growth, mesh], resolve_source(self.growth)
            failure = first_failure(made)
            for k, (method, variant) in enumerate(LINES):
                columns = about(self.table, preset, scene, method, variant=f"{variant}{ON}{mesh}")
                if failure:
                    found.append(failed_row(columns, failure, GROWTH_MS))
                    continue
                each = RunStore().get(made).results["lines"][k]
                found += [
                    replace(columns, metric=metric, value=float(each[metric]), unit=unit)
                    for metric, unit in ((VERTICES, "1"), (GROWTH_MS, "ms"))
                ]
        return found

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.evals.error_time.plot import pareto_plot
        from garmentbench.report.page import Picture, Section

        found = results.lines(self.table)
        growth = [line for line in found if (line.rows.metric == GROWTH_MS).any()]
        rest, sections = [line for line in found if line not in growth], []
        for scene in dict.fromkeys(line.scene for line in rest):
            lines = [line for line in rest if line.scene == scene]
            points, name = comparable([point(line) for line in lines]), f"{self.table}-{scene}"
            frames = max((int(h) for line in lines for h in line.rows.horizon.dropna()), default=0)
            seeds = max(line.rows.seed.nunique() for line in lines)
            plot = Picture(f"plots/{name}.svg", CAPTION, pareto_plot(points))
            ran = [line for line in lines if line.run_ids]
            sections.append(Section(points_table(name, self.title, scene, points, frames, seeds), [plot], lines=ran))
            sections.append(Section(headline_table(f"{name}-equal", self.title, scene, points)))
        if growth:
            sections.append(Section(growth_table(f"{self.table}-growth", self.title, growth)))
        return sections


def training_minutes(run: str) -> float:
    """Wall time of a training [min], with the stages that it shares with others, whoever ran them."""
    record = RunStore().get(run).record or {}
    stages = [RunStore().get(stage).record or {} for stage in record.get("stages", ())]
    return sum(each.get("times", {}).get("seconds", 0.0) for each in stages or [record]) / 60


def method_run(evaluated: str, path: Path, frames: int, name: str) -> str:
    """Measure a method's roll-out over the first frames, unless that is done; the id of the run, which holds rows."""
    identity = {"evaluated": evaluated, "data": sequence_file.content_hash(path), "frames": frames, "code": _code()}
    with RunStore().open(name, identity) as run:
        if not run.finished:
            quiet_warp()
            rows = method_rows(RunStore().get(evaluated).folder, path, frames)
            run.finish({"rows": [row.measured for row in rows]})
    return run.id


def simulator_run(path: Path, scene: Scene, preset: Preset, budget: Budget, frames: int, name: str) -> str:
    """Simulate a scene's first frames with a budget, unless that is done; the id of the run, which holds rows."""
    identity = {
        "scene": scene.name,
        "preset": preset.name,
        "budget": budget,
        "frames": frames,
        "data": sequence_file.content_hash(path),
        "reference": reference_identity(scene, preset),
        "code": _code(),
        "device": device_name(),
    }
    with RunStore().open(name, identity) as run:
        if not run.finished:
            quiet_warp()
            device = "cuda:0" if device_name() == "cuda" else "cpu"
            rows, ending = simulator_rows(scene, preset, budget, path, frames, run.folder, device)
            run.finish({"rows": [row.measured for row in rows], **ending})
    return run.id


def growth_run(scene: str, mesh: str, name: str) -> str:
    """Time the simulator and methods on a mesh, unless that is done; the id of the run, which holds their lines."""
    found = resolve_source(scene)
    assert isinstance(found, Scene)
    identity = {"scene": found, "mesh": mesh, "device": device_name(), "code": fingerprint(_HERE + "growth")}
    with RunStore().open(name, identity) as run:
        if not run.finished:
            quiet_warp()
            run.finish({"lines": grown(found, mesh)})
    return run.id


def _code() -> str:
    return fingerprint(_HERE + "measure", *EVALUATION)


def _rows_of(run: str) -> list[dict]:
    return RunStore().get(run).results["rows"]


TSHIRT = ("tshirt-armspace-75", "tshirt-armspace-90")
# The main table's scene, whose trainings and evaluations are there: the skirt's dance takes a training set of 6,210
# frames to simulate and to train on, which is most of an hour more.
STUDY = ErrorTime(name=NAME, table=NAME, title="Error against run time", scenes=(TSHIRT,), frames=150)
WHOLE = ErrorTime(
    name=f"{NAME}-whole",
    table=f"{NAME}-whole",
    title="Error against run time, headline scenes",
    scenes=(
        ("pleated_skirt@varied", "pleated_skirt-dance-latin-late"),
        ("dress@varied", "dress-dance-latin-late"),
        ("pleated_skirt@varied", "pleated_skirt-armspace-90"),
        TSHIRT,
    ),
    frames=400,
    growth="pleated_skirt-dance-latin-late",
    on_request=True,  # the headline scenes of `make difficulty`, whose data it shares; fine meshes take an hour more
)
