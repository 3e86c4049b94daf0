"""The command that makes data."""

import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from tyro.conf import Positional

from garmentbench.errors import UsageError, UserError

if TYPE_CHECKING:
    from garmentbench.reference import Reference
    from garmentbench.scenes.presets import Preset
    from garmentbench.scenes.scene import Scene


@dataclass(frozen=True)
class Simulate:
    """Simulate scenes into reference sequences, several at a time. Existing ones by the same code are reused.

    All are checked before the first is simulated; where one fails, the others are made. Of each new one
    it says what `check` would warn of.

    With --garment: one scene of any garment in any motion on any body. It is written to scenes/ in the home folder, and
    from then on its name, <garment>-<motion> or <garment>-<motion>-<body>, can be used wherever a scene's name is.

    Example: garmentbench simulate tshirt-armspace-75 tshirt-armspace-90 --preset smoke
    Example: garmentbench simulate "dress-*" split=test --jobs 2
    Example: garmentbench simulate --all
    Example: garmentbench simulate dress-armspace-90 --runs 8
    Example: garmentbench simulate --garment poncho.npz --motion catwalk --body slim --frames 100

    Attributes:
        scenes: Names or patterns of scenes, paths of TOML files, and filters by garment, body, motion or split.
        all: All scenes there are.
        garment: The mesh of your own garment (.npz or .obj, in metres, z up), or the name of a garment.
        motion: With --garment: the name of a motion, or a clip by `garmentbench import-motion` (.npz).
        body: With --garment: the name of a body.
        frames: With --garment: the scene's length.
        split: With --garment: train or test.
        pins: With --garment: what the body holds fast, "top 3 cm" or the name of a group of faces in an OBJ file.
        runs: Runs in all of each scene, further ones changed in what should not matter; by default 4 of what is for
            testing, one of what is for training.
        jobs: How many at a time; by default one a core.
        preset: Size: smoke, laptop, desktop or paper.
        mesh: Another size of garment and body than the preset's.
        device: auto, cpu or cuda.
    """

    scenes: Positional[tuple[str, ...]] = ()
    all: bool = False
    garment: str = ""
    motion: str = "armspace-90"
    body: str = "base"
    frames: int = 100
    split: Literal["train", "test"] = "test"
    pins: str = ""
    runs: int | None = None
    jobs: int | None = None
    preset: str = "laptop"
    mesh: str | None = None
    device: str = "auto"

    def run(self) -> None:
        from garmentbench.device import choose_device, one_thread, quiet_warp, require_device
        from garmentbench.reference import check_scene
        from garmentbench.scenes.choice import choose_scenes, chosen_files
        from garmentbench.scenes.presets import preset
        from garmentbench.scenes.wardrobe import save_scene
        from garmentbench.storage.machine import core_count

        size = preset(self.preset, self.mesh)
        if not self.scenes and not self.all and not self.garment:
            raise UsageError("simulate: which scene? `garmentbench scenes` lists them; --all simulates them all")
        if self.garment and (self.scenes or self.all):
            raise UsageError("simulate: --garment makes a scene of its own; give it without names and without --all")
        if self.jobs is not None and self.jobs < 1:
            raise UsageError(f"simulate: --jobs is {self.jobs}; wanted at least 1")
        if self.runs is not None and self.runs < 1:
            raise UsageError(f"simulate: --runs is {self.runs}; wanted at least 1")
        scenes = [self._own_scene()] if self.garment else choose_scenes(self.scenes)
        files = {} if self.garment else chosen_files(self.scenes)
        for scene in scenes:
            check_scene(scene, files.get(scene.name))
        if self.garment:
            print(f"{scenes[0].name}: {save_scene(scenes[0])}")
        started = time.time()
        one_thread()
        quiet_warp()
        choose_device(self.device)
        require_device(size)
        workers = min(len(scenes), self.jobs or core_count())
        made = (
            _in_parallel(scenes, size, self.runs, workers)
            if workers > 1
            else [_made(scene, size, self.runs) for scene in scenes]
        )
        failed = [message for message in made if isinstance(message, str)]
        for scene, reference in zip(scenes, made, strict=True):
            if not isinstance(reference, str):
                failed += _print(reference, started, own=scene.mesh is not None)
        if failed:
            raise UserError(f"{len(failed)} of {len(made)} failed, the first: {failed[0]}")

    def _own_scene(self) -> "Scene":
        """The scene of --garment, --motion and --body."""
        from garmentbench.reference import check_scene
        from garmentbench.scenes.garment_file import ENDINGS, garment_name
        from garmentbench.scenes.scene import MeshFile, Motion, Scene
        from garmentbench.scenes.wardrobe import scene_name, scene_names, wardrobe

        known, own = wardrobe(), Path(self.garment).suffix.lower() in ENDINGS
        garment = garment_name(self.garment) if own else self.garment
        if self.frames < 4:
            raise UsageError(f"simulate: --frames is {self.frames}; wanted at least 4")
        if self.pins and not own:
            raise UsageError("simulate: --pins says what is pinned of your own mesh; give its file as --garment")
        clip = Path(self.motion).suffix != ""
        motion = Motion("clip", file=str(Path(self.motion).resolve())) if clip else Motion(self.motion)
        name = scene_name(garment, garment_name(self.motion) if clip else self.motion, self.body)
        scene = known.entry(garment).worn(Scene(name, garment, self.body, motion, self.split, self.frames))
        if own:
            mesh = MeshFile(Path(self.garment).resolve().as_posix(), self.pins or None)
            scene = replace(scene, mesh=mesh)
            if garment in known.garments:
                check_scene(scene)  # a wrong motion or body is told first
                instead = f"simulate {name}" if name in scene_names() else f"--garment {garment}"
                raise UsageError(
                    f"simulate: '{garment}' is already a garment of the wardrobe: `{instead}`, or rename {self.garment}"
                )
        return known.wearing(scene)


def _print(reference: "Reference", started: float, own: bool) -> list[str]:
    """The sequence's path and spread, where it went wrong, and, if it was made since `started` (a time of
    `time.time`), what `check` would say; of a garment of the user's own always, with whether it is worn. Gives the
    errors."""
    from garmentbench import sequence_file
    from garmentbench.commands.check import looked_into
    from garmentbench.errors import errors
    from garmentbench.metrics.push_growth import regime
    from garmentbench.report.card_text import flaw
    from garmentbench.sequence_file.examine import check_sequence

    sequence = sequence_file.load(reference.path, frames=1)
    spread, simulation = sequence.spread_cm, sequence.info.get("simulation", {})
    told = "" if spread is None else f": spread {spread:.2g} cm, {regime(sequence.push_growth)}"
    print(f"{reference.path}{told}")
    chance = flaw("spread", spread)
    if chance is not None:
        do = "Errors below it mean nothing: raise bending in its [material], shorten what hangs free"
        cross = "" if simulation.get("settings", {}).get("self_contact") else ", switch self_contact on if faces cross"
        print(f"{reference.name}: warning: {chance} {do}{cross}.")
    for run in sequence.info.get("runs", ()):
        if run["first_bad_frame"] is not None:
            print(f"{reference.name}: run {run['name']} is {run['status']} from frame {run['first_bad_frame']} on")
    if simulation.get("first_bad_frame") is not None:
        bad = f"{simulation['status']} from frame {simulation['first_bad_frame']} on"
        print(f"{reference.name}: {bad}, see its data card")
    problems = []
    if own or reference.path.stat().st_mtime >= started - 1:
        problems = check_sequence(reference.path)
        if own and not errors(problems):
            problems += looked_into(sequence_file.load(reference.path))
    for problem in problems:
        print(f"{reference.name}: {'warning' if problem.warning else 'error'}: {problem}")
    return [f"{reference.name}: {problem}" for problem in errors(problems)]


def _made(scene: "Scene", size: "Preset", runs: int | None) -> "Reference | str":
    """The reference of a scene, or why it could not be made."""
    from garmentbench.reference import make_reference

    try:
        return make_reference(scene, size, runs)
    except UserError as e:
        return f"simulate {scene.name}: {e}"


def _in_parallel(scenes: list["Scene"], size: "Preset", runs: int | None, workers: int) -> "list[Reference | str]":
    """The references, or why one could not be made."""
    from garmentbench.reference import make_reference
    from garmentbench.storage.jobs import Failure, Job, run_jobs

    jobs = [
        Job((scene.name,), f"simulate {scene.name}", make_reference, arguments=(scene, size, runs), cost=scene.frames)
        for scene in scenes
    ]
    made = run_jobs({job.key: job for job in jobs}, workers)
    results = [made[job.key] for job in jobs]
    return [f"{r.label}: {r.message}" if isinstance(r, Failure) else r for r in results]
