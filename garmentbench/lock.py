"""A lock on a folder that many processes share. The system releases it when its holder ends, however it ends."""

import fcntl
import os
import sys
from io import TextIOWrapper
from pathlib import Path

from garmentbench.errors import UserError


def take(folder: Path) -> TextIOWrapper:
    """Lock a folder, which is made if need be; closing the file that is returned releases it.

    Waits while another process holds it. Raises `UserError` where the folder can't be written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = (folder / "lock").open("a+")
    except OSError as e:
        raise UserError(f"{folder}: can't be written ({e.strerror}); free some space or mend its rights") from e
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        lock.seek(0)
        holder = lock.read().strip()
        if holder == str(os.getpid()):
            raise RuntimeError(f"{folder.name} is open in this process already") from None
        print(f"{folder.name}: waiting for process {holder or '?'}, which is at it", file=sys.stderr, flush=True)
        fcntl.flock(lock, fcntl.LOCK_EX)
    lock.truncate(0)
    lock.write(str(os.getpid()))
    lock.flush()
    return lock


def held(folder: Path) -> bool:
    """Does any process hold the folder's lock?"""
    if not (folder / "lock").is_file():
        return False
    with (folder / "lock").open() as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False
