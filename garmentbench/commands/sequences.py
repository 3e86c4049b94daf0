"""The command that makes data."""

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

    With --garment: one scene of any garment in any motion on any body. It is written to scenes/ in the home folder, and
    from then on its name, <garment>-<motion> or <garment>-<motion>-<body>, can be used wherever a scene's name is.

    Example: garmentbench simulate tshirt-armspace-75 tshirt-armspace-90 --preset smoke
    Example: garmentbench simulate "dress-*" split=test --jobs 2
    Example: garmentbench simulate --all
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
        jobs: How many at a time; by default one a core.
        preset: Size: smoke, laptop or paper.
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
    jobs: int | None = None
    preset: str = "laptop"
    mesh: str | None = None
    device: str = "auto"

    def run(self) -> None:
        from garmentbench import sequence_file
        from garmentbench.device import choose_device, one_thread, require_device
        from garmentbench.reference import check_scene, make_reference
        from garmentbench.scenes.choice import choose_scenes
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
        scenes = [self._own_scene()] if self.garment else choose_scenes(self.scenes)
        for scene in scenes:
            check_scene(scene)
        if self.garment:
            print(f"{scenes[0].name}: {save_scene(scenes[0])}")
        one_thread()
        choose_device(self.device)
        require_device(size)
        workers = min(len(scenes), self.jobs or core_count())
        made = _in_parallel(scenes, size, workers) if workers > 1 else [make_reference(s, size) for s in scenes]
        for reference in made:
            sequence = sequence_file.load(reference.path, frames=1)
            doubt, told = sequence.uncertainty_cm, sequence.info.get("simulation", {})
            print(reference.path if doubt is None else f"{reference.path}: ± {doubt:.2g} cm")
            if told.get("first_bad_frame") is not None:
                print(f"{reference.name}: {told['status']} from frame {told['first_bad_frame']} on, see its data card")

    def _own_scene(self) -> "Scene":
        """The scene of --garment, --motion and --body."""
        from garmentbench.scenes.garment_file import ENDINGS, garment_name
        from garmentbench.scenes.scene import MeshFile, Motion, Scene
        from garmentbench.scenes.wardrobe import scene_name, wardrobe

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
            if garment in known.garments:
                raise UsageError(f"simulate: the wardrobe has a garment '{garment}'; rename {self.garment}")
            mesh = MeshFile(Path(self.garment).resolve().as_posix(), self.pins or None)
            scene = replace(scene, mesh=mesh)
        return known.wearing(scene)


def _in_parallel(scenes: list["Scene"], size: "Preset", workers: int) -> list["Reference"]:
    """The references. Raises `UserError` at the end if one could not be made."""
    from garmentbench.reference import make_reference
    from garmentbench.storage.jobs import Failure, Job, run_jobs

    jobs = [
        Job((scene.name,), f"simulate {scene.name}", make_reference, arguments=(scene, size), cost=scene.frames)
        for scene in scenes
    ]
    made = run_jobs({job.key: job for job in jobs}, workers)
    results = [made[job.key] for job in jobs]
    failed = [result for result in results if isinstance(result, Failure)]
    if failed:
        raise UserError(f"{len(failed)} of {len(jobs)} failed, the first: {failed[0].label}: {failed[0].message}")
    return results
