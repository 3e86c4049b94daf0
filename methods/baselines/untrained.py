"""What the baselines that learn nothing have in common: one setting to keep."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import ClassVar, Self

from garmentbench.geometry.blend_skinning import SkinOf
from garmentbench.method import FitRun
from garmentbench.sequence import Sequence


@dataclass(frozen=True)
class Config:
    """seeds: The largest number of seed points that carry the garment."""

    seeds: int = 300


class Untrained:
    """A method without anything to train, to be given `begin` and `step`."""

    name: ClassVar[str]
    random = False
    learns = False
    Config = Config

    def __init__(self, config: Config) -> None:
        self.config = config
        self.skin_of = SkinOf(config.seeds, upright_objects=True)

    @classmethod
    def fit(cls, train: tuple[Sequence, ...], config: Config, run: FitRun) -> Self:
        """Nothing is learnt."""
        return cls(config)

    def save(self, folder: Path) -> None:
        """Write the configuration."""
        (folder / "config.json").write_text(json.dumps(asdict(self.config)))

    @classmethod
    def load(cls, folder: Path) -> Self:
        """Read it back."""
        return cls(Config(**json.loads((folder / "config.json").read_text())))
