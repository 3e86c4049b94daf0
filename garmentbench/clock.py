"""Where a method's time goes: `prepare`, `predict`, `collide`. Wall time, batch 1, synchronised on a CUDA device."""

import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

PARTS = ("prepare", "predict", "collide")
_current: ContextVar["Clock | None"] = ContextVar("garmentbench_clock", default=None)


class Clock:
    """Milliseconds of each part of one step. Time outside any span counts as `predict`."""

    def __init__(self) -> None:
        self.ms: dict[str, float] = defaultdict(float)

    @contextmanager
    def running(self) -> Iterator[None]:
        """Time everything inside the block."""
        token, start = _current.set(self), _now()
        try:
            yield
        finally:
            total = 1e3 * (_now() - start)
            _current.reset(token)
            self.ms["predict"] += total - sum(self.ms.values())


@contextmanager
def span(part: str) -> Iterator[None]:
    """Count the block's time as `part` (one of `PARTS`) of the running clock; does nothing when none is running.

    Spans do not nest.
    """
    clock = _current.get()
    if clock is None:
        yield
        return
    start = _now()
    try:
        yield
    finally:
        clock.ms[part] += 1e3 * (_now() - start)


def _now() -> float:
    """Seconds, after all work queued on a CUDA device is done (torch is only asked if the method has loaded it)."""
    import sys

    torch = sys.modules.get("torch")
    if torch is not None and torch.cuda.is_initialized():
        torch.cuda.synchronize()
    return time.perf_counter()
