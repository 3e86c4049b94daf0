"""The job runner: order, failures, and what a listener hears."""

import os
import signal
import subprocess
import sys
import time
from graphlib import CycleError
from pathlib import Path

import pytest

from garmentbench.errors import UserError
from garmentbench.storage.jobs import Failure, Job, Reused, _urgency, run_jobs


def add(*numbers: int) -> int:
    return sum(numbers)


def fail(*_: int) -> int:
    raise ValueError("no such luck")


def sleep_for(seconds: float) -> float:
    time.sleep(seconds)
    return seconds


def die_after(seconds: float) -> None:
    time.sleep(seconds)
    os._exit(3)


def sleep_forever(mark: str) -> None:
    Path(mark).write_text(str(os.getpid()))
    time.sleep(600)


def test_results_flow_along_needs_and_a_failure_takes_only_its_own_chain_along():
    jobs = [
        Job(("a",), "a", add, arguments=(1, 2)),
        Job(("b",), "b", add, needs=(("a",),), arguments=(10,)),
        Job(("bad",), "bad", fail, needs=(("a",),)),
        Job(("after",), "after", add, needs=(("bad",), ("b",))),
        Job(("end",), "end", add, needs=(("b",), ("a",))),
    ]
    results = run_jobs({j.key: j for j in jobs}, workers=2)
    assert results[("b",)] == 13
    assert results[("end",)] == 16
    assert results[("bad",)] == Failure("bad", "ValueError: no such luck")
    assert isinstance(results[("after",)], Failure)


def test_a_worker_that_dies_is_a_failure_and_not_a_hang():
    jobs = [Job(("dies",), "dies", os._exit, arguments=(3,)), Job(("after",), "after", add, needs=(("dies",),))]
    results = run_jobs({j.key: j for j in jobs}, workers=1)
    assert "worker died" in results[("dies",)].message
    assert isinstance(results[("after",)], Failure)


def test_a_worker_that_dies_takes_only_its_own_job_along():
    jobs = [Job(("dies",), "dies", die_after, arguments=(1.0,))]
    jobs += [Job((i,), f"sleeps {i}", sleep_for, arguments=(2.0,)) for i in range(3)]
    results = run_jobs({j.key: j for j in jobs}, workers=2)
    assert "worker died" in results[("dies",)].message and [results[i,] for i in range(3)] == [2.0] * 3


def test_jobs_that_wait_for_each_other_are_refused():
    jobs = [Job(("a",), "a", add, needs=(("b",),)), Job(("b",), "b", add, needs=(("a",),))]
    with pytest.raises(CycleError):
        run_jobs({j.key: j for j in jobs}, workers=1)


def test_a_job_may_wait_for_one_that_fails():
    jobs = [Job(("bad",), "bad", fail), Job(("after",), "after", add, arguments=(1,), after=(("bad",),))]
    assert run_jobs({j.key: j for j in jobs}, workers=1)["after",] == 1


def test_urgency_is_the_cost_of_the_longest_chain():
    jobs = [
        Job(("a",), "a", add, cost=1),
        Job(("b",), "b", add, needs=(("a",),), cost=5),
        Job(("c",), "c", add, needs=(("a",),), cost=2),
    ]
    assert _urgency({j.key: j for j in jobs}) == {("a",): 6, ("b",): 5, ("c",): 2}


def test_ctrl_c_ends_the_workers(tmp_path):
    mark = tmp_path / "pid"
    code = (
        "from garmentbench.storage.jobs import Job, run_jobs\nfrom tests.garmentbench.storage.test_jobs import "
        "sleep_forever\n"
        f"if __name__ == '__main__': run_jobs({{1: Job((1,), 'sleeper', sleep_forever, arguments=({str(mark)!r},))}}, "
        "1)"
    )
    script = tmp_path / "main.py"
    script.write_text(code)
    root = str(Path(__file__).resolve().parents[3])
    parent = subprocess.Popen(
        [sys.executable, script], env=os.environ | {"PYTHONPATH": root}, stderr=subprocess.DEVNULL
    )
    deadline = time.monotonic() + 60
    while not (mark.exists() and mark.read_text()) and time.monotonic() < deadline:
        time.sleep(0.1)
    parent.send_signal(signal.SIGINT)
    assert parent.wait(20) != 0
    time.sleep(0.5)
    with pytest.raises(ProcessLookupError):
        os.kill(int(mark.read_text()), 0)


def find(value: int) -> Reused:
    return Reused(value)


def refuse() -> None:
    raise UserError("no garment; give one")


def leave() -> None:
    sys.exit(0)


def test_what_is_printed_tells_reused_failed_and_skipped_apart(capfd):
    """A sequence that was there took "3.4 s"; skipped jobs were counted but not printed."""
    jobs = [
        Job(("there",), "there", find, arguments=(1,)),
        Job(("more",), "more", add, needs=(("there",),), arguments=(2,)),
        Job(("refused",), "refused", refuse),
        Job(("left",), "left", leave),
        Job(("after",), "after", add, needs=(("refused",),)),
    ]
    results = run_jobs({j.key: j for j in jobs}, workers=1)
    assert results[("there",)] == 1 and results[("more",)] == 3 and results[("after",)].skipped
    said = capfd.readouterr().err
    assert "there: reused\n" in said and "refused: FAILED: no garment; give one\n" in said
    assert "after: skipped, not run: what it needs has failed\n" in said and "[5/5]" in said
    assert "left: FAILED: SystemExit: 0\n" in said
