"""The command that prints a sequence's data card."""

from dataclasses import dataclass
from pathlib import Path

from tyro.conf import Positional


@dataclass(frozen=True)
class Card:
    """Print the data card of a sequence: what it is, its cost, its spread, its known flaws, how to evaluate on it.

    Example: garmentbench card tshirt-armspace-90 --preset smoke --out card.md

    Attributes:
        source: A scene, which is simulated where it has not been, or a sequence file (.h5).
        out: Write the card into this Markdown file instead.
        preset: Size of a scene: smoke, laptop, desktop or paper.
        mesh: Another size of garment and body than the preset's.
    """

    source: Positional[str]
    out: Path | None = None
    preset: str = "laptop"
    mesh: str | None = None

    def run(self) -> None:
        from garmentbench.device import one_thread, quiet_warp
        from garmentbench.reference import make_reference, resolve_source
        from garmentbench.report.card import read_card
        from garmentbench.report.card_text import markdown
        from garmentbench.scenes.presets import preset
        from garmentbench.storage.atomic import write_text

        one_thread()
        quiet_warp()
        reference = make_reference(resolve_source(self.source), preset(self.preset, self.mesh))
        text = markdown(read_card(reference.path))
        if self.out is None:
            print(text, end="")
        else:
            write_text(self.out, text)
            print(self.out)
