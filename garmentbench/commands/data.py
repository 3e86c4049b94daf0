"""Commands that show and make data."""

from dataclasses import dataclass

from tyro.conf import Positional

from garmentbench.commands.table import print_table


@dataclass(frozen=True)
class Scenes:
    """List the scenes, or show what one holds, what it needs and what is left out for it.

    Example: garmentbench scenes sheet-stick-a

    Attributes:
        scene: A scene's name, or the path of a TOML file.
    """

    scene: Positional[str] = ""

    def run(self) -> None:
        from garmentbench.scene import load_scene, scene_names

        if self.scene:
            _show(load_scene(self.scene))
            return
        scenes = [load_scene(name) for name in scene_names()]
        print_table([
            {"scene": s.name, "garment": s.garment, "body": s.body, "motion": s.motion.name, "split": s.split,
             "frames": s.frames}
            for s in scenes
        ])


def _show(scene) -> None:
    from dataclasses import asdict

    from garmentbench.making import scene_needs
    from garmentbench.presets import preset

    for key, value in asdict(scene).items():
        if value not in ({}, None):
            print(f"{key}: {value}")
    needs = asdict(scene_needs(scene, preset("smoke")))  # which size does not matter
    print("needs: " + (", ".join(k for k, v in needs.items() if v) or "nothing besides the garment"))
    print("left out: " + (", ".join(k for k, v in needs.items() if not v) or "nothing"))


@dataclass(frozen=True)
class Simulate:
    """Simulate scenes into reference sequences. What is there already, made by the same code, is kept.

    Example: garmentbench simulate tshirt-armspace-75 tshirt-armspace-90 --preset smoke

    Attributes:
        scenes: Names of scenes, or paths of TOML files.
        preset: Size: smoke, laptop or paper.
        device: auto, cpu or cuda.
    """

    scenes: Positional[tuple[str, ...]]
    preset: str = "laptop"
    device: str = "auto"

    def run(self) -> None:
        from garmentbench.device import choose_device, one_thread, require_device
        from garmentbench.errors import UsageError
        from garmentbench.presets import preset
        from garmentbench.scene import load_scene
        from garmentbench.making import make_sequence

        size = preset(self.preset)
        if not self.scenes:
            raise UsageError("simulate: which scene? `garmentbench scenes` lists them")
        for name in self.scenes:  # before any work: a typo in the last name is told at once
            load_scene(name)
        one_thread()
        choose_device(self.device)
        require_device(size)
        for name in self.scenes:
            print(make_sequence(name, size))
