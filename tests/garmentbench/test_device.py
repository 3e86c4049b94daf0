"""The device, and what Warp says of it."""

import os
import subprocess
import sys

from garmentbench.paths import PACKAGE


def test_warp_says_nothing_of_its_own_but_other_messages_pass():
    code = """
import os
from garmentbench.device import _native_stderr, quiet_warp
quiet_warp()
import warp
warp.zeros(3, device="cpu")
with _native_stderr() as lines:
    os.write(2, b"from C code\\n")
os.write(2, lines[0].encode())
"""
    env = os.environ | {"PYTHONPATH": str(PACKAGE.parent), "CUDA_VISIBLE_DEVICES": ""}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=env, check=True)
    assert (done.stdout, done.stderr) == ("", "from C code")
