"""Does a method keep the contract of `garmentbench.method`? Tried on tiny scenes made by formulas, told to its author."""

from dataclasses import is_dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from garmentbench.errors import Problem, UserError
from garmentbench.evaluation.rollout import DIVERGED, FAILED, RollOut, roll_out
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.method import HISTORY, BodyFrame, History, Method
from garmentbench.sequence import HUMAN, OBJECT, Sequence
from garmentbench.storage.runs import RunStore

FRAMES = 20
PARTS = ("fit", "save", "load", "begin", "step")


def check_method(method: type[Method], config: Any) -> list[Problem]:
    """Everything in which a method breaks the contract, as far as a tiny scene with a human body and one with an object
    show it. A method may refuse a scene by a `UserError`, but not the one with the human body.

    Args:
        method: The class.
        config: A configuration, the smaller the better.
    """
    return missing_parts(method) or _try_scene(method, config, HUMAN) or _try_scene(method, config, OBJECT)


def missing_parts(method: type) -> list[Problem]:
    """What a class lacks to be a method at all."""
    problems = []
    if not isinstance(getattr(method, "name", None), str):
        problems.append(
            Problem("name", "is missing or no text", "give the class an attribute `name`, as in the tables")
        )
    if not is_dataclass(getattr(method, "Config", None)):
        problems.append(
            Problem("Config", "is missing or no dataclass", "give the class an attribute `Config`, a frozen dataclass")
        )
    for part in PARTS:
        if not callable(getattr(method, part, None)):
            problems.append(Problem(part, "is missing", f"write the method `{part}` (see garmentbench.method.Method)"))
    return problems


def _try_scene(method: type[Method], config: Any, kind: str) -> list[Problem]:
    """Fit, save, load and roll out on a tiny scene; the first part that goes wrong ends it."""
    train, test = tiny_sequence(FRAMES, kind), tiny_sequence(FRAMES, kind, phase=1.0)
    with TemporaryDirectory() as name, RunStore(Path(name)).open("check", {"seed": 0}) as run:
        folder = run.folder / "method"
        folder.mkdir()
        part = "fit"
        try:
            trained = method.fit((train,), config, run)
            part = "save"
            trained.save(folder)
            part = "load"
            loaded = method.load(folder)
        except UserError as e:
            return [Problem(part, f"refuses a scene with a human body: {e}", "accept it")] if kind == HUMAN else []
        except Exception as e:  # a method may raise anything
            return [
                Problem(
                    part,
                    f"raised {type(e).__name__}: {e}",
                    "mend it; garmentbench.evaluation.toy.tiny_sequence is the scene",
                )
            ]
        return _try_roll_out(trained, loaded, test, f"scene with {kind}")


def _try_roll_out(trained: Method, loaded: Method, test: Sequence, where: str) -> list[Problem]:
    first = roll_out(trained, test)
    if first.status == FAILED or (first.status == DIVERGED and "not finite" in first.message):
        what = f"frame {first.first_bad_frame} {first.status}: {first.message}"
        return [Problem(f"step, {where}", what, f"return finite floats of shape {test.garment.shape[1:]}")]
    if not _same(first, roll_out(trained, test)):
        do = "keep what changes in the state that begin and step pass on, and seed what is random"
        return [Problem(f"step, {where}", "the same roll-out, twice, gives different garments", do)]
    problems = _try_read_only(trained, test, where)
    if not np.array_equal(_in_turns(trained, test), first.garment[HISTORY:], equal_nan=True):
        do = "keep what changes in the state, not in self"
        problems.append(Problem(f"step, {where}", "two roll-outs in turns disturb each other", do))
    if not _same(first, roll_out(loaded, test)):
        problems.append(
            Problem(f"load, {where}", "the method read back predicts something else", "save all that step uses")
        )
    return problems


def _same(one: RollOut, other: RollOut) -> bool:
    return np.array_equal(one.garment, other.garment, equal_nan=True)


def _in_turns(method: Method, test: Sequence) -> np.ndarray:
    """A roll-out with another one, of a garment that has moved, step by step beside it [m], shape (T - 3, V, 3)."""
    history = History.before(test, HISTORY)
    states = [method.begin(test.template, History(history.garments + d, history.bodies)) for d in (0, np.float32(0.01))]
    frames = []
    for t in range(HISTORY, len(test)):
        outputs, states = zip(*(method.step(state, BodyFrame(test.body[t])) for state in states), strict=True)
        frames.append(np.asarray(outputs[0], np.float32))
    return np.array(frames)


def _try_read_only(method: Method, test: Sequence, where: str) -> list[Problem]:
    """Does a method leave alone what it is given?"""
    garments, bodies = test.garment[:HISTORY].copy(), test.body[: HISTORY + 1].copy()
    before = garments.copy(), bodies.copy()
    state = method.begin(test.template, History(garments, bodies[:HISTORY]))
    method.step(state, BodyFrame(bodies[HISTORY]))
    if np.array_equal(garments, before[0]) and np.array_equal(bodies, before[1]):
        return []
    return [Problem(f"step, {where}", "writes into the history or the body that it is given", "work on a copy")]
