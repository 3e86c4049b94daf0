"""What the number and variety of training frames are worth: the same methods, trained on less and on more.

The skirt is tested on phrases of a dance that it may have been trained on, and on a kind of motion that it never was.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from garmentbench.evals.comparison import Comparison
from garmentbench.evals.experiment import Experiment, Work
from garmentbench.evals.training_data.table import NAME, training_data_table
from garmentbench.evals.trial import FULL, TUNED, Entry
from garmentbench.evaluation.results import Row
from garmentbench.scenes.presets import Preset

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section

CAPTION = (
    "Error of the whole roll-out against the number of training frames, a line a method; the bar is the 95 % interval "
    "over seeds where there are several. Dashed: another run of the simulator."
)
METHODS = (*map(Entry, ("linear_subspace", "linear_memory", "subspace_network", "pose_gru")), TUNED, FULL)


@dataclass(frozen=True, kw_only=True)
class TrainingData(Experiment):
    """The same methods on the same tests, trained on one set after another.

    Attributes:
        garment: Which.
        sets: Training sets of the wardrobe, without the garment.
        tests: Test scenes, without the garment.
    """

    garment: str
    sets: tuple[str, ...]
    tests: tuple[str, ...]

    def parts(self) -> list[Comparison]:
        """A comparison for each training set."""
        return [
            Comparison(
                name=f"{self.name}-{chosen}",
                table=self.table,
                title=self.title,
                train=(f"{self.garment}@{chosen}",),
                tests=tuple(f"{self.garment}-{test}" for test in self.tests),
                entries=METHODS,
            )
            for chosen in self.sets
        ]

    def work(self, preset: Preset, seeds: int) -> Work:
        works = [part.work(preset, seeds) for part in self.parts()]

        def rows(results: dict) -> list[Row]:
            return [row for work in works for row in work.rows(results)]

        return Work({key: job for work in works for key, job in work.jobs.items()}, rows)

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.evals.training_data.plot import error_against_frames
        from garmentbench.report.page import Picture, Section

        lines = results.lines(self.table)
        plot = [Picture(f"plots/{self.name}.svg", CAPTION, error_against_frames(lines))] if lines else []
        return [Section(training_data_table(lines, self.title), plot, lines=[line for line in lines if line.run_ids])]


STUDY = TrainingData(
    name="training-data",
    table=NAME,
    title="What training frames are worth",
    garment="pleated_skirt",
    sets=("walk", "dance", "walk-dance", "varied"),
    tests=("dance-latin-late", "dance-bounce"),
    on_request=True,  # 24 trainings a seed, on sequences of which most are made for nothing else
)
