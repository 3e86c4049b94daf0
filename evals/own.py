"""Experiments of the user's own: a TOML or Python file that says what is trained and tested on what.

In TOML, names as in the commands (scenes may be files beside it, methods "module:Class" beside it):

    train = ["tshirt-armspace-75"]
    test = ["tshirt-armspace-90", "tshirt-catwalk"]
    seeds = 3
    entries = ["skinning", "my_gru:PoseGRU", { method = "motion_guided", variant = "full", train_frames = 150 }]

In Python `EXPERIMENTS`, a sequence of `Experiment`, most often of `Comparison`.
"""

import importlib
import sys
import traceback
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Annotated

import msgspec

from garmentbench.errors import FOREIGN, UsageError, UserError
from garmentbench.evals import EXPERIMENTS
from garmentbench.evals.comparison import Comparison
from garmentbench.evals.experiment import Experiment
from garmentbench.evals.trial import TRAIN_FRAMES, Entry
from garmentbench.storage.typed_toml import read_toml, typed

ENDINGS = (".toml", ".py")
Names = Annotated[list[str], msgspec.Meta(min_length=1)]


@dataclass(frozen=True)
class _Entry:
    method: str
    variant: str = "full"
    train_frames: Annotated[int, msgspec.Meta(gt=3)] = TRAIN_FRAMES


@dataclass(frozen=True)
class _File:
    train: Names
    test: Names
    entries: Annotated[list[str | _Entry], msgspec.Meta(min_length=1)]
    seeds: Annotated[int, msgspec.Meta(ge=1)] = 1
    title: str = ""


def is_file(name: str) -> bool:
    """Does it name a file of experiments rather than an experiment?"""
    return name.endswith(ENDINGS)


def read_experiments(path: Path) -> list[Experiment]:
    """The experiments of a file, whose folder is from now on among those that Python imports from.

    Raises `UsageError` with one line that says what is wrong with the file and where.
    """
    if not path.is_file():
        raise UsageError(f"{path}: no such file; wanted an experiment's name, or a file that declares one")
    folder = str(path.resolve().parent)
    if folder not in sys.path:  # worker processes inherit it
        sys.path.insert(0, folder)
    experiments = _from_toml(path) if path.suffix == ".toml" else _from_python(path)
    taken = {name for e in EXPERIMENTS.values() for name in (e.name, e.table)}
    for experiment in experiments:
        for name in (experiment.name, experiment.table):
            if name in taken:
                raise UsageError(f"{path}: '{name}' is an experiment of the suite's own; give yours another name")
    return experiments


def _from_toml(path: Path) -> list[Experiment]:
    try:
        read = typed(read_toml(path), _File, path)
    except UserError as e:
        raise UsageError(f"{e}; `garmentbench evals --help` has an example") from e
    entries = [Entry(e) if isinstance(e, str) else Entry(e.method, e.variant, e.train_frames) for e in read.entries]
    name = path.stem.replace("-", "_")
    return [
        Comparison(
            name=name,
            table=name,
            title=read.title or name.replace("_", " ").capitalize(),
            seeds=read.seeds,
            train=tuple(_beside(path, scene) for scene in read.train),
            tests=tuple(_beside(path, scene) for scene in read.test),
            entries=tuple(entries),
        )
    ]


def _beside(path: Path, scene: str) -> str:
    """A scene's name, or its file's path, which is relative to the experiment's."""
    return str(path.parent / scene) if scene.endswith((".toml", ".h5")) else scene


def _from_python(path: Path) -> list[Experiment]:
    experiments = getattr(_imported(path), "EXPERIMENTS", None)
    if not isinstance(experiments, tuple | list) or not experiments:
        raise UsageError(f"{path}: has no EXPERIMENTS; wanted EXPERIMENTS = (Comparison(name=..., ...),)")
    for experiment in experiments:
        if not isinstance(experiment, Experiment):
            raise UsageError(
                f"{path}: {experiment!r} in EXPERIMENTS is no Experiment; wanted Comparison(name=..., ...)"
            )
    return list(experiments)


def _imported(path: Path) -> ModuleType:
    """The file as a module, so that worker processes find the classes that it defines."""
    try:
        module = importlib.import_module(path.stem)
    except FOREIGN as e:  # the user's own code may raise anything
        within = [f.lineno for f in traceback.extract_tb(e.__traceback__) if Path(f.filename) == path.resolve()]
        place = [*within, getattr(e, "lineno", None) or 1][0]
        raise UsageError(f"{path}:{place}: raised {type(e).__name__}: {' '.join(str(e).split())}") from e
    if Path(getattr(module, "__file__", None) or "").resolve() != path.resolve():
        raise UsageError(f"{path}: another module is called '{path.stem}'; give the file another name")
    return module
