"""The commands, by the name that is typed: each a dataclass of its options with a `run` method.

What a command needs is imported when it runs, so that `garmentbench --help` is quick.
"""

from typing import Protocol

from garmentbench.commands.data import Check, Scenes, Simulate
from garmentbench.commands.learn import CheckMethod, Evaluate, Methods, Train
from garmentbench.commands.results import Evals, Report, Runs, View


class Command(Protocol):
    """A dataclass of options."""

    def run(self) -> None:
        """Do it. Raises `UserError` for what the user can mend."""


COMMANDS: dict[str, type[Command]] = {
    "scenes": Scenes,
    "methods": Methods,
    "simulate": Simulate,
    "check": Check,
    "check-method": CheckMethod,
    "train": Train,
    "evaluate": Evaluate,
    "evals": Evals,
    "runs": Runs,
    "report": Report,
    "view": View,
}
