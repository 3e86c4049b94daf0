"""Which method, with which configuration, and what it is trained on where nobody says."""

import os
import sys
from dataclasses import dataclass
from typing import Any

from garmentbench import sequence_file
from garmentbench.errors import FOREIGN, UsageError, UserError, described, unknown_name
from garmentbench.method import Method
from garmentbench.reference import Source
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.wardrobe import load_scene, scene_names
from garmentbench.sequence import GARMENT, HUMAN, OBJECT


@dataclass(frozen=True)
class MethodChoice:
    """A method to be trained.

    Attributes:
        method: Its class.
        name: What the class calls itself; tables, runs and results.csv use this name.
        variant: "full", or one of the method's variants.
        config: The configuration that the variant has at a network size.
    """

    method: type[Method]
    name: str
    variant: str
    config: Any

    @property
    def random(self) -> bool:
        """Does the seed change what the method learns?"""
        return getattr(self.method, "random", True)


def load_method(name: str) -> type[Method]:
    """The method of that name, or the class at "module:Class", whose module may lie in the working folder.

    Raises `UsageError`, with the nearest name for an unknown one, and for a class that is no method.
    """
    from garmentbench.evaluation.check_method import missing_parts
    from garmentbench.methods import load_method as load

    if os.getcwd() not in sys.path:  # a console script's path begins with the script's folder
        sys.path.insert(0, os.getcwd())
    method = load(name)
    missing = missing_parts(method)
    if missing:
        raise UsageError(f"{name}: is no method: {missing[0]}")
    return method


def variants(method: type[Method]) -> dict[str, Any]:
    """A method's variants: functions that change the full configuration. Its module may offer more than "full"."""
    return getattr(sys.modules[method.__module__], "VARIANTS", {"full": lambda full: full})


def choose_method(method: str | type[Method], variant: str, preset: Preset) -> MethodChoice:
    """A method and its configuration.

    Args:
        method: A method's name, "module:Class", or the class itself.
        variant: "full", or one of the method's variants.
        preset: Its network size chooses the configuration, where the method's module has a `config_for`.

    Raises:
        UsageError: The method or the variant is unknown, or its configuration can't be made.
    """
    method = load_method(method) if isinstance(method, str) else method
    if method.__module__ == "__main__":
        raise UsageError(
            f"{method.name}: its class has no file that a run could load it from again; write it into my_module.py and "
            f'name it "my_module:{method.__qualname__}", or call fit, roll_out and score by hand'
        )
    known = variants(method)
    if variant not in known:
        raise unknown_name(f"variant of {method.name}", variant, list(known))
    module = sys.modules[method.__module__]
    try:
        full = module.config_for(preset.model) if hasattr(module, "config_for") else method.Config()
        return MethodChoice(method, method.name, variant, known[variant](full))
    except UserError:
        raise
    except FOREIGN as e:
        raise UsageError(f"{method.name}: its configuration '{variant}' raised {described(e, method)}; mend it") from e


def default_training_scene(method: type[Method], source: Source) -> Source:
    """What to train on where the user gives only a source to be tested on: the first training scene of its garment.

    A method that learns nothing is "trained" on the source itself where there is no such scene. Raises `UsageError`
    for any other method.
    """
    garment, on = _worn(source)
    for scene in map(load_scene, scene_names()):
        if scene.split == "train" and (scene.garment, _wearer(scene)) == (garment, on):
            return scene
    if not getattr(method, "learns", True):
        return source
    raise UsageError(f"no training scene has the garment '{garment}' of {source.name}; give one with --train-scene")


def _worn(source: Source) -> tuple[str, str]:
    """A source's garment, and what kind of thing it is on."""
    if isinstance(source, Scene):
        return source.garment, _wearer(source)
    template = sequence_file.load(source.path, frames=1).template
    return template.garment.name, "none" if template.body is None else template.body.kind


def _wearer(scene: Scene) -> str:
    return GARMENT if scene.worn_over is not None else OBJECT if scene.body == "stick" else HUMAN
