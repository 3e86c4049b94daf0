"""The core knows no reader of other people's files.

What they read comes in as sequences, garments and clips of ours.
"""

from pathlib import Path

import garmentbench

PACKAGE = Path(garmentbench.__file__).parent
MAY = (
    "importing",
    "commands",
)  # beside the core, and above it; of the methods, the readers of their authors' files may


def test_core_never_imports_importing():
    core = [p for p in PACKAGE.rglob("*.py") if p.relative_to(PACKAGE).parts[0] not in MAY]
    methods = [p for p in (PACKAGE.parent / "methods").rglob("*.py") if "authors" not in p.parts]
    assert len(core) > 100 and len(methods) > 20
    assert [p.name for p in core + methods if "garmentbench.importing" in p.read_text()] == []
