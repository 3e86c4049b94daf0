"""What a result was made on: processor, memory, system, package versions, and how much memory the process took."""

import os
import platform
import resource
import subprocess
import sys
from contextlib import suppress
from importlib import metadata
from pathlib import Path

import psutil

import garmentbench
from garmentbench.paths import PACKAGE

PACKAGES = ("torch", "numpy", "scipy", "warp-lang", "h5py", "rerun-sdk")


def machine() -> dict:
    """The machine: processor, cores this process may use, memory [GB], system, CUDA device where torch is using one."""
    torch = sys.modules.get("torch")
    cuda = torch.cuda.get_device_name() if torch is not None and torch.cuda.is_initialized() else None
    return {
        "cpu": _cpu(),
        "cores": core_count(),
        "memory_gb": round(psutil.virtual_memory().total / 2**30, 1),
        "system": f"{platform.system()} {platform.release()}",
        "threads": torch.get_num_threads() if torch is not None else None,
        "cuda": cuda,
    }


def core_count() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _cpu() -> str:
    """The processor's name; Linux tells it only here."""
    info = Path("/proc/cpuinfo")
    names = (
        [line.split(":", 1)[1].strip() for line in info.read_text().splitlines() if line.startswith("model name")]
        if info.is_file()
        else []
    )
    return names[0] if names else platform.processor() or platform.machine()


def packages() -> dict[str, str]:
    """Versions of Python and of the packages that numbers depend on."""
    return {"python": platform.python_version()} | {name: metadata.version(name) for name in PACKAGES}


def code_version() -> str:
    """garmentbench's version, with the commit where it runs from a checkout ("0.1.0+d359df5", "-dirty" if edited)."""
    checkout = PACKAGE.parent
    if not (checkout / ".git").exists():  # installed, perhaps below somebody else's repository
        return garmentbench.__version__
    # Without locks: a `describe --dirty` that is killed at the time limit would leave one, and nobody could commit.
    git = ["git", "--no-optional-locks", "-C", str(checkout), "describe", "--always", "--dirty", "--exclude=*"]
    try:
        commit = subprocess.run(git, capture_output=True, text=True, check=True, timeout=10).stdout.strip()
    except (OSError, subprocess.SubprocessError):  # no git
        return garmentbench.__version__
    return f"{garmentbench.__version__}+{commit}"


def forget_peak_memory() -> None:
    """Let the peak begin anew, where the system can: a worker process does many runs, one after the other."""
    reset = Path("/proc/self/clear_refs")
    if reset.is_file():
        with suppress(PermissionError):  # some containers forbid it; the peak is then the whole process's
            reset.write_text("5")
    torch = sys.modules.get("torch")
    if torch is not None and torch.cuda.is_initialized():
        torch.cuda.reset_peak_memory_stats()


def peak_memory_mb() -> dict[str, float]:
    """The most memory this process has held [MB], and that torch has held on a CUDA device where it uses one."""
    status = Path("/proc/self/status")
    if status.is_file():  # getrusage counts the parent's memory in a process that was just started
        line = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        peak = {"process": round(int(line.split()[1]) / 1024, 1)}
    else:
        unit = 2**20 if sys.platform == "darwin" else 2**10
        peak = {"process": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit, 1)}
    torch = sys.modules.get("torch")
    if torch is not None and torch.cuda.is_initialized():
        peak["cuda"] = round(torch.cuda.max_memory_allocated() / 2**20, 1)
    return peak
