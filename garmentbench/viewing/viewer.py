"""Opening a recording, and telling whether it is whole."""

import os
import socket
import subprocess
import sys
import warnings
from contextlib import suppress
from pathlib import Path

import rerun_cli
from rerun.chunk import RrdReader

from garmentbench.errors import UserError


def whole(path: Path) -> bool:
    """Whether a file is a recording with all that was written, by the table of contents at its end."""
    try:
        with warnings.catch_warnings(action="ignore"):  # "no footer": said by the answer
            RrdReader(path).store()
    except (RuntimeError, ValueError):
        return False
    return True


def check_recording(path: Path) -> None:
    """Raise `UserError` if a recording is missing, cut short or no recording."""
    if not path.is_file():
        raise UserError(f"{path}: no such recording; evaluate again, a finished evaluation has one")
    if not whole(path):
        raise UserError(f"{path}: cut short, or not a recording; delete its run's folder and evaluate again")


def open_viewer(path: Path) -> None:
    """Open a recording in Rerun's viewer, which outlives this process.

    Raises `UserError` like `check_recording`, and where there is no display, saying how to see the recording then.
    """
    check_recording(path)
    if not has_display():
        raise UserError(
            f"{path}: no display to open a window on; the same command with --web shows it in a browser, or copy the "
            "file to another machine: `pip install rerun-sdk`, `rerun recording.rrd`"
        )
    subprocess.Popen([viewer_program(), str(path)], start_new_session=True)


def has_display() -> bool:
    """Can a window be opened? On Linux the environment says so."""
    return sys.platform != "linux" or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))


def serve_recording(path: Path) -> None:
    """Show a recording to a browser on this machine until Ctrl-C. Raises `UserError` like `check_recording`."""
    check_recording(path)
    data, page = _free_port(9876), _free_port(9090)
    ports = ("--bind", "127.0.0.1", "--port", str(data), "--web-viewer-port", str(page))
    print(f"http://127.0.0.1:{page}?url=rerun%2Bhttp%3A%2F%2F127.0.0.1%3A{data}%2Fproxy")
    print(
        f"From another machine: `ssh -L {page}:localhost:{page} -L {data}:localhost:{data} ...` first. Ctrl-C ends it."
    )
    sys.stdout.flush()
    command = [viewer_program(), str(path), "--serve-web", *ports]
    try:
        done = subprocess.run(command, env=os.environ | {"RUST_LOG": "error"}, check=False)
    except KeyboardInterrupt:
        return
    raise UserError(f"{path}: Rerun's web viewer ended with code {done.returncode}; its message is above")


def _free_port(wanted: int) -> int:
    """The wanted port, or another one where it is taken."""
    for port in (wanted, 0):
        with socket.socket() as s, suppress(OSError):
            s.bind(("127.0.0.1", port))
            return s.getsockname()[1]
    raise UserError("no free port to serve the recording on; end another server")


def viewer_program() -> str:
    """The viewer that comes with the installed Rerun package."""
    program = Path(rerun_cli.__file__).with_name("rerun")
    return str(program if program.is_file() else program.with_suffix(".exe"))
