"""Evaluating: a trained method is rolled out on a source, and what it does is measured."""

from typing import TYPE_CHECKING, Any

from garmentbench import sequence_file
from garmentbench.device import device_name, quiet_warp
from garmentbench.method import HISTORY, Method
from garmentbench.pipeline.choice import load_method
from garmentbench.pipeline.same_meshes import require_garment
from garmentbench.pipeline.shell import finished, foreign_code
from garmentbench.reference import Source, make_reference
from garmentbench.scenes.presets import Preset
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.runs import Run, RunStore

if TYPE_CHECKING:
    from garmentbench.evaluation.rollout import RollOut
    from garmentbench.sequence import Sequence as Recording

# What decides an evaluation besides the method: also the form in which the report finds it.
EVALUATION = tuple(f"garmentbench.evaluation.{part}" for part in ("rollout", "broken", "score", "excerpt"))


def evaluate(trained: Run, source: Source, preset: Preset, store: RunStore) -> Run:
    """Roll a trained method out on a source, ask it for single steps, and measure both.

    Returns:
        The finished run. Its folder holds rollout.h5 and recording.rrd; its results are `rows` (metric, horizon, value,
        unit ...), `status`, `first_bad_frame` and `message`. A method that breaks, diverges or fails has a finished run
        that says so.

    Raises:
        UserError: The training is not finished, or (`OtherGarmentError`) it was done on another garment.
    """
    from garmentbench.evaluation.broken import judged
    from garmentbench.evaluation.excerpt import write_excerpt
    from garmentbench.evaluation.results import TRAINED_ON_IT
    from garmentbench.evaluation.rollout import OK
    from garmentbench.evaluation.score import predicted, score
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
            if garment is not None and not any_garment(method):
                require_garment(trained, garment, reference.name, sequence)
            with foreign_code(run, "load", method):
                learnt = method.load(trained.folder / "method")
            roll, one = _predict(learnt, sequence, run)
            motion = predicted(roll, sequence)
            roll = judged(roll, motion)
            roll.save(run.folder / "rollout.h5")
            write_excerpt(run.folder, sequence, roll)
            write_recording(run.folder / "recording.rrd", sequence, roll, f"{method.name} on {reference.name}")
            bad = one if roll.status == OK else roll
            ending = {"status": bad.status, "first_bad_frame": bad.first_bad_frame, "message": bad.message}
            rows = score(roll, one, sequence, motion=motion)
            if getattr(method, "learns", True) and _was_trained_on(trained, identity):
                rows = [row if row.unit == "ms" else row.noted(TRAINED_ON_IT) for row in rows]
            run.finish({"rows": [row.measured for row in rows], **ending})
    return finished(run)


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
    return finished(run)


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


def any_garment(method: type[Method]) -> bool:
    """Can it predict other garments than the one it was trained on?"""
    return getattr(method, "any_garment", not getattr(method, "learns", True))
