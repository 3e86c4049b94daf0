"""Tests run on one thread, and check the shapes of arrays against the signatures.

On a small machine threads of tiny operations wait for each other most of the time.
"""

import os
import signal

import pytest
from jaxtyping import install_import_hook
from shape_checks import checked_modules

from garmentbench.paths import HOME_VARIABLE

os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"))
os.environ.pop(HOME_VARIABLE, None)  # no test writes where the user keeps results

install_import_hook(checked_modules(), "shape_checks.checked")

# A shell ignores Ctrl-C in what it starts in the background, and processes inherit that: tests of Ctrl-C would fail.
signal.signal(signal.SIGINT, signal.default_int_handler)

# Files of few, long tests. They come first: begun last, each would keep one worker busy while the others have nothing.
LONGEST = (
    "test_own_garment_doc.py",
    "test_own_garment.py",
    "test_own.py",
    "test_own_motion_doc.py",
    "test_install.py",
    "test_ensemble.py",
    "test_cli.py",
    "test_api.py",
    "test_convergence.py",
    "test_crosscheck.py",
)


def pytest_collection_modifyitems(items):
    rank = {name: k for k, name in enumerate(LONGEST)}
    items.sort(key=lambda item: rank.get(item.path.name, len(rank)))


@pytest.fixture
def home(tmp_path, monkeypatch):
    """An empty home folder for runs, sequences and reports, which is the working folder too."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
