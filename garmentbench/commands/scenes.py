"""The command about scenes."""

from dataclasses import dataclass, fields, is_dataclass
from typing import TYPE_CHECKING

from tyro.conf import Positional

from garmentbench.commands.table import print_table
from garmentbench.errors import UsageError

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    from garmentbench.scenes.scene import Scene


@dataclass(frozen=True)
class Scenes:
    """List the scenes, or show one: what it holds, what methods get with it and what they do without.

    Example: garmentbench scenes show sheet-stick-a
    Example: garmentbench scenes garment=dress split=test
    Example: garmentbench scenes "*-slim"

    Attributes:
        words: "show" and a scene's name (or the path of a TOML file; the name alone will do), or which ones to list:
            patterns, and filters by garment, body, motion or split, as in the examples.
    """

    words: Positional[tuple[str, ...]] = ()

    def run(self) -> None:
        from garmentbench.reference import check_scene
        from garmentbench.scenes.choice import choose_scenes, is_choice
        from garmentbench.scenes.wardrobe import scene_file

        shown = self.words[1:] if self.words[:1] == ("show",) else self.words if len(self.words) == 1 else ()
        if self.words == ("show",):
            raise UsageError("scenes show: which scene? `garmentbench scenes` lists them")
        scenes = choose_scenes(shown or self.words)
        if shown and not any(map(is_choice, shown)):
            for word, scene in zip(dict.fromkeys(shown), scenes, strict=True):
                check_scene(scene, scene_file(word))
                _show(scene)
            return
        print_table([
            {"scene": s.name, "garment": s.garment, "body": s.body, "motion": s.motion.name, "split": s.split,
             "frames": s.frames}
            for s in scenes
        ])  # fmt: skip


def _show(scene: "Scene") -> None:
    from garmentbench.needs import scene_parts
    from garmentbench.scenes.presets import PRESETS

    for key, value in vars(scene).items():
        if value is None:
            continue
        if key == "worn_over":
            value = value.name
        elif is_dataclass(value) and not isinstance(value, type):
            value = _changed(value)
        if value:
            print(f"{key}: {value}")
    parts = scene_parts(scene, PRESETS["smoke"])  # the quickest to look at
    print("needs: " + (", ".join(part.name for part in parts if part.needed) or "nothing besides the garment"))
    for part in parts:
        if not part.needed:
            print(f"left out: {part.name}: {part.because}")
    for line in _simulated(scene):
        print(line)


def _simulated(scene: "Scene") -> list[str]:
    """A line a mesh size at which it has been simulated: its runs, their spread, contracting or chaotic."""
    from garmentbench import sequence_file
    from garmentbench.errors import UserError
    from garmentbench.metrics.push_growth import regime
    from garmentbench.paths import sequence_path
    from garmentbench.reference import IDENTITY, reference_identity
    from garmentbench.scenes.presets import PRESETS

    lines = []
    for preset in PRESETS.values():
        path = sequence_path(preset.mesh.name, scene.name)
        if not path.is_file():
            continue
        try:
            sequence = sequence_file.load(path, frames=1)
        except UserError as e:
            lines.append(f"simulated, {preset.mesh.name}: {e}")
            continue
        runs, spread, growth = 1 + len(sequence.info.get("runs", ())), sequence.spread_cm, sequence.push_growth
        told = f"{runs} runs" if runs > 1 else "one run"
        told += "" if spread is None else f", spread {spread:.2g} cm"
        told += "" if growth is None else f", {regime(growth)}: a push of 1 mm is {growth:.2g} mm in the last fifth"
        old = "" if sequence.info.get(IDENTITY) == reference_identity(scene, preset) else " (of another scene or code)"
        lines.append(f"simulated, {preset.mesh.name}{old}: {told}")
    return lines


def _changed(value: "DataclassInstance") -> str:
    """What is not as it is by default; a name alone for itself."""
    changed = [f"{f.name} {getattr(value, f.name)}" for f in fields(value) if getattr(value, f.name) != f.default]
    return ", ".join(changed).removeprefix("name ")
