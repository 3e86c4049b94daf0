"""The run store: a folder a run, named by a hash of what decides its result.

A finished run is reused, an interrupted one resumes from its last checkpoint. `run.json` is written last and whole, so
a run without a good one is not finished. Many processes may share the store: a run is locked while it is worked on.
"""

import difflib
import json
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from datetime import UTC, datetime
from io import TextIOWrapper
from pathlib import Path
from typing import Any

from filelock import AcquireReturnProxy

from garmentbench import paths, progress
from garmentbench.errors import NEAR, UsageError, UserError
from garmentbench.storage.atomic import write_text
from garmentbench.storage.fingerprint import content_hash, plain
from garmentbench.storage.lock import held, take
from garmentbench.storage.machine import code_version, forget_peak_memory, machine, packages, peak_memory_mb

FAILURE = "failure.txt"  # in a run's folder: why the work raised
_looking: ContextVar[bool] = ContextVar("garmentbench_looking", default=False)
BEAT_SECONDS = 2.0  # times.json is this fresh when a process is killed


class Run:
    """One run: a folder, a seed, a log, and results once it is finished.

    From `RunStore.open` or `stage` the caller holds its lock until `finish`, `close`, the end of a `with` block or the
    end of the process; from `RunStore.get` and `list` it is for reading only.

    Attributes:
        id: "<kind>-<hash of the identity>".
        kind: What sort of run, e.g. "train", "evaluate", or the name of a stage.
        identity: Plain JSON of all that decides the result: configuration, data hash, seed, code fingerprint.
        folder: Where checkpoints and results go.
        seed: `identity["seed"]`, or 0.
        reused: It was finished already when it was opened.
        times: When it was started, wall seconds of all sessions together, and how many these were.
    """

    def __init__(self, store: "RunStore", kind: str, identity: dict, lock: AcquireReturnProxy | None = None) -> None:
        self.store, self.kind, self.identity = store, kind, identity
        self.id = run_id(kind, identity)
        self.folder = store.root / self.id
        self.seed = int(identity.get("seed", 0))
        self.reused = False
        self._lock = lock
        self._log: TextIOWrapper | None = None
        self._stages: dict[str, Run] = {}
        self._began = self._beat = time.monotonic()
        self.times = _read_json(self.folder / "times.json") or {"started": _now(), "seconds": 0.0, "sessions": 0}
        self._before = self.times["seconds"]

    def __enter__(self) -> "Run":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def record(self) -> dict | None:
        """What run.json says; None while the run is not finished."""
        record = _read_json(self.folder / "run.json")
        return record if record is not None and record.get("id") == self.id and "results" in record else None

    @property
    def finished(self) -> bool:
        return self.record is not None

    @property
    def results(self) -> dict:
        """Results of a finished run. Raises `UserError` for an unfinished one."""
        record = self.record
        if record is None:
            raise UserError(
                f"run {self.id} is {self.state}, it has no results yet; run the same command again to finish it"
            )
        return record["results"]

    @property
    def state(self) -> str:
        """ "finished", "running" (a process holds it), "failed" (the work raised) or "interrupted"."""
        if self.finished:
            return "finished"
        if self._lock is not None or held(self.folder / "lock"):
            return "running"
        return "interrupted" if self.failure is None else "failed"

    @property
    def failure(self) -> str | None:
        """Why the work raised when it was last tried; None where it did not."""
        file = self.folder / FAILURE
        return file.read_text(encoding="utf-8") if file.is_file() else None

    def log(self, step: int, **values: float) -> None:
        """Append a line to metrics.jsonl. Steps grow over a run; what an earlier, killed session logged from its first
        repeated step on is cut."""
        if self._log is None:
            self.truncate_log(step - 1)
            self._log = (self.folder / "metrics.jsonl").open("a", buffering=1)
        self._log.write(json.dumps({"step": step, **values}, default=plain) + "\n")
        self._keep_time()

    def truncate_log(self, step: int) -> None:
        """Keep the log's lines up to `step`: a run that resumes from a checkpoint repeats what came after it."""
        if self._log is not None:
            self._log.close()
            self._log = None
        path = self.folder / "metrics.jsonl"
        if path.is_file():
            write_text(path, "".join(json.dumps(m) + "\n" for m in self.metrics() if m["step"] <= step))

    def metrics(self) -> list[dict]:
        """The lines of metrics.jsonl; a last line torn by a kill is left out."""
        path = self.folder / "metrics.jsonl"
        lines = path.read_text().splitlines(keepends=True) if path.is_file() else []
        return [json.loads(line) for line in lines if line.endswith("\n")]

    def track(self, total: int, label: str, done: int = 0) -> AbstractContextManager[Callable[[], None]]:
        """A progress bar as a context manager; call the value it gives once per step done."""
        return progress.track(total, label, done)

    def stage(self, name: str, identity: dict) -> "Run":
        """A sub-run, shared by all runs that name the same stage with the same identity. Waits while another process
        works on it. It is released with this run at the latest."""
        stage_id = run_id(name, identity)
        if stage_id not in self._stages:
            self._stages[stage_id] = self.store.take(name, identity)
        return self._stages[stage_id]

    def finish(self, results: dict | None = None) -> None:
        """Write run.json, last and whole, and release the run."""
        self._keep_time(now=True)
        record = {
            "id": self.id,
            "kind": self.kind,
            "seed": self.seed,
            "identity": self.identity,
            "stages": sorted(self._stages),
            "results": results or {},
            "code_version": code_version(),
            "machine": machine(),
            "packages": packages(),
            "times": {**self.times, "finished": _now()},
            "peak_memory_mb": peak_memory_mb(),
        }
        write_text(self.folder / "run.json", json.dumps(record, indent=1, default=plain) + "\n")
        self.close()

    def fail(self, message: str) -> None:
        """Note in one line why the work raised: the run is "failed" until it is opened again. It is not released."""
        write_text(self.folder / FAILURE, message)

    def close(self) -> None:
        """Release the run and its stages, finished or not."""
        for stage in self._stages.values():
            stage.close()
        if self._log is not None:
            self._log.close()
            self._log = None
        if self._lock is not None:
            lock, self._lock = self._lock, None
            with lock:  # released even if the time can't be written, for the disk is full
                self._keep_time(now=True)

    def _begin(self) -> None:
        """Note what is about to be worked on, and when."""
        self.times["sessions"] += 1
        (self.folder / FAILURE).unlink(missing_ok=True)
        write_text(self.folder / "identity.json", json.dumps({"kind": self.kind, "identity": self.identity}, indent=1))
        self._keep_time(now=True)

    def _keep_time(self, now: bool = False) -> None:
        """Keep the wall seconds of all sessions on the disk, every now and then, since a kill gives no notice."""
        if now or time.monotonic() - self._beat >= BEAT_SECONDS:
            self._beat = time.monotonic()
            self.times["seconds"] = round(self._before + self._beat - self._began, 3)
            write_text(self.folder / "times.json", json.dumps(self.times))


class UnfinishedError(Exception):
    """What was only looked for is not there, or not finished."""


@contextmanager
def only_finished() -> Iterator[None]:
    """Within, nothing is worked on: what would be raises `UnfinishedError`, and a run whose work raised before raises a
    `UserError` that says so again."""
    token = _looking.set(True)
    try:
        yield
    finally:
        _looking.reset(token)


def require_work_allowed(what: str) -> None:
    """Raises `UnfinishedError` within `only_finished`. what: that is about to be made."""
    if _looking.get():
        raise UnfinishedError(what)


class RunStore:
    """All runs below a folder (`paths.runs()`, if none is given)."""

    def __init__(self, root: Path | None = None) -> None:
        self.root = paths.runs() if root is None else root

    def open(self, kind: str, identity: dict) -> Run:
        """The run of that identity, to be worked on unless it is finished.

        Waits while another process works on it. Raises `UserError` where the store can't be written to.
        """
        forget_peak_memory()
        return self.take(kind, identity)

    def take(self, kind: str, identity: dict) -> Run:
        """Like `open`, but without resetting the peak-memory counter (for stages)."""
        identity = json.loads(json.dumps(identity, default=plain))
        folder = self.root / run_id(kind, identity)
        if _looking.get():
            return self._finished(kind, identity)
        lock = take(folder / "lock")
        run = Run(self, kind, identity, lock)
        if run.finished:
            run.reused = True
            run._lock = None  # noqa: SLF001
            lock.lock.release()
        else:
            run._begin()  # noqa: SLF001
        return run

    def _finished(self, kind: str, identity: dict) -> Run:
        """The run, as it is. Raises `UnfinishedError` where it isn't finished, `UserError` where it failed."""
        run = Run(self, kind, identity)
        if not run.finished and run.failure is not None:
            raise UserError(run.failure)
        if not run.finished:
            raise UnfinishedError(run.id)
        run.reused = True
        return run

    def get(self, name: str) -> Run:
        """The run of that id, or of the only id that begins so. Raises `UsageError` naming the nearest."""
        ids = sorted(p.parent.name for p in self.root.glob("*/identity.json"))
        found = [name] if name in ids else [i for i in ids if i.startswith(name)]
        if len(found) > 1:
            raise UsageError(f"{len(found)} runs begin with '{name}': {', '.join(found[:5])} ...; give more of the id")
        if not found:
            near = difflib.get_close_matches(name, ids, n=1, cutoff=NEAR)
            hint = f"did you mean '{near[0]}'? " if near else ""
            raise UsageError(f"unknown run '{name}' in {self.root}: {hint}`garmentbench runs` lists them")
        return self._read(found[0])

    def list(self, filters: dict[str, str] | None = None) -> list[Run]:
        """Runs that match all filters, oldest first.

        A filter is a key of `Run.flat` ("identity.config.method") or its end ("method"), and its value as text.
        """
        runs = [self._read(p.parent.name) for p in self.root.glob("*/identity.json")]
        wanted = (filters or {}).items()
        matching = [run for run in runs if all(_matches(flat(run), key, value) for key, value in wanted)]
        return sorted(matching, key=lambda run: (run.times["started"], run.id))

    def keys(self) -> set[str]:
        """What runs can be filtered by: the keys of all that are there, and the parts of them after a dot."""
        keys = {key for run in self.list() for key in flat(run)}
        return {key.split(".", cut)[-1] for key in keys for cut in range(key.count(".") + 1)}

    def _read(self, name: str) -> Run:
        noted = _read_json(self.root / name / "identity.json")
        if noted is None:
            raise UserError(f"{self.root / name / 'identity.json'}: damaged; remove the folder {self.root / name}")
        return Run(self, noted["kind"], noted["identity"])


def run_id(kind: str, identity: dict) -> str:
    """The id of a run: readable kind, then a hash of its identity (the order of keys doesn't matter)."""
    return f"{kind}-{content_hash(identity)}"


def flat(run: Run) -> dict[str, Any]:
    """A run as one level of dotted keys.

    Id, kind, state, seed, identity.*, and where finished results.*, times.* ...
    """
    top = {"id": run.id, "kind": run.kind, "state": run.state, "seed": run.seed, "identity": run.identity}
    return _flatten("", {**top, **(run.record or {})})


def _flatten(prefix: str, value: Any) -> dict[str, Any]:
    if not isinstance(value, dict):
        return {prefix: value}
    out: dict[str, Any] = {}
    for key, inner in value.items():
        out |= _flatten(f"{prefix}.{key}" if prefix else key, inner)
    return out


def _matches(values: dict[str, Any], key: str, wanted: str) -> bool:
    return any(str(v) == wanted for k, v in values.items() if k == key or k.endswith(f".{key}"))


def _read_json(path: Path) -> dict | None:
    """A JSON object; None where the file is missing or not whole."""
    try:
        value = json.loads(path.read_text())
    except (FileNotFoundError, json.JSONDecodeError, UnicodeDecodeError):
        return None
    return value if isinstance(value, dict) else None


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
