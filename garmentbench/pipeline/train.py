"""Training: a run whose folder holds the trained method."""

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from garmentbench import sequence_file
from garmentbench.device import device_name
from garmentbench.errors import UsageError, UserError
from garmentbench.method import HISTORY, Method
from garmentbench.pipeline.choice import MethodChoice
from garmentbench.pipeline.same_meshes import garment_mesh, require_same_meshes
from garmentbench.pipeline.shell import address, finished, foreign_code
from garmentbench.reference import Source, make_reference
from garmentbench.scenes.presets import Preset
from garmentbench.storage.fingerprint import fingerprint
from garmentbench.storage.runs import Run, RunStore

if TYPE_CHECKING:
    from garmentbench.sequence import Sequence as Recording


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
        "class": address(choice.method),
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
                require_same_meshes(identity["train_scenes"][0], sequences[0], name, sequence)
            folder = run.folder / "method"
            folder.mkdir(exist_ok=True)
            with foreign_code(run, "fit", choice.method):
                choice.method.fit(sequences, choice.config, run).save(folder)
            run.finish({"garment": garment_mesh(sequences[0]), "random": choice.random})
    return finished(run)


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
        "class": address(type(method)),
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


def _first_frames(path: Path, frames: int) -> "Recording":
    sequence = sequence_file.load(path, frames)
    if len(sequence) < frames:
        found = len(sequence)
        raise UserError(f"{path}: has {found} frames, {frames} were asked for; train on at most {found}")
    return sequence
