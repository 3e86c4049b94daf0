"""Progress of long work: a bar on a terminal, a line now and then elsewhere, nothing for what is over in two seconds."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

QUIET_SECONDS = 2.0
LINE_SECONDS = 30.0


@contextmanager
def track(total: int, label: str, done: int = 0) -> Iterator[Callable[[], None]]:
    """Show progress of `total` steps, of which `done` are done already; call the value it gives once per step done."""
    show = _bar(total, label, done) if sys.stderr.isatty() else _lines(total, label, done)
    with show as step:
        yield step


@contextmanager
def _lines(total: int, label: str, done: int) -> Iterator[Callable[[], None]]:
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
def _bar(total: int, label: str, done: int) -> Iterator[Callable[[], None]]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn())
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
