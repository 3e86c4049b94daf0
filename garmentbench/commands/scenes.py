"""The command about scenes."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tyro.conf import Positional

from garmentbench.commands.table import print_table
from garmentbench.errors import UsageError

if TYPE_CHECKING:
    from garmentbench.scenes.scene import Scene


@dataclass(frozen=True)
class Scenes:
    """List the scenes, or show what one holds, what it needs and what is left out for it.

    Example: garmentbench scenes show sheet-stick-a
    Example: garmentbench scenes garment=dress split=test
    Example: garmentbench scenes "*-slim"

    Attributes:
        words: "show" and a scene's name (or the path of a TOML file; the name alone will do), or which ones to list:
            patterns, and filters by garment, body, motion or split.
    """

    words: Positional[tuple[str, ...]] = ()

    def run(self) -> None:
        from garmentbench.scenes.choice import choose_scenes, is_choice
        from garmentbench.scenes.scene import load_scene

        shown = self.words[1:] if self.words[:1] == ("show",) else self.words if len(self.words) == 1 else ()
        if self.words == ("show",):
            raise UsageError("scenes show: which scene? `garmentbench scenes` lists them")
        if shown and not any(map(is_choice, shown)):
            for name in shown:
                _show(load_scene(name))
            return
        scenes = [load_scene(name) for name in choose_scenes(shown or self.words)]
        print_table([
            {"scene": s.name, "garment": s.garment, "body": s.body, "motion": s.motion.name, "split": s.split,
             "frames": s.frames}
            for s in scenes
        ])  # fmt: skip


def _show(scene: "Scene") -> None:
    from dataclasses import asdict

    from garmentbench.reference import scene_needs
    from garmentbench.scenes.presets import preset
    from garmentbench.scenes.scene import Motion

    plain = Motion(scene.motion.name)
    changed = {key: value for key, value in vars(scene.motion).items() if value != getattr(plain, key)}
    for key, value in vars(scene).items():
        if key == "motion":
            print("motion: " + ", ".join([scene.motion.name, *(f"{k} {v}" for k, v in changed.items())]))
        elif value not in ({}, None):
            print(f"{key}: {value}")
    needs = asdict(scene_needs(scene, preset("smoke")))  # which size does not matter
    print("needs: " + (", ".join(k for k, v in needs.items() if v) or "nothing besides the garment"))
    print("left out: " + (", ".join(k for k, v in needs.items() if not v) or "nothing"))
