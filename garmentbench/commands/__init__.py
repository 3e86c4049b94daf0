"""The commands, by the name that is typed: each a dataclass of its options with a `run` method.

What a command needs is imported when it runs, so that `garmentbench --help` is quick.
"""

from typing import Protocol

from garmentbench.commands.authors import ImportAuthors, ImportAuthorsModel
from garmentbench.commands.bench import Bench
from garmentbench.commands.bodies import Bodies
from garmentbench.commands.card import Card
from garmentbench.commands.check import Check
from garmentbench.commands.fabrics import Fabrics
from garmentbench.commands.meshes import Export, Import
from garmentbench.commands.methods import CheckMethod, Checkpoint, Evaluate, Methods, Train
from garmentbench.commands.motions import ImportMotion
from garmentbench.commands.results import Evals, Report, Runs, View
from garmentbench.commands.scenes import Scenes
from garmentbench.commands.sequences import Simulate


class Command(Protocol):
    """A dataclass of options."""

    def run(self) -> None:
        """Do it. Raises `UserError` for what the user can mend."""


COMMANDS: dict[str, type[Command]] = {
    "scenes": Scenes,
    "bodies": Bodies,
    "fabrics": Fabrics,
    "methods": Methods,
    "simulate": Simulate,
    "import": Import,
    "import-motion": ImportMotion,
    "import-authors": ImportAuthors,
    "import-authors-model": ImportAuthorsModel,
    "export": Export,
    "check": Check,
    "card": Card,
    "check-method": CheckMethod,
    "train": Train,
    "evaluate": Evaluate,
    "checkpoint": Checkpoint,
    "evals": Evals,
    "bench": Bench,
    "runs": Runs,
    "report": Report,
    "view": View,
}
