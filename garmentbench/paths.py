"""Where files lie: the benchmark's own data inside the package, everything that is made below the home folder.

The home folder is `--home DIR`, else the environment variable GARMENTBENCH_HOME, else the working folder. It is asked
for at every call, so that a notebook or a test may change it.
"""

import os
from pathlib import Path

HOME_VARIABLE = "GARMENTBENCH_HOME"  # worker processes inherit it
PACKAGE = Path(__file__).resolve().parent
DATASETS = PACKAGE / "datasets"
WARDROBE = DATASETS / "wardrobe.toml"
FABRICS = DATASETS / "fabrics.toml"
SCENES = DATASETS / "scenes"
BODIES = DATASETS / "bodies"
GARMENTS = DATASETS / "garments"


def home() -> Path:
    """The folder below which runs, sequences and reports go."""
    return Path(os.environ.get(HOME_VARIABLE) or Path.cwd())


def runs() -> Path:
    """The folder of all runs."""
    return home() / "runs"


def sequences() -> Path:
    """The folder of all simulated sequences."""
    return home() / "sequences"


def reports() -> Path:
    """The folder of all reports, one folder a preset in it."""
    return home() / "reports"


def own_bodies() -> Path:
    """The folder of the user's own bodies."""
    return home() / "bodies"


def own_wardrobe() -> Path:
    """The file of the user's own garments, bodies and motions."""
    return home() / "wardrobe.toml"


def own_scenes() -> Path:
    """The folder of the user's own scenes."""
    return home() / "scenes"


def sequence_path(mesh: str, scene: str) -> Path:
    """The simulated sequence of a scene at a mesh size."""
    return sequences() / mesh / f"{scene}.h5"
