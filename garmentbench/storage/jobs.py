"""Jobs that wait for each other, run by a few worker processes. A job that fails takes only what needs it along."""

import time
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass
from graphlib import TopologicalSorter
from multiprocessing import get_context
from multiprocessing.queues import Queue
from queue import Empty
from typing import Any

from pebble import ProcessExpired, ProcessPool

from garmentbench import progress
from garmentbench.errors import FOREIGN, UserError

_SKIPPED = "not run: what it needs has failed"


@dataclass(frozen=True)
class Job:
    """One piece of work.

    Attributes:
        key: Its name among the jobs.
        label: Its name for people.
        call: A module-level function; called with the results of `needs`, in their order, then `arguments`.
        needs: Keys of the jobs whose results it takes.
        arguments: Further arguments.
        cost: Rough seconds, to start what the most work waits for first.
        after: Keys of jobs that it waits for, however they end.
    """

    key: tuple
    label: str
    call: Callable[..., Any]
    needs: tuple[tuple, ...] = ()
    arguments: tuple = ()
    cost: float = 1.0
    after: tuple[tuple, ...] = ()


@dataclass(frozen=True)
class Failure:
    """A job that raised, or one whose need failed, which was skipped."""

    label: str
    message: str
    skipped: bool = False


@dataclass(frozen=True)
class Reused:
    """What a job's call returns in place of a value that was there already."""

    value: Any


def run_jobs(jobs: dict[tuple, Job], workers: int) -> dict[tuple, Any]:
    """Run all jobs, the longest chains first; each result is the call's value (that in a `Reused`) or a `Failure`.

    Each worker has one thread; one that dies takes only its job along. Ctrl-C ends the workers and passes on; what they
    had not finished is resumed next time. Raises `graphlib.CycleError` where jobs wait for each other in a circle.
    """
    urgency = _urgency(jobs)
    sorter = TopologicalSorter(_waits_for(jobs))
    sorter.prepare()
    results: dict[tuple, Any] = {}
    ready: list[tuple] = []
    running: dict[Future, tuple] = {}
    context: Any = get_context("spawn")
    reports = context.Queue()
    pool = ProcessPool(workers, context=context, initializer=_begin_worker, initargs=(reports,))
    try:
        with _Board(len(jobs), reports) as board:
            while sorter.is_active():
                ready = sorted([*ready, *sorter.get_ready()], key=lambda key: -urgency[key])
                for key in tuple(ready):
                    job = jobs[key]
                    inputs = [results[need] for need in job.needs]
                    if any(isinstance(value, Failure) for value in inputs):
                        results[key] = Failure(job.label, _SKIPPED, True)
                        board.ended(job.label, results[key])
                        sorter.done(key)
                    elif len(running) < workers:
                        running[pool.schedule(_work, (job, inputs))] = key
                        board.started(job.label)
                    else:
                        continue
                    ready.remove(key)
                done, _ = wait(running, timeout=0.5, return_when=FIRST_COMPLETED)
                board.listen()
                for future in done:
                    key = running.pop(future)
                    result = _result(future, jobs[key])
                    results[key] = result.value if isinstance(result, Reused) else result
                    board.ended(jobs[key].label, result)
                    sorter.done(key)
        pool.close()
    finally:
        pool.stop()  # kills what still runs
        pool.join()
    return results


def run_here(jobs: dict[tuple, Job]) -> dict[tuple, Any]:
    """All jobs in this process, one after the other, with results as `run_jobs` gives them; but only a `UserError`
    becomes a `Failure`, and anything else passes on."""
    results: dict[tuple, Any] = {}
    for key in TopologicalSorter(_waits_for(jobs)).static_order():
        job, inputs = jobs[key], [results[need] for need in jobs[key].needs]
        try:
            failed = any(isinstance(value, Failure) for value in inputs)
            result = Failure(job.label, _SKIPPED, True) if failed else job.call(*inputs, *job.arguments)
        except UserError as e:
            result = Failure(job.label, str(e))
        results[key] = result.value if isinstance(result, Reused) else result
    return results


def _waits_for(jobs: dict[tuple, Job]) -> dict[tuple, tuple[tuple, ...]]:
    return {key: (*job.needs, *job.after) for key, job in jobs.items()}


def _urgency(jobs: dict[tuple, Job]) -> dict[tuple, float]:
    """Cost of the longest chain of jobs that starts with each."""
    urgency = {key: job.cost for key, job in jobs.items()}
    waits_for = _waits_for(jobs)
    for key in reversed(list(TopologicalSorter(waits_for).static_order())):
        for need in waits_for[key]:
            urgency[need] = max(urgency[need], jobs[need].cost + urgency[key])
    return urgency


def _result(future: Future, job: Job) -> Any:
    try:
        return future.result()
    except ProcessExpired:
        return Failure(job.label, "its worker died, perhaps for want of memory; the same command again resumes it")


_reports: Queue  # of a worker process; set once, when it starts


def _begin_worker(reports: Queue) -> None:
    global _reports  # noqa: PLW0603 (a pool hands its workers nothing but this call)
    _reports = reports
    _reports.cancel_join_thread()  # a worker may end though nobody has read its last report
    import torch

    torch.set_num_threads(1)


def _work(job: Job, inputs: list) -> Any:
    """In a worker: do the job; whatever it raises becomes a `Failure`, since one job must not end the others."""
    with progress.listening(lambda label, done, total: _reports.put((job.label, label, done, total))):
        try:
            return job.call(*inputs, *job.arguments)
        except UserError as e:
            return Failure(job.label, str(e))
        except FOREIGN as e:  # handed to the parent, which says so and exits with an error
            return Failure(job.label, f"{type(e).__name__}: {e}")


class _Board:
    """What the user sees: a bar over all jobs and one for each that runs; lines where there is no terminal."""

    def __init__(self, total: int, reports: Queue) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
        self.console = Console(stderr=True)
        self.progress = Progress(*columns, console=self.console, disable=not self.console.is_terminal)
        self.reports, self.total, self.count = reports, total, 0
        self.bars: dict[str, Any] = {}
        self.begun: dict[str, float] = {}

    def __enter__(self) -> "_Board":
        self.progress.start()
        self.all = self.progress.add_task("jobs", total=self.total)
        return self

    def __exit__(self, *_: object) -> None:
        self.progress.stop()

    def started(self, label: str) -> None:
        self.begun[label] = time.monotonic()
        self.bars[label] = self.progress.add_task(label, total=None)

    def listen(self) -> None:
        """Take in what the workers have reported."""
        while True:
            try:
                job, label, done, total = self.reports.get_nowait()
            except Empty:
                return
            if job in self.bars:
                self.progress.update(self.bars[job], description=f"{job}: {label}", completed=done, total=total)

    def ended(self, label: str, result: Any) -> None:
        self.count += 1
        self.progress.advance(self.all)
        if label in self.bars:
            self.progress.remove_task(self.bars.pop(label))
        seconds = time.monotonic() - self.begun.pop(label, time.monotonic())
        if isinstance(result, Failure):
            state = f"skipped, {result.message}" if result.skipped else f"FAILED: {result.message}"
        else:
            state = "reused" if isinstance(result, Reused) else f"{seconds:.1f} s"
        self.console.print(
            f"[{self.count}/{self.total}] {label}: {state}", markup=False, highlight=False, soft_wrap=True
        )
