"""The errors that a user can cause and mend. Each message is one line: what was found, what was wanted, what to do."""

import difflib
from dataclasses import dataclass


class UserError(Exception):
    """Something outside this program is wrong (a file, a mesh, a disk). The command line prints the line and exits 1."""

    exit_code = 1


class UsageError(UserError):
    """The call itself is wrong (an unknown name or option). The command line prints the line and exits 2."""

    exit_code = 2


def unknown_name(kind: str, name: str, known: list[str]) -> UsageError:
    """A `UsageError` for an unknown `name`, with the nearest known one.

    >>> print(unknown_name("scene", "tshirt-armspce-90", ["tshirt-armspace-90"]))
    unknown scene 'tshirt-armspce-90': did you mean 'tshirt-armspace-90'? Known: tshirt-armspace-90
    """
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.4)
    hint = f"did you mean '{near[0]}'? " if near else ""
    return UsageError(f"unknown {kind} '{name}': {hint}Known: {', '.join(sorted(known)) or 'none'}")


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
