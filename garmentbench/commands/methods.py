"""Commands about methods: list, check, train, evaluate."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from tyro.conf import Positional, UseAppendAction

from garmentbench.commands.table import print_table
from garmentbench.errors import UserError

if TYPE_CHECKING:
    from garmentbench.reference import Source
    from garmentbench.scenes.presets import Preset
    from garmentbench.storage.runs import Run

Repeated = Annotated[tuple[str, ...], UseAppendAction]  # an option that may be given several times


@dataclass(frozen=True)
class Methods:
    """List the methods and their variants.

    Example: garmentbench methods
    """

    def run(self) -> None:
        from garmentbench.methods import method_names
        from garmentbench.pipeline.choice import load_method, variants

        print_table([{"method": name, "variants": ", ".join(variants(load_method(name)))} for name in method_names()])


@dataclass(frozen=True)
class CheckMethod:
    """Try a method on tiny scenes, check by check, and say what its author has to mend.

    Exit code 1 if a check fails. The same checks run in pytest by garmentbench.parametrize_with_checks.

    Example: garmentbench check-method my_module:MyMethod

    Attributes:
        method: A method's name, or module:Class (in an installed package or in the working folder).
    """

    method: Positional[str]

    def run(self) -> None:
        from garmentbench.device import one_thread
        from garmentbench.evaluation.check_method import check_method
        from garmentbench.pipeline.choice import choose_method
        from garmentbench.scenes.presets import preset

        one_thread()
        choice = choose_method(self.method, "full", preset("smoke"))
        report = check_method(choice.method, choice.config, lambda result: print(result, flush=True))
        skipped = f", {report.skipped} skipped" if report.skipped else ""
        if not report.ok:
            failed = f"{len(report.problems)} of {len(report.results)} checks failed"
            raise UserError(f"{self.method}: {failed}{skipped}, see above")
        print(f"{self.method}: keeps the contract{skipped}")


@dataclass(frozen=True)
class Train:
    """Train a method on one or more scenes. A finished run is reused, an interrupted one resumes.

    Example: garmentbench train motion_guided --scene tshirt-armspace-75 --preset smoke
    Example: garmentbench train linear_subspace --scene tshirt-armspace-75 --scene tshirt-dance-latin
    Example: garmentbench train subspace_network --scene dress@varied

    Attributes:
        method: A method's name, or module:Class (in an installed package or in the working folder).
        scene: Scene to train on, a sequence file (.h5), or a garment's training set, GARMENT@SET, the sets being walk,
            dance, walk-dance, walk-bodies, varied and your own. Several of the same garment may be given, each with
            --scene; tshirt-armspace-75 if none is.
        preset: Size: smoke, laptop, desktop or paper.
        mesh: Another size of garment and body than the preset's.
        model: Another size of the method's network than the preset's.
        frames: How many frames of each scene to train on, from the first on; a training set says so itself.
        variant: "full", or one of the method's variants (`garmentbench methods`).
        seed: Random seed.
        device: auto, cpu or cuda.
    """

    method: Positional[str]
    scene: Repeated = ()
    preset: str = "laptop"
    mesh: str | None = None
    model: str | None = None
    frames: int = 300
    variant: str = "full"
    seed: int = 0
    device: str = "auto"

    def run(self) -> None:
        size = _ready(self)
        run = _trained(self, size, *_training(self.scene or ("tshirt-armspace-75",)))
        print(f"{run.id}: {run.folder}")


@dataclass(frozen=True)
class Evaluate:
    """Roll a method out on a scene and measure it, after training it if that has not been done.

    Exit code 1 if the method failed (it raised, or returned something else than garment vertices). A roll-out that
    diverged (NaN, or far off, be it in its first frame) is a result: it is said on stderr, its rows say so too, and the
    exit code is 0.

    Example: garmentbench evaluate skinning --scene tshirt-armspace-90 --preset smoke
    Example: garmentbench evaluate my_module:MyMethod --train-scene tshirt-armspace-75 --train-scene tshirt-dance-latin
    Example: garmentbench evaluate checkpoints/tshirt-motion_guided

    Attributes:
        method: A method's name, module:Class, or what is evaluated as it is: the id of a training's run (train-...), or
            the folder of a checkpoint.
        train_scene: Scene that it was, or will be, trained on, a sequence file (.h5) or a training set, GARMENT@SET.
            Several of the same garment may be given, each with --train-scene. If none is: the first training scene of
            the garment in --scene.
        scene: Scene to evaluate on, or a sequence file (.h5).
        preset: Size: smoke, laptop, desktop or paper.
        mesh: Another size of garment and body than the preset's.
        model: Another size of the method's network than the preset's.
        frames: How many frames of each scene to train on, from the first on; a training set says so itself.
        variant: "full", or one of the method's variants (`garmentbench methods`).
        seed: Random seed of the training.
        device: auto, cpu or cuda.
    """

    method: Positional[str]
    train_scene: Repeated = ()
    scene: str = "tshirt-armspace-90"
    preset: str = "laptop"
    mesh: str | None = None
    model: str | None = None
    frames: int = 300
    variant: str = "full"
    seed: int = 0
    device: str = "auto"

    def run(self) -> None:
        from garmentbench.evaluation.results import warnings
        from garmentbench.evaluation.rollout import FAILED, OK
        from garmentbench.pipeline.checkpoint import is_checkpoint, read_checkpoint
        from garmentbench.pipeline.choice import default_training_scene, load_method
        from garmentbench.pipeline.evaluate import evaluate
        from garmentbench.pipeline.same_meshes import OtherGarmentError
        from garmentbench.reference import resolve_source
        from garmentbench.storage.runs import RunStore

        size = _ready(self)
        source = resolve_source(self.scene)
        training, lengths = _training(self.train_scene)
        if self.method.startswith("train-"):
            trained = RunStore().get(self.method)
        elif is_checkpoint(self.method):
            trained = read_checkpoint(Path(self.method), RunStore())
        else:
            training = training or [default_training_scene(load_method(self.method), source)]
            trained = _trained(self, size, training, lengths)
        try:
            run = evaluate(trained, source, size, RunStore())
        except OtherGarmentError as e:
            raise UserError(f"{e}; give --train-scene a scene of that garment") from e
        columns = ("metric", "horizon", "value", "spread", "unit", "reference_value", "status")
        print_table([{k: row.get(k) for k in columns} for row in run.results["rows"]])
        for warning in warnings(run.results["rows"]):
            print(f"warning: {warning}")
        print(f"{run.id}: {run.folder}")
        status, frame, message = (run.results[k] for k in ("status", "first_bad_frame", "message"))
        if status != OK:
            said = f"{trained.identity['method']} {status} at frame {frame} of {run.identity['scene']}: {message}"
            if status == FAILED:
                raise UserError(said)
            print(f"garmentbench: {said}", file=sys.stderr)


@dataclass(frozen=True)
class Checkpoint:
    """Write a trained method as a folder to give away: its numbers as safetensors, config.json, and a card (README.md).

    `garmentbench evaluate FOLDER` evaluates it anywhere. The card has what it was trained on, what that cost, and its
    errors on the scenes given, of the folder as it is read back.

    Example: garmentbench checkpoint train-1f00c0ffee12 checkpoints/my-skirt --scene pleated_skirt-armspace-90

    Attributes:
        trained: Id of a finished training (train-...).
        folder: To write; a checkpoint that is there is replaced.
        scene: Scene to evaluate it on, for its card. Several may be given, each with --scene.
        half: Keep the large arrays with 16 bits a number: half the size.
        preset: Size of the scenes: smoke, laptop, desktop or paper.
    """

    trained: Positional[str]
    folder: Positional[Path]
    scene: Repeated = ()
    half: bool = False
    preset: str = "laptop"

    def run(self) -> None:
        from garmentbench.device import one_thread
        from garmentbench.pipeline.checkpoint import read_checkpoint, write_card, write_checkpoint
        from garmentbench.pipeline.evaluate import evaluate
        from garmentbench.reference import resolve_source
        from garmentbench.scenes.presets import preset
        from garmentbench.storage.runs import RunStore

        one_thread()
        store, size = RunStore(), preset(self.preset)
        sources = [resolve_source(name) for name in self.scene]
        write_checkpoint(store.get(self.trained), self.folder, self.half)
        kept = read_checkpoint(self.folder, store)
        runs = [(source.name, evaluate(kept, source, size, store)) for source in sources]
        write_card(self.folder, [(name, row) for name, run in runs for row in run.results["rows"]])
        print(f"{self.folder}: {kept.id} when it is read back")


def _ready(options: Train | Evaluate) -> "Preset":
    """The preset that was chosen. Complains of a wrong one or a missing device before any work is done."""
    from garmentbench.device import choose_device, one_thread, require_device
    from garmentbench.scenes.presets import preset

    size = preset(options.preset, options.mesh, options.model)
    one_thread()
    choose_device(options.device)
    require_device(size)
    return size


def _training(words: Sequence[str]) -> tuple[list["Source"], dict[str, int]]:
    """The training sources that words stand for, and how many frames of those in training sets are taken."""
    from garmentbench.reference import resolve_source
    from garmentbench.scenes.training_sets import expanded

    names, lengths = expanded(words)
    return [resolve_source(name) for name in names], lengths


def _trained(options: Train | Evaluate, size: "Preset", sources: list["Source"], lengths: dict[str, int]) -> "Run":
    from garmentbench.pipeline.choice import choose_method
    from garmentbench.pipeline.train import train
    from garmentbench.storage.runs import RunStore

    choice = choose_method(options.method, options.variant, size)
    return train(choice, sources, size, options.frames, options.seed, RunStore(), lengths)
