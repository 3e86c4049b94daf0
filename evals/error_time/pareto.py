"""Which points are worth having, and what the simulator takes for the same error."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

SIMULATOR = "simulator"


@dataclass(frozen=True)
class Point:
    """A method or the simulator at one setting, on one scene.

    Attributes:
        label: Its name for people.
        method: Whose setting it is.
        error, interval: Mean distance to the runs of the reference [cm], and half the 95 % confidence interval over
            seeds; None where there is one seed.
        ms: The time a frame by which it is compared [ms].
        wall_ms, p95: Wall time a frame [ms], median and 95th percentile.
        processor_ms: The processor's [ms].
        minutes: Of training; NaN for what isn't trained.
        spread: What another run of the simulator errs by [cm].
        ending: How it ended where that is not well, or what must be known of it; such a point doesn't compete.
        loaded: It was timed under load.
    """

    label: str
    method: str
    error: float
    interval: float | None
    ms: float
    wall_ms: float
    p95: float
    processor_ms: float
    minutes: float
    spread: float
    ending: str = ""
    loaded: bool = False

    @property
    def competes(self) -> bool:
        """Did it end well, with an error and a time?"""
        return not self.ending and math.isfinite(self.error) and math.isfinite(self.ms)

    @property
    def floored(self) -> float:
        """Its error, or the spread where that is more: below it errors can't be told apart."""
        return max(self.error, self.spread) if math.isfinite(self.spread) else self.error

    @property
    def of_simulator(self) -> bool:
        """Is it the simulator's?"""
        return self.method == SIMULATOR


def comparable(points: Sequence[Point]) -> list[Point]:
    """The points by one clock: by the processor's where any of them was timed under load, else as they are."""
    loaded = any(p.loaded for p in points)
    return [replace(p, ms=p.processor_ms) for p in points] if loaded else list(points)


def dominated_by(point: Point, points: Sequence[Point]) -> Point | None:
    """A point that is no slower and errs no more, and is better in one of the two: the one that errs least. None where
    there is none, or the point itself does not compete."""
    better = [
        p
        for p in points
        if p.competes
        and p.ms <= point.ms
        and p.floored <= point.floored
        and (p.ms < point.ms or p.floored < point.floored)
    ]
    return min(better, key=lambda p: (p.floored, p.ms)) if point.competes and better else None


def front(points: Sequence[Point]) -> list[Point]:
    """The points that nothing dominates, the cheapest first."""
    return sorted((p for p in points if p.competes and dominated_by(p, points) is None), key=lambda p: p.ms)


@dataclass(frozen=True)
class Needed:
    """What the simulator needs for an error.

    Attributes:
        ms: Time a frame [ms]; where `how` is "cheapest" it needs no more than that; infinite where it is "never".
        how: "between" two points of its front, "cheapest" (its cheapest point is as good already), or "never" (no
            budget that was tried gets there).
    """

    ms: float
    how: str


def needed(error: float, simulated: Sequence[Point]) -> Needed:
    """Time that the simulator takes for an error [cm]: on its front the logarithm of the time is linear in the error
    between neighbouring points. simulated: its front, the cheapest first, at least one."""
    if simulated[0].floored <= error:
        return Needed(simulated[0].ms, "cheapest")
    if simulated[-1].floored > error:
        return Needed(math.inf, "never")
    errors, logs = [p.floored for p in simulated], [math.log(p.ms) for p in simulated]
    return Needed(float(np.exp(np.interp(-error, [-e for e in errors], logs))), "between")


def exponent(vertices: Sequence[float], ms: Sequence[float]) -> float:
    """The power of the number of vertices by which a time grows: least squares of logarithms; NaN for fewer than two
    meshes."""
    known = [(v, t) for v, t in zip(vertices, ms, strict=True) if t > 0 and math.isfinite(t)]
    if len({v for v, _ in known}) < 2:
        return math.nan
    x, y = np.log(np.array(known)).T
    return float(np.polyfit(x, y, 1)[0])
