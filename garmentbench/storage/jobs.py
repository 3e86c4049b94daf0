"""Jobs that wait for each other, run by a few worker processes. What fails takes only what needs it along."""

import os
import signal
import time
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.queues import Queue
from queue import Empty
from typing import Any

from garmentbench import progress


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
    """A job that raised, or one whose need failed."""

    label: str
    message: str


def run_jobs(jobs: dict[tuple, Job], workers: int) -> dict[tuple, Any]:
    """Run all jobs, the longest chains first; each result is the call's value or a `Failure`.

    Each worker has one thread. Ctrl-C ends the workers and passes on; what they had not finished is resumed next time.
    """
    urgency = _urgency(jobs)
    results: dict[tuple, Any] = {}
    waiting = dict(jobs)
    running: dict[Future, Job] = {}
    context = get_context("spawn")
    reports = context.Queue()

    def make_pool() -> ProcessPoolExecutor:
        return ProcessPoolExecutor(workers, mp_context=context, initializer=_begin_worker, initargs=(reports,))

    pool = make_pool()
    try:
        with _Board(len(jobs), reports) as board:
            while waiting or running:
                for key in _doomed(waiting, results):
                    results[key] = Failure(waiting.pop(key).label, "not run: what it needs has failed")
                    board.left_out()
                ready = [k for k, job in waiting.items() if all(n in results for n in (*job.needs, *job.after))]
                for key in sorted(ready, key=lambda k: -urgency[k])[: workers - len(running)]:
                    job = waiting.pop(key)
                    inputs = [results[n] for n in job.needs]
                    try:
                        future = pool.submit(_work, job, inputs)
                    except BrokenProcessPool:  # a worker died, which ended the pool and all that ran in it
                        pool = make_pool()
                        future = pool.submit(_work, job, inputs)
                    running[future] = job
                    board.started(job.label)
                done, _ = wait(running, timeout=0.5, return_when=FIRST_COMPLETED)
                board.listen()
                for future in done:
                    job = running.pop(future)
                    results[job.key] = _result(future, job)
                    board.ended(job.label, results[job.key])
    except BaseException:
        for process in list(pool._processes.values()):
            process.terminate()
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    pool.shutdown()
    return results


def _urgency(jobs: dict[tuple, Job]) -> dict[tuple, float]:
    """Cost of the longest chain of jobs that starts with each."""
    after: dict[tuple, list[tuple]] = {key: [] for key in jobs}
    for key, job in jobs.items():
        for need in (*job.needs, *job.after):
            after[need].append(key)
    known: dict[tuple, float] = {}

    def chain(key: tuple) -> float:
        if key not in known:
            known[key] = jobs[key].cost + max((chain(k) for k in after[key]), default=0.0)
        return known[key]

    return {key: chain(key) for key in jobs}


def _doomed(waiting: dict[tuple, Job], results: dict[tuple, Any]) -> list[tuple]:
    return [k for k, job in waiting.items() if any(isinstance(results.get(n), Failure) for n in job.needs)]


def _result(future: Future, job: Job) -> Any:
    try:
        return future.result()
    except BrokenProcessPool:
        return Failure(job.label, "its worker died, perhaps for want of memory; the same command again resumes it")


_reports: Queue  # of a worker process; set once, when it starts


def _begin_worker(reports: Queue) -> None:
    global _reports
    _reports = reports
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the parent, which ends the workers
    import torch

    torch.set_num_threads(1)


def _work(job: Job, inputs: list) -> Any:
    """In a worker: do the job; whatever it raises becomes a `Failure`, since one job must not end the others."""
    with progress.listening(lambda label, done, total: _reports.put((job.label, label, done, total))):
        try:
            return job.call(*inputs, *job.arguments)
        except Exception as e:  # handed to the parent, which says so and exits with an error
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

    def left_out(self) -> None:
        """A job will not be run."""
        self.count += 1
        self.progress.advance(self.all)

    def ended(self, label: str, result: Any) -> None:
        self.count += 1
        self.progress.advance(self.all)
        if label in self.bars:
            self.progress.remove_task(self.bars.pop(label))
        seconds = time.monotonic() - self.begun.pop(label, time.monotonic())
        state = f"FAILED: {result.message}" if isinstance(result, Failure) else f"{seconds:.1f} s"
        self.console.print(
            f"[{self.count}/{self.total}] {label}: {state}", markup=False, highlight=False, soft_wrap=True
        )


def worker_count() -> int:
    """One worker a core: each job is one thread."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
