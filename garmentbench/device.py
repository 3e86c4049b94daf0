"""Which device is used: the processor, or a CUDA device."""

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING

from garmentbench.errors import UserError, unknown_name

if TYPE_CHECKING:
    from garmentbench.scenes.presets import Preset

DEVICES = ("auto", "cpu", "cuda")


def choose_device(name: str) -> None:
    """Settle the device of this process and those it starts, before torch or Warp is loaded.

    "auto" is CUDA where there is a device. Raises `UsageError` for another name, `UserError` where "cuda" is not there.
    """
    if name not in DEVICES:
        raise unknown_name("device", name, list(DEVICES))
    if name == "cpu":
        os.environ["CUDA_VISIBLE_DEVICES"] = ""  # torch and Warp both ask the driver, which obeys this
    if name == "cuda" and not has_cuda():
        raise UserError("--device cuda: this machine offers no CUDA device to torch; use --device cpu or auto")


def require_device(preset: "Preset") -> None:
    """Raises `UserError` where a preset needs a CUDA device and there is none."""
    if preset.needs_cuda and not has_cuda():
        raise UserError(f"preset {preset.name} needs a CUDA device and none is there; --preset laptop needs none")


@cache
def quiet_warp() -> None:
    """Start Warp without the messages that would mix with a command's output: which kernels it loads, and that there is
    no CUDA driver. To be called before its first use."""
    import warp

    warp.config.log_level = warp.LOG_WARNING
    with _native_stderr() as lines:  # the library itself writes there, whatever the level
        warp.init()
    for line in lines:
        if "Could not find or load the NVIDIA CUDA driver" not in line:
            print(line, file=sys.stderr)


@contextmanager
def _native_stderr() -> Iterator[list[str]]:
    """Keep what C code writes to standard error inside the block; the lines are there after it."""
    lines: list[str] = []
    before = os.dup(2)
    try:
        with tempfile.TemporaryFile() as file:
            os.dup2(file.fileno(), 2)
            try:
                yield lines
            finally:
                os.dup2(before, 2)
                file.seek(0)
                lines += file.read().decode(errors="replace").splitlines()
    finally:
        os.close(before)


def one_thread() -> None:
    """Let NumPy and torch use one thread in this process and those it starts: a result is then the same bits whether
    it is made alone or beside others, and a time is that of one core. To be called before they are loaded."""
    os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"))


def has_cuda() -> bool:
    """May this process use a CUDA device?"""
    import torch

    return torch.cuda.is_available()


def device_name() -> str:
    """ "cuda" where a CUDA device may be used, else "cpu"."""
    return "cuda" if has_cuda() else "cpu"
