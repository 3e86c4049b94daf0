"""What an experiment is: a training scene, test scenes, and the methods that are put through them."""

from dataclasses import dataclass

TRAIN_FRAMES = 300  # the paper's training length, section 6.1


@dataclass(frozen=True)
class Entry:
    """One line of a table.

    Attributes:
        method: Name in `methods.METHODS`.
        variant: "full", or one of the method's `VARIANTS`.
        train_frames: It is trained on so many first frames of the training scene.
    """

    method: str
    variant: str = "full"
    train_frames: int = TRAIN_FRAMES

    @property
    def label(self) -> str:
        """The variant's name in results.csv: a departure from the paper's training length is a variant too."""
        return self.variant if self.train_frames == TRAIN_FRAMES else f"train_{self.train_frames}"


@dataclass(frozen=True)
class Experiment:
    """Entries trained on one scene and tested on others. `table` is its name in results.csv.

    Several experiments may share a table's name and lines; a line is computed once.
    `simulator` adds the reference simulation's own line (method "reference") for every test scene, `needs` the rows that
    say what was left out for the training scene and what that saves.
    """

    name: str
    table: str
    train: str
    tests: tuple[str, ...]
    entries: tuple[Entry, ...]
    simulator: bool = False
    needs: bool = False


FULL = Entry("motion_guided")
SIMPLE = tuple(Entry(m) for m in ("skinning", "hold", "constant_velocity", "linear_subspace"))
