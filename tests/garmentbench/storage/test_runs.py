"""The run store: ids, resuming, locks, half-written results, listing and comparing."""

import json
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from filelock import FileLock

from garmentbench.cli import main
from garmentbench.errors import UsageError, UserError
from garmentbench.storage.compare import compare, list_rows
from garmentbench.storage.lock import take
from garmentbench.storage.runs import RunStore, UnfinishedError, only_finished, run_id

IDENTITY = {"config": {"width": 8, "rate": 1e-3}, "data": "abc", "code": "def", "seed": 3}


def process(store: Path, body: str) -> subprocess.Popen:
    """A process that opens the run of `IDENTITY` as `run`, then does `body`."""
    code = f"""
        import time
        from pathlib import Path
        from garmentbench.storage.runs import RunStore
        run = RunStore(Path({str(store)!r})).open("train", {IDENTITY!r})
    """
    script = textwrap.dedent(code) + textwrap.dedent(body)
    return subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def wait_for(path: Path, text: str, seconds: float = 20.0) -> None:
    end = time.monotonic() + seconds
    while not (path.is_file() and text in path.read_text()):
        assert time.monotonic() < end, f"'{text}' never came into {path}"
        time.sleep(0.02)


def test_id_does_not_depend_on_the_order_of_keys():
    shuffled = {"seed": 3, "code": "def", "data": "abc", "config": {"rate": 1e-3, "width": 8}}
    assert run_id("train", IDENTITY) == run_id("train", shuffled)


@pytest.mark.parametrize(
    "change", [{"seed": 4}, {"data": "abd"}, {"code": "dee"}, {"config": {"width": 8, "rate": 2e-3}}, {"extra": None}]
)
def test_id_differs_when_anything_that_decides_differs(change):
    assert run_id("train", IDENTITY) != run_id("train", IDENTITY | change)
    assert run_id("train", IDENTITY) != run_id("evaluate", IDENTITY)


def test_a_finished_run_is_reused(tmp_path):
    store = RunStore(tmp_path)
    with store.open("train", IDENTITY) as run:
        assert not run.finished and run.seed == 3
        run.finish({"l2": 1.5})
    again = store.open("train", IDENTITY)
    assert again.finished and again.results == {"l2": 1.5}
    record = json.loads((again.folder / "run.json").read_text())
    assert (
        record["identity"] == IDENTITY and record["machine"]["cores"] >= 1 and record["peak_memory_mb"]["process"] > 1
    )
    assert {"code_version", "packages", "times"} <= record.keys()


def test_a_killed_run_is_interrupted_then_resumes(tmp_path):
    worker = process(
        tmp_path,
        """
        for step in range(1, 1000):
            run.log(step, loss=1 / step)
            (run.folder / "checkpoint.new").write_text("5")
            (run.folder / "checkpoint.new").replace(run.folder / "checkpoint")  # as checkpoints must be
            time.sleep(0.02)
        """,
    )
    store = RunStore(tmp_path)
    folder = tmp_path / run_id("train", IDENTITY)
    wait_for(folder / "metrics.jsonl", '"step": 8')
    assert store.get(folder.name).state == "running"
    worker.send_signal(signal.SIGKILL)
    worker.communicate()
    assert store.get(folder.name).state == "interrupted"
    with (folder / "metrics.jsonl").open("a") as f:
        f.write('{"step": 99, "lo')  # a line torn by the kill
    with store.open("train", IDENTITY) as run:
        assert not run.finished and (run.folder / "checkpoint").read_text() == "5"
        run.truncate_log(5)
        run.log(6, loss=0.0)
        assert [m["step"] for m in run.metrics()] == [1, 2, 3, 4, 5, 6]
        run.finish()
        assert run.times["sessions"] == 2 and run.record["times"]["seconds"] > 0


def test_the_log_is_cut_where_a_resumed_run_repeats_itself(tmp_path):
    store = RunStore(tmp_path)
    with store.open("train", IDENTITY) as run:
        for step in range(6):
            run.log(step, loss=step)
    with store.open("train", IDENTITY) as run:
        run.log(3, loss=-1)
        assert [(m["step"], m["loss"]) for m in run.metrics()] == [(0, 0), (1, 1), (2, 2), (3, -1)]


def test_a_log_that_is_nothing_but_a_torn_line(tmp_path):
    with RunStore(tmp_path).open("train", IDENTITY) as run:
        (run.folder / "metrics.jsonl").write_text('{"step": 0, "lo')
        assert run.metrics() == []
        run.log(0, loss=1.0)
        assert run.metrics() == [{"step": 0, "loss": 1.0}]


def test_the_second_process_waits_and_finds_the_run_finished(tmp_path):
    folder = tmp_path / run_id("train", IDENTITY)
    with RunStore(tmp_path).open("train", IDENTITY) as run:
        second = process(tmp_path, "print(run.finished, run.results)")
        assert second.stderr.readline().startswith(f"{folder / 'lock'}: locked by process {os.getpid()}; waiting")
        run.finish({"l2": 2.0})
    assert second.communicate(timeout=20)[0].strip() == "True {'l2': 2.0}"


def test_a_lock_held_for_an_instant_is_waited_for_in_silence(tmp_path, capsys):
    """It said "locked by process ?; waiting"."""
    lock = FileLock(tmp_path / "lock", thread_local=False)
    lock.acquire()
    (tmp_path / "lock").write_text("")
    timer = threading.Timer(0.2, lock.release)
    timer.start()
    with take(tmp_path / "lock"):
        assert capsys.readouterr().err == ""
    timer.join()


def test_a_reused_run_says_so(tmp_path):
    store = RunStore(tmp_path)
    with store.open("train", IDENTITY) as run:
        run.finish({})
    assert not run.reused and store.open("train", IDENTITY).reused


def test_what_is_only_looked_for_is_not_begun(tmp_path):
    store = RunStore(tmp_path)
    store.open("train", IDENTITY).finish({"a": 1})
    with store.open("train", {"seed": 8}) as failed:
        failed.fail("hold: fit raised ValueError")
    before = sorted(tmp_path.rglob("*"))
    with only_finished():
        assert store.open("train", IDENTITY).results == {"a": 1}
        with pytest.raises(UnfinishedError):
            store.open("train", {"seed": 9})
        with pytest.raises(UserError, match="hold: fit raised ValueError"):
            store.open("train", {"seed": 8})
    assert sorted(tmp_path.rglob("*")) == before
    assert not store.open("train", {"seed": 9}).finished


def test_opening_a_run_twice_in_one_process_is_an_error_and_no_deadlock(tmp_path):
    store = RunStore(tmp_path)
    with store.open("train", IDENTITY), pytest.raises(RuntimeError, match="locked by this process already"):
        store.open("train", IDENTITY)
    with store.open("train", IDENTITY) as run:
        assert not run.finished


@pytest.mark.parametrize(
    "content", ["", "{", '{"id": "train-', "[]", '{"id": "another-run", "results": {}}', "\x00\x00"]
)
def test_a_damaged_record_is_never_taken_for_finished(tmp_path, content):
    store = RunStore(tmp_path)
    with store.open("train", IDENTITY) as run:
        run.finish({"l2": 1.0})
    (run.folder / "run.json").write_text(content)
    assert store.get(run.id).state == "interrupted"
    with pytest.raises(UserError, match="no results yet"):
        _ = store.get(run.id).results
    with store.open("train", IDENTITY) as again:
        assert not again.finished


def test_a_stage_is_shared_and_released_with_its_run(tmp_path):
    store = RunStore(tmp_path)
    with store.open("train", IDENTITY) as run:
        stage = run.stage("sdf", {"data": "abc"})
        assert not stage.finished and run.stage("sdf", {"data": "abc"}) is stage
        stage.finish({"loss": 0.1})
    with store.open("train", IDENTITY | {"seed": 4}) as other:
        stage = other.stage("sdf", {"data": "abc"})
        assert stage.finished and stage.kind == "sdf"
        other.stage("stage_1", {"data": "abc"})  # left unfinished
    assert store.list({"kind": "stage_1"})[0].state == "interrupted"


def test_peak_memory_is_the_runs_own(tmp_path):
    store = RunStore(tmp_path)

    def peak(seed: int, numbers: int) -> float:
        with store.open("train", IDENTITY | {"seed": seed}) as run:
            np.ones(numbers)
            run.finish()
        return store.get(run.id).record["peak_memory_mb"]["process"]

    big = peak(0, 40_000_000)
    assert big - peak(1, 1) > 200 if Path("/proc/self/clear_refs").is_file() else big > 300


def test_get_by_prefix_and_by_a_wrong_name(tmp_path):
    store = RunStore(tmp_path)
    ids = [store.open("train", IDENTITY | {"seed": seed}).id for seed in (0, 1)]
    assert store.get(ids[0][:-2]).id == ids[0]
    with pytest.raises(UsageError, match="2 runs begin with"):
        store.get("train-")
    with pytest.raises(UsageError, match=f"did you mean '{ids[1]}'"):
        store.get(ids[1].replace("train", "trian"))


def test_an_unknown_filter_is_told(tmp_path, capsys):
    """A key that no run has found none, as if it were a value."""
    with RunStore(tmp_path / "runs").open("train", IDENTITY) as run:
        run.finish()
    typed = "--home", str(tmp_path), "runs"
    for unknown, complaint in (("foo", "unknown filter 'foo': Known: "), ("knd", "did you mean 'kind'")):
        assert main([*typed, f"{unknown}=bar"]) == 2
        assert complaint in capsys.readouterr().err
    assert main([*typed, "scene=none"]) == 0 and "match" in capsys.readouterr().out
    assert main([*typed, "kind=train"]) == 0 and run.id in capsys.readouterr().out


def test_list_filters_by_any_key_or_its_end(tmp_path):
    store = RunStore(tmp_path)
    for seed in (0, 1, 2):
        with store.open("train", IDENTITY | {"seed": seed}) as run:
            if seed:
                run.finish({"l2": float(seed)})
    assert len(store.list()) == 3
    assert [r.seed for r in store.list({"state": "interrupted"})] == [0]
    assert [r.seed for r in store.list({"width": "8", "results.l2": "2.0"})] == [2]
    assert store.list({"width": "9"}) == []


def test_compare_shows_what_differs_and_all_results(tmp_path):
    store = RunStore(tmp_path)
    runs = []
    for seed, value in ((0, 1.5), (1, 2.5)):
        with store.open("train", IDENTITY | {"seed": seed}) as run:
            run.finish({"rows": [{"metric": "l2", "horizon": 50, "unit": "cm", "value": value}]})
        runs.append(store.get(run.id))
    table = dict(compare(runs))
    assert table["identity.seed"] == [0, 1] and table["l2@50 [cm]"] == [1.5, 2.5]
    assert "identity.data" not in table


def test_a_store_that_cannot_be_written_to(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="can't be written to"):
        RunStore(tmp_path / "file").open("train", IDENTITY)


def test_a_run_that_failed_says_why_and_is_tried_again(tmp_path):
    store = RunStore(tmp_path)
    with store.open("train", IDENTITY) as run:
        run.fail("fit raised ZeroDivisionError: no data")
        assert run.state == "running"
    failed = store.get(run.id)
    assert failed.state == "failed" and "no data" in failed.failure and store.list({"state": "failed"})
    assert list_rows([failed])[0]["about"] == "seed 3: fit raised ZeroDivisionError: no data"
    with pytest.raises(UserError, match="is failed, it has no results yet"):
        _ = failed.results
    with store.open("train", IDENTITY) as run:
        assert run.failure is None and not run.finished
    assert store.get(run.id).state == "interrupted"
    with store.open("train", IDENTITY) as run:
        run.finish()
    assert store.get(run.id).state == "finished"


def test_a_method_that_failed_in_a_finished_run_is_listed_with_its_reason(tmp_path):
    with RunStore(tmp_path).open("evaluate", IDENTITY) as run:
        run.finish({"status": "diverged", "message": "frame 7: not finite"})
    assert list_rows([run])[0]["about"].endswith(": diverged: frame 7: not finite")


def test_reading_a_store_that_may_not_be_written_to(tmp_path, monkeypatch):
    with RunStore(tmp_path).open("train", IDENTITY) as run:
        pass

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("filelock.FileLock.acquire", refuse)
    assert RunStore(tmp_path).get(run.id).state == "interrupted"
