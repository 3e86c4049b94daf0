"""Tests run on one thread: on a small machine several threads of tiny operations wait for each other most of the time."""

import os
import signal

os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"))

# A shell ignores Ctrl-C in what it starts in the background, and processes inherit that: the tests of Ctrl-C would fail there.
signal.signal(signal.SIGINT, signal.default_int_handler)
