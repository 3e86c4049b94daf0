"""Where things lie. Assets and scenes lie beside the package; runs, sequences and reports in the working folder."""

from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SCENES = ROOT / "datasets" / "scenes"
BODIES = ROOT / "datasets" / "bodies"
GARMENTS = ROOT / "datasets" / "garments"
GENERATED = ROOT / "datasets" / "generated"
RUNS = ROOT / "runs"
REPORTS = ROOT / "reports"


def sequence_path(preset: str, scene: str) -> Path:
    """The generated sequence of a scene at a preset."""
    return GENERATED / preset / f"{scene}.h5"
