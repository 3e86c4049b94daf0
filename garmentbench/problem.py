"""Something wrong with a file, a mesh or a method, said so that its owner can mend it."""

from dataclasses import dataclass

from garmentbench.errors import UserError


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
