"""The work behind the commands: train a method, roll it out and measure it. What is finished is reused.

Together with the command line this is the outermost shell: methods are reached from here, by their names.
"""

import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from garmentbench import sequence_file
from garmentbench.device import device_name, quiet_warp, require_device
from garmentbench.errors import UsageError, UserError, unknown_name
from garmentbench.method import HISTORY, Method
from garmentbench.reference import make_sequence, take_source
from garmentbench.scenes.presets import Preset
from garmentbench.sequence import Sequence
from garmentbench.storage.atomic import write_text
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.runs import Run, RunStore

if TYPE_CHECKING:
    from garmentbench.evaluation.rollout import RollOut

# What decides an evaluation besides the method: also the form in which the report finds it.
EVALUATION = ("garmentbench.evaluation.rollout", "garmentbench.evaluation.score", "garmentbench.evaluation.excerpt")

__all__ = ["evaluate", "is_random", "load_method", "make_sequence", "require_device", "train"]


def load_method(name: str) -> type[Method]:
    """The method of that name, or the class at "module:Class".

    Raises `UsageError`, with the nearest name for an unknown one, and for a class that is no method.
    """
    from garmentbench.evaluation.check_method import missing_parts
    from garmentbench.methods import load_method as load

    method = load(name)
    missing = missing_parts(method)
    if missing:
        raise UsageError(f"{name}: is no method: {missing[0]}")
    return method


def is_random(method_name: str) -> bool:
    """Does the seed change what a method learns? A method says so by its attribute `random` (true if not given)."""
    return getattr(load_method(method_name), "random", True)


def variants(method: type[Method]) -> dict[str, Any]:
    """A method's variants: functions that change the full configuration. Its module may offer more than "full"."""
    return getattr(sys.modules[method.__module__], "VARIANTS", {"full": lambda full: full})


def configuration(method: type[Method], variant: str, preset: Preset) -> Any:
    """The configuration of a variant at a preset. Raises `UsageError` for an unknown variant."""
    known = variants(method)
    if variant not in known:
        raise unknown_name(f"variant of {method.name}", variant, list(known))
    module = sys.modules[method.__module__]
    full = module.config_for(preset.name) if hasattr(module, "config_for") else method.Config()
    return known[variant](full)


def train(method_name: str, variant: str, scene: str, preset: Preset, frames: int, seed: int, store: RunStore) -> Run:
    """Train a method on the first `frames` of a scene (fewer where the preset limits them).

    Returns:
        The finished run; the trained method is in its folder "method".

    Raises:
        UserError: A wrong name, too few frames in the scene, or the method's `fit` raised.
    """
    method = load_method(method_name)
    config = configuration(method, variant, preset)
    if frames <= HISTORY:
        raise UsageError(
            f"train: {frames} frames asked for; wanted more than {HISTORY}, which are the history of the next"
        )
    frames = min(frames, preset.frame_limit or frames)
    source = take_source(scene, preset)
    identity = {
        "method": method_name,
        "variant": variant,
        "train_scene": source.name,
        "preset": preset.name,
        "train_frames": frames,
        "seed": seed if is_random(method_name) else 0,
        "config": config,
        "data": sequence_file.content_hash(source.path),
        "code": fingerprint(method.__module__),
        "device": device_name(),
    }
    with store.open("train", identity) as run:
        if not run.finished:
            sequence = sequence_file.load(source.path, frames)
            if len(sequence) < frames:
                there = len(sequence)
                raise UserError(f"{source.path}: has {there} frames, {frames} were asked for; train on at most {there}")
            folder = run.folder / "method"
            folder.mkdir(exist_ok=True)
            with _foreign_code(run, "fit"):
                method.fit(sequence, config, run).save(folder)
            run.finish()
    return store.get(run.id)


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
        "variant": variant,
        "train_scene": origin,
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


def evaluate(trained: Run, scene: str, preset: Preset, store: RunStore) -> Run:
    """Roll a trained method out on a scene, ask it for single steps, and measure both.

    Returns:
        The finished run. Its folder holds rollout.h5 and recording.rrd; its results are `rows` (metric, horizon, value,
        unit ...), `status` and `first_bad_frame`. A method that fails or diverges has a finished run that says so.

    Raises:
        UserError: The training is not finished, or the scene is wrong.
    """
    from garmentbench.evaluation.excerpt import write_material
    from garmentbench.evaluation.score import evaluate as measure
    from garmentbench.viewing.recording import write_recording

    _ = trained.results  # says so where the training is not finished
    method = load_method(trained.identity["method"])
    source = take_source(scene, preset)
    about = ("method", "variant", "train_scene", "train_frames", "seed")
    identity = {key: trained.identity[key] for key in about} | {
        "trained": trained.id,
        "scene": source.name,
        "preset": preset.name,
        "data": sequence_file.content_hash(source.path),
        "reference": source.identity,  # whose uncertainty stands beside the errors
        "code": fingerprint(method.__module__, *EVALUATION),
        "device": device_name(),
    }
    with store.open("evaluate", identity) as run:
        if not run.finished:
            quiet_warp()  # which the metrics use
            sequence = sequence_file.load(source.path)
            with _foreign_code(run, "load"):
                learnt = method.load(trained.folder / "method")
            roll, one = _predict(learnt, sequence, run)
            roll.save(run.folder / "rollout.h5")
            write_material(run.folder, sequence, roll)
            write_recording(
                run.folder / "recording.rrd", sequence, roll, f"{trained.identity['method']} on {source.name}"
            )
            run.finish(
                {
                    "rows": measure(roll, one, sequence),
                    "status": roll.status,
                    "first_bad_frame": roll.first_bad_frame,
                    "message": roll.message,
                }
            )
    return store.get(run.id)


def _predict(method: Method, sequence: Sequence, run: Run) -> tuple["RollOut", "RollOut"]:
    """A method's free roll-out through a sequence, and its single steps."""
    from garmentbench.evaluation.rollout import one_step, roll_out

    name = run.identity["method"]
    with run.track(len(sequence) - HISTORY, f"roll-out of {name}") as step:
        roll = roll_out(method, sequence, step)
    with run.track(len(sequence) - HISTORY, f"single steps of {name}") as step:
        return roll, one_step(method, sequence, step)


@contextmanager
def _foreign_code(run: Run, doing: str) -> Iterator[None]:
    """Make one line of whatever a method raises; its traceback stays in the run's folder."""
    try:
        yield
    except UserError:
        raise
    except Exception as e:  # a method may be anybody's, and raise anything
        file = run.folder / "error.txt"
        write_text(file, traceback.format_exc())
        name = run.identity["method"]
        raise UserError(f"{name}: {doing} raised {type(e).__name__}: {e}; the traceback is in {file}") from e
