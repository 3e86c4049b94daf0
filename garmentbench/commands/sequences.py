"""The command that makes data."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tyro.conf import Positional

from garmentbench.errors import UsageError, UserError

if TYPE_CHECKING:
    from garmentbench.reference import Reference
    from garmentbench.scenes.presets import Preset
    from garmentbench.scenes.scene import Scene


@dataclass(frozen=True)
class Simulate:
    """Simulate scenes into reference sequences, several at a time. Existing ones by the same code are reused.

    Example: garmentbench simulate tshirt-armspace-75 tshirt-armspace-90 --preset smoke
    Example: garmentbench simulate "dress-*" split=test --jobs 2
    Example: garmentbench simulate --all

    Attributes:
        scenes: Names or patterns of scenes, paths of TOML files, and filters by garment, body, motion or split.
        all: All scenes there are.
        jobs: So many at a time; by default one a core.
        preset: Size: smoke, laptop or paper.
        device: auto, cpu or cuda.
    """

    scenes: Positional[tuple[str, ...]] = ()
    all: bool = False
    jobs: int | None = None
    preset: str = "laptop"
    device: str = "auto"

    def run(self) -> None:
        from garmentbench import sequence_file
        from garmentbench.device import choose_device, one_thread, require_device
        from garmentbench.reference import check_scene, make_reference
        from garmentbench.scenes.choice import choose_scenes
        from garmentbench.scenes.presets import preset
        from garmentbench.storage.machine import core_count

        size = preset(self.preset)
        if not self.scenes and not self.all:
            raise UsageError("simulate: which scene? `garmentbench scenes` lists them; --all simulates them all")
        if self.jobs is not None and self.jobs < 1:
            raise UsageError(f"simulate: --jobs is {self.jobs}; wanted at least 1")
        scenes = choose_scenes(self.scenes)
        for scene in scenes:
            check_scene(scene)
        one_thread()
        choose_device(self.device)
        require_device(size)
        workers = min(len(scenes), self.jobs or core_count())
        made = _in_parallel(scenes, size, workers) if workers > 1 else [make_reference(s, size) for s in scenes]
        for reference in made:
            doubt = sequence_file.load(reference.path, frames=1).uncertainty_cm
            print(reference.path if doubt is None else f"{reference.path}: ± {doubt:.2g} cm")


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
