"""One line of results: a method trained on some scenes and tested on another, and the jobs that make it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from garmentbench.errors import UserError
from garmentbench.evaluation.another_run import ANOTHER_RUN
from garmentbench.method import Method
from garmentbench.motion.timing import WARM_UP
from garmentbench.pipeline.choice import MethodChoice
from garmentbench.pipeline.evaluate import evaluate, evaluate_another_run
from garmentbench.pipeline.same_meshes import OtherGarmentError
from garmentbench.pipeline.train import train
from garmentbench.reference import Source, make_reference, runs_wanted
from garmentbench.scenes.material import Material
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.training_sets import title as training_title
from garmentbench.storage.jobs import Job, Reused
from garmentbench.storage.runs import Run, RunStore

TRAIN_FRAMES = 300  # the paper's training length, section 6.1


@dataclass(frozen=True)
class Entry:
    """One line of a table.

    Attributes:
        method: A method's name, "module:Class", or the class itself.
        variant: "full", or one of the method's `VARIANTS`.
        train_frames: How many frames of each training scene it is trained on, from the first on; of a training set as
            many as that says.
    """

    method: str | type[Method]
    variant: str = "full"
    train_frames: int = TRAIN_FRAMES

    @property
    def label(self) -> str:
        """The variant's name in results.csv: a departure from the paper's training length is a variant too."""
        return self.variant if self.train_frames == TRAIN_FRAMES else f"train_{self.train_frames}"


FULL = Entry("motion_guided")
SIMPLE = tuple(Entry(m) for m in ("skinning", "hold", "constant_velocity", "linear_subspace"))
TUNED = Entry("tuned")
STRONG = tuple(Entry(m) for m in ("static_ridge", "linear_memory", "subspace_network", "pose_gru"))


@dataclass(frozen=True)
class Trial:
    """One line of results to be: an entry and a seed, trained, on a test scene; every name in it resolved."""

    entry: Entry
    choice: MethodChoice
    train: tuple[Source, ...]
    seed: int
    test: Source
    lengths: Mapping[str, int] = field(default_factory=dict)

    @property
    def train_scenes(self) -> str:
        return training_title([scene.name for scene in self.train])

    def train_frames(self, preset: Preset) -> int:
        """Frames of each training scene; where a training set says how many, of all together."""
        taken = [preset.mesh.limited(self.lengths.get(scene.name, self.entry.train_frames)) for scene in self.train]
        return sum(taken) if self.lengths else taken[0]

    @property
    def trained(self) -> tuple:
        return ("train", self.train_scenes, self.choice.name, self.entry.label, self.entry.train_frames, self.seed)

    @property
    def evaluated(self) -> tuple:
        return ("evaluate", self.trained, self.test.name)


def sequence_job(source: Source, preset: Preset) -> Job:
    """Simulating a scene, or finding a file as it is."""
    key, cost = ("sequence", source.name), _seconds(source, preset) if isinstance(source, Scene) else 0.0
    return Job(key, f"simulate {source.name}", _simulate, arguments=(source, preset), cost=cost)


def _seconds(scene: Scene, preset: Preset) -> float:
    """Rough seconds that simulating a scene takes; of an ensemble's runs one has twice the substeps."""
    frames, runs = preset.mesh.limited(scene.frames) + WARM_UP, runs_wanted(scene)
    layers = 1 if scene.worn_over is None else 2
    stiff = math.sqrt(scene.material.stretch / Material().stretch)  # so many times the substeps
    return 0.05 * frames * (runs if runs == 1 else runs + 1) * layers * stiff


def trial_jobs(trial: Trial, trials: list[Trial], preset: Preset) -> list[Job]:
    """Training and evaluating."""
    entry, choice, test = trial.entry, trial.choice, trial.test
    name = f"{choice.name} {entry.label}" + (f" seed {trial.seed}" if trial.seed else "")
    full = replace(trial, entry=replace(entry, variant="full")).trained
    shared = full != trial.trained and any(t.trained == full for t in trials)
    return [
        Job(
            trial.trained,
            f"train {name} on {trial.train_scenes}",
            _train,
            tuple(("sequence", scene.name) for scene in trial.train),
            (trial, preset),
            600.0 if choice.random else 10.0,
            (full,) if shared else (),  # the full variant first: it shares stages with the others
        ),
        Job(
            trial.evaluated,
            f"evaluate {name} on {test.name}",
            _evaluate,
            (trial.trained, ("sequence", test.name)),
            (trial, preset),
            0.1 * getattr(test, "frames", TRAIN_FRAMES),
        ),
    ]


def _simulate(source: Source, preset: Preset) -> Path | Reused:
    reference = make_reference(source, preset)
    return Reused(reference.path) if reference.reused else reference.path


def another_run_job(source: Source, preset: Preset) -> Job:
    """Scoring the further runs of a test scene."""
    key, needs = (ANOTHER_RUN, source.name), (("sequence", source.name),)
    return Job(key, f"another run of {source.name}", _score_another_run, needs, (source, preset))


def _score_another_run(_: Path, source: Source, preset: Preset) -> str | Reused | None:
    run = evaluate_another_run(source, preset, RunStore())
    return None if run is None else _id(run)


def _train(*inputs: Any) -> str | Reused:
    *_, trial, preset = inputs
    frames = trial.entry.train_frames
    return _id(train(trial.choice, trial.train, preset, frames, trial.seed, RunStore(), trial.lengths))


def _evaluate(trained: str, _: Path, trial: Trial, preset: Preset) -> str | Reused:
    store = RunStore()
    try:
        return _id(evaluate(store.get(trained), trial.test, preset, store))
    except OtherGarmentError as e:
        raise UserError(f"{e}; wanted scenes of that garment in the experiment's train = [...]") from e


def _id(run: Run) -> str | Reused:
    return Reused(run.id) if run.reused else run.id
