"""Opening a recording, and telling whether it is whole."""

import subprocess
import warnings
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
    """Open a recording in Rerun's viewer, which outlives this process. Raises `UserError` as `check_recording`."""
    check_recording(path)
    subprocess.Popen([viewer_program(), str(path)], start_new_session=True)


def viewer_program() -> str:
    """The viewer that comes with the installed Rerun package."""
    program = Path(rerun_cli.__file__).with_name("rerun")
    return str(program if program.is_file() else program.with_suffix(".exe"))
