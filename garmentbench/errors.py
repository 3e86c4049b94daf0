"""The errors that a user can cause and mend. Each message is one line: what was found, what was wanted, what to do."""

import difflib
import importlib.util
import os
import sys
import traceback
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path


class UserError(Exception):
    """Something outside this program is wrong (a file, a mesh, a disk).

    The command line prints the line and exits 1.
    """

    exit_code = 1


class UsageError(UserError):
    """The call itself is wrong (an unknown name or option). The command line prints the line and exits 2."""

    exit_code = 2


FOREIGN = (Exception, SystemExit)  # what foreign code may raise: its sys.exit is no success of ours

NEAR = 0.6  # how alike two names are (`difflib`'s ratio) of which one may be meant by the other, at least
_NAMED = 5  # names in a message with a near one, at most
_ALL_NAMED = 20  # in a message without
_LISTS = {  # commands that list all names of a kind
    "command": "garmentbench --help",
    "scene": "garmentbench scenes",
    "method": "garmentbench methods",
    "body": "garmentbench bodies",
    "fabric": "garmentbench fabrics",
}


def unknown_name(kind: str, name: str, known: Iterable[str], where: str = "") -> UsageError:
    """A `UsageError` for an unknown `name`: with the nearest known ones, or where none is near, with how to list them.

    `where` is what the line begins with: the file that the name stands in, and a colon.

    >>> print(unknown_name("scene", "tshirt-armspce-90", ["sheet-stick-a", "tshirt-armspace-90"]))
    unknown scene 'tshirt-armspce-90': did you mean 'tshirt-armspace-90'? Known: tshirt-armspace-90, sheet-stick-a
    >>> print(unknown_name("scene", "nonsense", ["sheet-stick-a", "tshirt-still"]))
    unknown scene 'nonsense'; `garmentbench scenes` lists all
    """
    known = sorted({*known} - {name})  # nothing is suggested for itself
    near = difflib.get_close_matches(name, known, n=_NAMED, cutoff=NEAR)
    if not near and kind in _LISTS:
        return UsageError(f"{where}unknown {kind} '{name}'; `{_LISTS[kind]}` lists all")
    named = list(dict.fromkeys([*near, *known]))[: _NAMED if near else _ALL_NAMED]
    hint = f"did you mean '{near[0]}'? " if near else ""
    more = f" and {len(known) - len(named)} more" if len(known) > len(named) else ""
    return UsageError(f"{where}unknown {kind} '{name}': {hint}Known: {', '.join(named) or 'none'}{more}")


def described(error: BaseException, raised_by: type) -> str:
    """What foreign code raised, in one line with its place, e.g. "ValueError: no data (my_method.py:12)".

    The place is the innermost line in the package of the class `raised_by` (in its folder, where it is a lone module),
    so that an error from within a library is found where the author called it.
    """
    message = " ".join(f"{type(error).__name__}: {error}".split())
    place = _place(error, raised_by.__module__)
    return f"{message} ({place})" if place else message


def described_import(error: BaseException, module: str) -> str:
    """Why a module can't be imported, in one line that begins with the place, e.g. "mine.py:1: SyntaxError: invalid
    syntax"."""
    message = " ".join(f"{type(error).__name__}: {getattr(error, 'msg', None) or error}".split())
    if isinstance(error, SyntaxError) and error.filename:
        return f"{_shown(error.filename)}:{error.lineno or 1}: {message}"
    place = _place(error, module)
    return f"{place}: {message}" if place else message


def _place(error: BaseException, module: str) -> str:
    """File and line of the innermost frame that lies with a module; of the innermost of all where none does."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if _lies_with(Path(frame.filename), module)]
    return "".join(f"{_shown(frame.filename)}:{frame.lineno}" for frame in (own or frames)[-1:])


def _shown(file: str) -> str:
    return os.path.relpath(file) if Path(file).is_relative_to(Path.cwd()) else file


def _lies_with(file: Path, module: str) -> bool:
    """Is a file part of a module's package? Of ours, each method is a package by itself."""
    top = module.rpartition(".")[0] if module.startswith("garmentbench.") else module.partition(".")[0]
    if top in sys.modules:
        origin = getattr(sys.modules[top], "__file__", None)
    else:  # its import has failed
        origin = getattr(importlib.util.find_spec(top), "origin", None)
    if origin is None:
        return False
    folder = Path(origin).parent
    return folder in file.parents if Path(origin).name == "__init__.py" else file.parent == folder


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong.

    Attributes:
        where: The place, e.g. "garment/frames".
        what: What was found, and what was wanted.
        do: What to do about it.
        warning: It can be used all the same.
    """

    where: str
    what: str
    do: str
    warning: bool = False

    def __str__(self) -> str:
        return f"{self.where}: {self.what}; {self.do}"


class ProblemError(UserError):
    """A problem that ends the call."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(str(problem))
        self.problem = problem


def errors(problems: list[Problem]) -> list[Problem]:
    """Those that forbid use."""
    return [p for p in problems if not p.warning]
