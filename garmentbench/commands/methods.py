"""Commands about methods: list, check, train, evaluate."""

from dataclasses import dataclass

from tyro.conf import Positional

from garmentbench.commands.table import print_table
from garmentbench.errors import UserError


@dataclass(frozen=True)
class Methods:
    """List the methods and their variants.

    Example: garmentbench methods
    """

    def run(self) -> None:
        from garmentbench.methods import method_names
        from garmentbench.pipeline import load_method, variants

        print_table([{"method": name, "variants": ", ".join(variants(load_method(name)))} for name in method_names()])


@dataclass(frozen=True)
class CheckMethod:
    """Try a method on a tiny scene and say what its author has to mend.

    Example: garmentbench check-method my_package.my_module:MyMethod

    Attributes:
        method: A method's name, or module:Class.
    """

    method: Positional[str]

    def run(self) -> None:
        from garmentbench.evaluation.check_method import check_method
        from garmentbench.pipeline import configuration, load_method
        from garmentbench.scenes.presets import preset

        method = load_method(self.method)
        problems = check_method(method, configuration(method, "full", preset("smoke")))
        for problem in problems:
            print(problem)
        if problems:
            raise UserError(f"{self.method}: breaks the contract, see above")
        print(f"{self.method}: keeps the contract")


@dataclass(frozen=True)
class Train:
    """Train a method on a scene. A finished run is reused, an interrupted one resumes.

    Example: garmentbench train motion_guided --scene tshirt-armspace-75 --preset smoke

    Attributes:
        method: A method's name, or module:Class.
        scene: Scene to train on, or a sequence file (.h5).
        preset: Size: smoke, laptop or paper.
        frames: Train on the first so many frames.
        variant: "full", or one of the method's variants (`garmentbench methods`).
        seed: Random seed.
        device: auto, cpu or cuda.
    """

    method: Positional[str]
    scene: str = "tshirt-armspace-75"
    preset: str = "laptop"
    frames: int = 300
    variant: str = "full"
    seed: int = 0
    device: str = "auto"

    def run(self) -> None:
        _ready(self.preset, self.device, self.scene)
        run = _trained(self)
        print(f"{run.id}: {run.folder}")


@dataclass(frozen=True)
class Evaluate:
    """Roll a method out on a scene and measure it, after training it if that has not been done.

    Example: garmentbench evaluate skinning --scene tshirt-armspace-90 --preset smoke

    Attributes:
        method: A method's name, module:Class, or the id of a training's run (train-...), which is then evaluated as it is.
        train_scene: Scene that it was, or will be, trained on, or a sequence file (.h5).
        scene: Scene to evaluate on, or a sequence file (.h5).
        preset: Size: smoke, laptop or paper.
        frames: Train on the first so many frames.
        variant: "full", or one of the method's variants (`garmentbench methods`).
        seed: Random seed of the training.
        device: auto, cpu or cuda.
    """

    method: Positional[str]
    train_scene: str = "tshirt-armspace-75"
    scene: str = "tshirt-armspace-90"
    preset: str = "laptop"
    frames: int = 300
    variant: str = "full"
    seed: int = 0
    device: str = "auto"

    def run(self) -> None:
        from garmentbench.pipeline import evaluate
        from garmentbench.scenes.presets import preset
        from garmentbench.storage.runs import RunStore

        finished = self.method.startswith("train-")
        _ready(self.preset, self.device, *([] if finished else [self.train_scene]), self.scene)
        trained = RunStore().get(self.method) if finished else _trained(self)
        run = evaluate(trained, self.scene, preset(self.preset), RunStore())
        print_table(
            [{k: row.get(k) for k in ("metric", "horizon", "value", "unit", "status")} for row in run.results["rows"]]
        )
        print(f"{run.id}: {run.folder}")


def _ready(preset_name: str, device: str, *scenes: str) -> None:
    """Complain of a wrong name or a missing device before any work is done."""
    from garmentbench.device import choose_device, one_thread, require_device
    from garmentbench.reference import check_source
    from garmentbench.scenes.presets import preset

    size = preset(preset_name)
    for scene in scenes:
        check_source(scene)
    one_thread()
    choose_device(device)
    require_device(size)


def _trained(options: Train | Evaluate):
    from garmentbench.pipeline import train
    from garmentbench.scenes.presets import preset
    from garmentbench.storage.runs import RunStore

    scene = options.scene if isinstance(options, Train) else options.train_scene
    size = preset(options.preset)
    return train(options.method, options.variant, scene, size, options.frames, options.seed, RunStore())
