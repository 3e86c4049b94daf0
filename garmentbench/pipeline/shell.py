"""Round other people's code: what it raises becomes one line, and a class is named so that it can be loaded again."""

import traceback
from collections.abc import Iterator
from contextlib import contextmanager

from garmentbench.errors import FOREIGN, UserError, described
from garmentbench.method import Method
from garmentbench.storage.atomic import write_text
from garmentbench.storage.runs import Run


@contextmanager
def foreign_code(run: Run, doing: str, method: type[Method]) -> Iterator[None]:
    """Make one line of whatever a method raises, and the run "failed"; the traceback stays in the run's folder."""
    try:
        yield
    except UserError as e:
        run.fail(str(e))
        raise
    except FOREIGN as e:  # a method may be anybody's, and raise anything
        file = run.folder / "error.txt"
        write_text(file, traceback.format_exc())
        line = f"{method.name}: {doing} raised {described(e, method)}"
        run.fail(line)
        raise UserError(f"{line}; the traceback is in {file}") from e


def address(method: type[Method]) -> str:
    """How to load a class again: "module:Class"."""
    return f"{method.__module__}:{method.__qualname__}"


def finished(run: Run) -> Run:
    """A finished run to read from; it says whether it was there already."""
    found = run.store.get(run.id)
    found.reused = run.reused
    return found
