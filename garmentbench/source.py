"""Where a sequence comes from: a scene, which is simulated, or a finished sequence file (imported, or anybody's).

Wherever a command takes a scene's name, the path of a sequence file (.h5) will do.
"""

from dataclasses import dataclass
from pathlib import Path

from garmentbench import sequence_file
from garmentbench.making import make_sequence, sequence_identity
from garmentbench.presets import Preset
from garmentbench.scene import load_scene


@dataclass(frozen=True)
class Source:
    """A sequence that is there.

    Attributes:
        name: The scene's name; of a finished file its stem.
        path: The sequence file.
        identity: Hash of all that decides it: of scene, assets and code, or of the finished file's contents.
    """

    name: str
    path: Path
    identity: str


def is_file(name: str) -> bool:
    """Does it name a sequence file rather than a scene?"""
    return name.endswith(".h5")


def check_source(name: str) -> None:
    """Raises `UserError` for an unknown scene, or a file that is no sequence; cheap."""
    if is_file(name):
        sequence_file.content_hash(Path(name))
    else:
        load_scene(name)


def take_source(name: str, preset: Preset) -> Source:
    """The sequence of that name, simulated first where it is a scene's and not there. Raises as `make_sequence`."""
    if is_file(name):
        path = Path(name)
        return Source(path.stem, path, sequence_file.content_hash(path))
    scene = load_scene(name)
    return Source(scene.name, make_sequence(name, preset), sequence_identity(scene, preset))
