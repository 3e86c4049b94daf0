"""The command that prints a sequence's data card."""

from dataclasses import dataclass
from pathlib import Path

from tyro.conf import Positional


@dataclass(frozen=True)
class Card:
    """Print the data card of a sequence: what it is, its cost, its uncertainty, its known flaws, how to evaluate on it.

    Example: garmentbench card sequences/laptop/tshirt-armspace-90.h5 --out card.md

    Attributes:
        file: The HDF5 file.
        out: Write the card into this Markdown file instead.
    """

    file: Positional[Path]
    out: Path | None = None

    def run(self) -> None:
        from garmentbench.device import quiet_warp
        from garmentbench.report.card import read_card
        from garmentbench.report.card_text import markdown
        from garmentbench.storage.atomic import write_text

        quiet_warp()
        text = markdown(read_card(self.file))
        if self.out is None:
            print(text, end="")
        else:
            write_text(self.out, text)
            print(self.out)
