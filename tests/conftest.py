"""Tests run on one thread: on a small machine several threads of tiny operations wait for each other most of the time."""

import os

os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"))
