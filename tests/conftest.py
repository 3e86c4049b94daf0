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


@pytest.fixture
def home(tmp_path, monkeypatch):
    """An empty home folder for runs, sequences and reports, which is the working folder too."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
