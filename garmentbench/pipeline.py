"""Train a method, roll it out, score it; finished work is reused.

Together with the command line this is the outermost shell: methods are reached from here. Only `choose_method` takes
names.
"""

import os
import sys
import tempfile
import traceback
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentbench import sequence_file
from garmentbench.device import device_name, quiet_warp, require_device
from garmentbench.errors import FOREIGN, UsageError, UserError, described, unknown_name
from garmentbench.method import HISTORY, Method
from garmentbench.reference import Source, make_reference
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.wardrobe import load_scene, scene_names
from garmentbench.sequence import GARMENT, HUMAN, OBJECT
from garmentbench.storage.atomic import write_text
from garmentbench.storage.fingerprint import content_hash, fingerprint
from garmentbench.storage.runs import Run, RunStore

if TYPE_CHECKING:
    from garmentbench.evaluation.rollout import RollOut
    from garmentbench.sequence import Sequence as Recording

# What decides an evaluation besides the method: also the form in which the report finds it.
EVALUATION = ("garmentbench.evaluation.rollout", "garmentbench.evaluation.score", "garmentbench.evaluation.excerpt")

__all__ = [
    "MethodChoice",
    "choose_method",
    "evaluate",
    "evaluate_another_run",
    "keep",
    "require_device",
    "train",
    "variants",
]


class OtherGarmentError(UserError):
    """A method would have to predict another garment than the one it was trained on."""


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


def train(
    choice: MethodChoice,
    sources: Sequence[Source],
    preset: Preset,
    frames: int,
    seed: int,
    store: RunStore,
    lengths: Mapping[str, int] | None = None,
) -> Run:
    """Train a method on the first `frames` of each of one or more sources (fewer where the preset limits them).

    Of the sources named in `lengths` it takes as many as that says, as a training set does.

    Returns:
        The finished run; the trained method is in its folder "method".

    Raises:
        UserError: Too few frames in a source, sources of different garments or bodies, or the method's `fit` raised.
    """
    if not sources:
        raise UsageError("train: no training scene is given; wanted at least one")
    if frames <= HISTORY:
        raise UsageError(
            f"train: {frames} frames asked for; wanted more than {HISTORY}, which are the history of the next"
        )
    counts = [preset.mesh.limited((lengths or {}).get(source.name, frames)) for source in sources]
    references = [make_reference(source, preset) for source in sources]
    identity = {
        "method": choice.name,
        "class": _address(choice.method),
        "variant": choice.variant,
        "train_scenes": [reference.name for reference in references],
        "preset": preset.name,
        "train_frames": counts[0] if len(set(counts)) == 1 else counts,
        "seed": seed if choice.random else 0,
        "config": choice.config,
        "data": [sequence_file.content_hash(reference.path) for reference in references],
        "code": fingerprint(choice.method.__module__),
        "device": device_name(),
    }
    with store.open("train", identity) as run:
        if not run.finished:
            sequences = tuple(_first_frames(r.path, count) for r, count in zip(references, counts, strict=True))
            for name, sequence in zip(identity["train_scenes"][1:], sequences[1:], strict=True):
                _require_same_meshes(identity["train_scenes"][0], sequences[0], name, sequence)
            folder = run.folder / "method"
            folder.mkdir(exist_ok=True)
            with _foreign_code(run, "fit", choice.method):
                choice.method.fit(sequences, choice.config, run).save(folder)
            run.finish({"garment": garment_mesh(sequences[0]), "random": choice.random})
    return _finished(run)


def training_run(folder: Path | str | None = None, seed: int = 0) -> Run:
    """A run to call a method's `fit` with by hand, in a notebook or a test.

    Args:
        folder: Where checkpoints and logs go; a new temporary folder if none is given.
        seed: The run's seed.
    """
    root = tempfile.mkdtemp(prefix="garmentbench-") if folder is None else folder
    return RunStore(Path(root)).open("fit", {"seed": seed})


def keep(method: Method, variant: str, origin: str, data: str, store: RunStore) -> Run:
    """The finished run of a method that was trained elsewhere, so that it can be evaluated as any other.

    Args:
        method: The trained method.
        variant: What to call it in tables, beside the method's name.
        origin: What it was trained on.
        data: Hash of the files that it was made from.
        store: Where the run goes.
    """
    identity = {
        "method": method.name,
        "class": _address(type(method)),
        "variant": variant,
        "train_scenes": [origin],
        "train_frames": None,
        "seed": 0,
        "data": data,
        "code": fingerprint(type(method).__module__),
    }
    with store.open("train", identity) as run:
        if not run.finished:
            folder = run.folder / "method"
            folder.mkdir(exist_ok=True)
            method.save(folder)
            run.finish()
    return store.get(run.id)


def evaluate(trained: Run, source: Source, preset: Preset, store: RunStore) -> Run:
    """Roll a trained method out on a source, ask it for single steps, and measure both.

    Returns:
        The finished run. Its folder holds rollout.h5 and recording.rrd; its results are `rows` (metric, horizon, value,
        unit ...), `status`, `first_bad_frame` and `message`. A method that fails or diverges has a finished run that
        says so.

    Raises:
        UserError: The training is not finished, or (`OtherGarmentError`) it was done on another garment.
    """
    from garmentbench.evaluation.excerpt import write_excerpt
    from garmentbench.evaluation.results import TRAINED_ON_IT
    from garmentbench.evaluation.rollout import OK
    from garmentbench.evaluation.score import score
    from garmentbench.viewing.recording import write_recording

    garment = trained.results.get("garment")  # says so where the training is not finished
    method = load_method(trained.identity["class"])
    reference = make_reference(source, preset)
    about = ("method", "class", "variant", "train_scenes", "train_frames", "seed")
    identity = {key: trained.identity[key] for key in about} | {
        "trained": trained.id,
        "scene": reference.name,
        "preset": preset.name,
        "data": sequence_file.content_hash(reference.path),
        "reference": reference.identity,  # whose own values stand beside the errors
        "code": fingerprint(method.__module__, *EVALUATION),
        "device": device_name(),
    }
    with store.open("evaluate", identity) as run:
        if not run.finished:
            quiet_warp()  # which the metrics use
            sequence = sequence_file.load(reference.path)
            if garment is not None and not _any_garment(method):
                _require_garment(trained, garment, reference.name, sequence)
            with _foreign_code(run, "load", method):
                learnt = method.load(trained.folder / "method")
            roll, one = _predict(learnt, sequence, run)
            roll.save(run.folder / "rollout.h5")
            write_excerpt(run.folder, sequence, roll)
            write_recording(run.folder / "recording.rrd", sequence, roll, f"{method.name} on {reference.name}")
            bad = one if roll.status == OK else roll
            ending = {"status": bad.status, "first_bad_frame": bad.first_bad_frame, "message": bad.message}
            rows = score(roll, one, sequence)
            if getattr(method, "learns", True) and _was_trained_on(trained, identity):
                rows = [row if row.unit == "ms" else row.noted(TRAINED_ON_IT) for row in rows]
            run.finish({"rows": [row.measured for row in rows], **ending})
    return _finished(run)


def evaluate_another_run(source: Source, preset: Preset, store: RunStore) -> Run | None:
    """Score the further runs of a reference as if they were predictions.

    Returns:
        The finished run, as that of `evaluate` but without a roll-out's file and recording; None where the reference is
        a single run.
    """
    from garmentbench.evaluation.another_run import ANOTHER_RUN, another_roll_out, another_run_rows, broken_at
    from garmentbench.evaluation.excerpt import write_excerpt
    from garmentbench.evaluation.rollout import DIVERGED, OK

    reference = make_reference(source, preset)
    if sequence_file.load(reference.path, frames=1).runs is None:
        return None
    identity = {
        "method": ANOTHER_RUN,
        "scene": reference.name,
        "preset": preset.name,
        "data": sequence_file.content_hash(reference.path),
        "reference": reference.identity,
        "code": fingerprint("garmentbench.evaluation.another_run", *EVALUATION),
    }
    with store.open(ANOTHER_RUN, identity) as run:
        if not run.finished:
            quiet_warp()
            sequence = sequence_file.load(reference.path)
            write_excerpt(run.folder, sequence, another_roll_out(sequence))
            bad = broken_at(sequence)
            message = "" if bad is None else f"a further run of the reference is not finite from frame {bad} on"
            ending = {"status": OK if bad is None else DIVERGED, "first_bad_frame": bad, "message": message}
            run.finish({"rows": [row.measured for row in another_run_rows(sequence)], **ending})
    return _finished(run)


def _finished(run: Run) -> Run:
    """A finished run to read from; it says whether it was there already."""
    found = run.store.get(run.id)
    found.reused = run.reused
    return found


def _predict(method: Method, sequence: "Recording", run: Run) -> tuple["RollOut", "RollOut"]:
    """A method's free roll-out through a sequence, and its single steps."""
    from garmentbench.evaluation.rollout import one_step, roll_out

    with run.track(len(sequence) - HISTORY, f"roll-out of {method.name}") as step:
        roll = roll_out(method, sequence, step)
    with run.track(len(sequence) - HISTORY, f"single steps of {method.name}") as step:
        return roll, one_step(method, sequence, step)


def _was_trained_on(trained: Run, tested: dict[str, Any]) -> bool:
    """Is what an evaluation's identity tests on among the training scenes, by name or by content?"""
    learnt = trained.identity
    return tested["scene"] in learnt["train_scenes"] or tested["data"] in list(learnt["data"])  # a text of `keep`'s


def _address(method: type[Method]) -> str:
    """How to load a class again: "module:Class"."""
    return f"{method.__module__}:{method.__qualname__}"


def _any_garment(method: type[Method]) -> bool:
    """Can it predict other garments than the one it was trained on?"""
    return getattr(method, "any_garment", not getattr(method, "learns", True))


def _first_frames(path: Path, frames: int) -> "Recording":
    sequence = sequence_file.load(path, frames)
    if len(sequence) < frames:
        found = len(sequence)
        raise UserError(f"{path}: has {found} frames, {frames} were asked for; train on at most {found}")
    return sequence


def garment_mesh(sequence: "Recording") -> dict[str, Any]:
    """Which garment mesh a sequence has: name, number of vertices, and a hash of the faces."""
    garment = sequence.template.garment
    return {
        "name": garment.name,
        "vertices": len(garment.rest),
        "faces": content_hash(garment.faces),
    }


def _require_garment(trained: Run, garment: dict[str, Any], scene: str, sequence: "Recording") -> None:
    """Raises `OtherGarmentError` where a method would have to predict another garment than it was trained on."""
    found = garment_mesh(sequence)
    if (found["vertices"], found["faces"]) != (garment["vertices"], garment["faces"]):
        raise OtherGarmentError(
            f"{trained.identity['method']} was trained on {', '.join(trained.identity['train_scenes'])} "
            f"({garment['name']}, {garment['vertices']} vertices), but {scene} has another garment "
            f"({found['name']}, {found['vertices']} vertices)"
        )


def _require_same_meshes(first: str, one: "Recording", second: str, other: "Recording") -> None:
    """Raises `UserError` where two training sequences have different garment or body meshes."""

    def body_mesh(sequence: "Recording") -> dict[str, Any]:
        body = sequence.template.body
        if body is None:
            return {"name": "none", "vertices": 0, "faces": ""}
        return {"name": body.kind, "vertices": len(body.rest), "faces": content_hash(body.faces)}

    for part, mesh, same in (
        ("garment", garment_mesh, ("vertices", "faces")),
        ("body", body_mesh, ("name", "vertices", "faces")),
    ):
        mine, theirs = mesh(one), mesh(other)
        if any(mine[key] != theirs[key] for key in same):
            raise UserError(
                f"train: the {part} of {first} ({mine['name']}, {mine['vertices']} vertices) is not that of {second} "
                f"({theirs['name']}, {theirs['vertices']} vertices); give training scenes that share the meshes"
            )


@contextmanager
def _foreign_code(run: Run, doing: str, method: type[Method]) -> Iterator[None]:
    """Make one line of whatever a method raises, and the run "failed"; the traceback stays in the run's folder."""
    try:
        yield
    except UserError as e:
        run.fail(str(e))
        raise
    except FOREIGN as e:  # a method may be anybody's, and raise anything
        file = run.folder / "error.txt"
        write_text(file, traceback.format_exc())
        line = f"{method.name}: {doing} raised {described(e, method)}"
        run.fail(line)
        raise UserError(f"{line}; the traceback is in {file}") from e
