"""A lock file that many processes share. The system releases the lock when its holder ends, however it ends."""

import os
import sys
from pathlib import Path

from filelock import AcquireReturnProxy, FileLock, Timeout

from garmentbench.errors import UserError

PATIENCE = 1.0  # seconds of silent waiting: most locks are held for an instant


def take(file: Path) -> AcquireReturnProxy:
    """Lock a file, which is made if need be; the end of a `with` block releases it.

    Waits while another process holds it. Raises `UserError` where its folder can't be written to.
    """
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        lock = FileLock(file)
        try:
            taken = lock.acquire(timeout=PATIENCE)
        except Timeout:
            holder = file.read_text().strip()
            if holder == str(os.getpid()):
                raise RuntimeError(f"{file} is locked by this process already") from None
            whom = f"process {holder}" if holder else "another process"
            print(f"{file}: locked by {whom}; waiting", file=sys.stderr, flush=True)
            taken = lock.acquire()
        file.write_text(str(os.getpid()))
    except OSError as e:
        raise UserError(
            f"{file.parent}: can't be written to ({e.strerror}); free some space or check its permissions"
        ) from e
    return taken


def held(file: Path) -> bool:
    """Does any process hold the lock?"""
    if not file.is_file():
        return False
    try:
        with FileLock(file).acquire(blocking=False):
            return False
    except Timeout:
        return True
    except OSError:  # a folder that may only be read: nobody works there
        return False
