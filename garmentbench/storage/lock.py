"""A lock file that many processes share. The system releases the lock when its holder ends, however it ends."""

import fcntl
import os
import sys
from io import TextIOWrapper
from pathlib import Path

from garmentbench.errors import UserError


def take(file: Path) -> TextIOWrapper:
    """Lock a file, which is made if need be; closing what is returned releases it.

    Waits while another process holds it. Raises `UserError` where its folder can't be written to.
    """
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        lock = file.open("a+")
        _wait_for(lock, file)
        lock.truncate(0)
        lock.write(str(os.getpid()))
        lock.flush()
    except OSError as e:
        raise UserError(f"{file.parent}: can't be written to ({e.strerror}); free some space or mend its rights") from e
    return lock


def _wait_for(lock: TextIOWrapper, file: Path) -> None:
    """Wait until the lock is ours, saying who has it."""
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        lock.seek(0)
        holder = lock.read().strip()
        if holder == str(os.getpid()):
            raise RuntimeError(f"{file} is locked by this process already") from None
        print(f"{file}: waiting for process {holder or '?'}, which is at it", file=sys.stderr, flush=True)
        fcntl.flock(lock, fcntl.LOCK_EX)


def held(file: Path) -> bool:
    """Does any process hold the lock?"""
    if not file.is_file():
        return False
    with file.open() as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False
