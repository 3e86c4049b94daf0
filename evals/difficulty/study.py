"""What a scene asks for, for the lively garments: methods trained on the varied set, tested on what is new."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentbench import sequence_file
from garmentbench.evals.comparison import Comparison
from garmentbench.evals.difficulty.measures import measured
from garmentbench.evals.difficulty.table import METHODS, difficulty_table
from garmentbench.evals.experiment import Experiment, Work, about, failed_row, first_failure, named
from garmentbench.evals.trial import Entry, Trial
from garmentbench.evaluation.results import Row
from garmentbench.report.lines import REFERENCE
from garmentbench.scenes.presets import Preset
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.jobs import Job
from garmentbench.storage.runs import RunStore

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section

NAME = "difficulty"
BASIS = "linear_subspace"  # whose subspace the floor is that of
TESTS = ("dance-latin-late", "armspace-90", "dance-spin", "dance-bounce", "armspace-90-heavy")


@dataclass(frozen=True, kw_only=True)
class Difficulty(Experiment):
    """Comparisons of simple methods and `tuned`, one a garment, in one table.

    Attributes:
        garments: Which.
        training_set: What is trained on.
        tests: Test scenes, without the garment.
        first_look: Garment and training set where sequences are cut short: there time is short, too.
    """

    garments: tuple[str, ...]
    training_set: str
    tests: tuple[str, ...]
    first_look: tuple[str, str]

    def parts(self, preset: Preset) -> list[Comparison]:
        """A comparison for each garment."""
        short = preset.mesh.frame_limit is not None
        garments, chosen = ((self.first_look[0],), self.first_look[1]) if short else (self.garments, self.training_set)
        return [
            Comparison(
                name=f"{self.name}-{garment}",
                table=self.table,
                title=self.title,
                train=(f"{garment}@{chosen}",),
                tests=tuple(f"{garment}-{test}" for test in self.tests),
                entries=tuple(Entry(method) for method in METHODS),
            )
            for garment in garments
        ]

    def work(self, preset: Preset, seeds: int) -> Work:
        parts = self.parts(preset)
        works = [part.work(preset, seeds) for part in parts]
        trials = [t for part in parts for t in part.trials(preset, seeds) if t.choice.name == BASIS]
        jobs = {key: job for work in works for key, job in work.jobs.items()}
        jobs |= {job.key: job for trial in trials for job in [_job(trial)]}

        def rows(results: dict) -> list[Row]:
            scenes = [row for trial in trials for row in self._scene_rows(trial, preset, results)]
            return [row for work in works for row in work.rows(results)] + scenes

        return Work(jobs, rows)

    def _scene_rows(self, trial: Trial, preset: Preset, results: dict[tuple, Any]) -> list[Row]:
        """The rows of a scene's own line."""
        frames = trial.train_frames(preset)
        columns = about(self.table, preset, trial.test, REFERENCE, train_scenes=trial.train_scenes, train_frames=frames)
        key = _key(trial)
        failure = first_failure(results["sequence", trial.test.name], results[trial.trained], results[key])
        if failure:
            return [failed_row(columns, failure)]
        return [named(row, columns) for row in RunStore().get(results[key]).results["rows"]]

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.report.page import Section

        lines = results.lines(self.table)
        return [Section(difficulty_table(lines, self.title), lines=[line for line in lines if line.run_ids])]


STUDY = Difficulty(
    name=NAME,
    table=NAME,
    title="What a scene asks for",
    garments=("pleated_skirt", "dress"),  # the liveliest; each takes 17,000 simulated frames
    training_set="varied",
    tests=TESTS,
    first_look=("pleated_skirt", "walk-dance"),
    on_request=True,  # it simulates more than everything else together
)


def _key(trial: Trial) -> tuple:
    return (NAME, trial.trained, trial.test.name)


def _job(trial: Trial) -> Job:
    after = (trial.trained, ("sequence", trial.test.name))
    return Job(_key(trial), f"what {trial.test.name} asks for", scene_run, after, cost=10.0)


def scene_run(trained: str, path: Path) -> str:
    """Measure a scene, unless that is done; the id of the run, which holds the rows."""
    identity = {
        "data": sequence_file.content_hash(path),
        "trained": trained,
        "code": fingerprint("garmentbench.evals.difficulty.measures"),
    }
    with RunStore().open(NAME, identity) as run:
        if not run.finished:
            rows = measured(path, RunStore().get(trained).folder / "method")
            run.finish({"rows": [row.measured for row in rows]})
    return run.id
