"""Progress of long work: a bar on a terminal, a line now and then elsewhere, nothing for what is over in two seconds.

Where many processes work at once, each passes its progress on instead (`listening`), and one of them shows it all.
"""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar

QUIET_SECONDS = 2.0
LINE_SECONDS = 30.0
REPORT_SECONDS = 0.2

Step = Callable[[], None]
Report = Callable[[str, int, int], None]
_listener: ContextVar[Report | None] = ContextVar("garmentbench_progress", default=None)


@contextmanager
def listening(report: Report) -> Iterator[None]:
    """Inside the block progress is not shown but passed to `report(label, done, total)`, a few times a second."""
    token = _listener.set(report)
    try:
        yield
    finally:
        _listener.reset(token)


def track(total: int, label: str, done: int = 0) -> AbstractContextManager[Step]:
    """Show progress of `total` steps, of which `done` are done already; call the value it gives once per step done."""
    report = _listener.get()
    if report is not None:
        return _passed_on(total, label, done, report)
    return _bar(total, label, done) if sys.stderr.isatty() else _lines(total, label, done)


@contextmanager
def _passed_on(total: int, label: str, done: int, report: Report) -> Iterator[Step]:
    last = 0.0

    def step() -> None:
        nonlocal done, last
        done += 1
        if time.monotonic() - last >= REPORT_SECONDS or done == total:
            last = time.monotonic()
            report(label, done, total)

    report(label, done, total)
    yield step


@contextmanager
def _lines(total: int, label: str, done: int) -> Iterator[Step]:
    start = last = time.monotonic()
    first = done

    def step() -> None:
        nonlocal done, last
        done += 1
        now = time.monotonic()
        if now - last >= LINE_SECONDS:
            last = now
            left = (now - start) / (done - first) * (total - done)
            print(f"{label}: {done} of {total}, about {left:.0f} s left", file=sys.stderr, flush=True)

    yield step
    if time.monotonic() - start >= QUIET_SECONDS:
        print(f"{label}: {done} of {total} in {time.monotonic() - start:.0f} s", file=sys.stderr, flush=True)


@contextmanager
def _bar(total: int, label: str, done: int) -> Iterator[Step]:
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    bar = Progress(*columns, console=Console(stderr=True))
    task = bar.add_task(label, total=total, completed=done)
    start = time.monotonic()

    def step() -> None:
        bar.advance(task)
        if not bar.live.is_started and time.monotonic() - start >= QUIET_SECONDS:
            bar.start()

    try:
        yield step
    finally:
        bar.stop()
