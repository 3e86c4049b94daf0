"""Writing a file so that it is there whole or not at all."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from garmentbench.errors import UserError


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """A temporary name beside `path` to write to; it takes the place of `path` when the block ends without an error.

    Raises `UserError` when the disk is full or the folder can't be written to; the old file, if any, is then untouched.
    """
    partial = path.with_name(path.name + ".partial")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield partial
        with partial.open("rb") as f:
            os.fsync(f.fileno())
        os.replace(partial, path)
    except OSError as e:
        raise UserError(
            f"{path}: can't be written ({e.strerror or e}); free some space or check its permissions, "
            "then run the same command again"
        ) from e
    finally:
        if partial.is_file():
            partial.unlink()


def write_text(path: Path, text: str) -> None:
    """Write a text file whole. Raises as `written_whole`."""
    with written_whole(path) as partial:
        partial.write_text(text, encoding="utf-8")
