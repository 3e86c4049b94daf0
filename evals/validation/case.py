"""What a validation case is: a problem with a known answer, and the simulator's own answer at several mesh sizes."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

Band = tuple[float, float]
EXCEEDS_ROUNDING = 1e-3  # of the tolerance: errors below say nothing about the order


@dataclass(frozen=True, kw_only=True)
class Case:
    """A problem with a known answer.

    Attributes:
        name: In results.csv.
        title: What is compared, for people.
        unit: Of the value.
        wanted: The exact value, from `exact`; or the band of measured values.
        simulate: The simulator's value, given one of `sizes`.
        sizes: From coarse to fine, by what they are called; a single one where the mesh has no part in it.
        tolerance: How far the value at the finest size may be off: in units, or a part of the exact value.
        relative: The tolerance is a part of the exact value.
        source: Where the wanted value comes from.
        fast: CI runs it as a test.
        cost: Rough seconds.
    """

    name: str
    title: str
    unit: str
    wanted: Callable[[], float | Band]
    simulate: Callable[[float], float]
    sizes: Mapping[str, float] = field(default_factory=lambda: {"": 0.0})
    tolerance: float = 0.0
    relative: bool = False
    source: str
    fast: bool = True
    cost: float = 2.0

    def band(self, wanted: float | Band) -> Band:
        """Within what the simulated value must lie."""
        if isinstance(wanted, tuple):
            return wanted
        room = self.tolerance * abs(wanted) if self.relative else self.tolerance
        return wanted - room, wanted + room

    def holds(self, wanted: float | Band, value: float) -> bool:
        """Does a simulated value pass? One that is not finite does not."""
        low, high = self.band(wanted)
        return math.isfinite(value) and low <= value <= high


def order(errors: list[float], sizes: list[float], tolerance: float) -> float:
    """Order of convergence from the errors at the two finest meshes, which `sizes` tell apart by their ratio.

    NaN where the error does not fall, or is so small a part of the tolerance that rounding decides.
    """
    if len(errors) < 2:
        return math.nan
    coarse, fine = abs(errors[-2]), abs(errors[-1])
    if not fine > EXCEEDS_ROUNDING * tolerance or not coarse > fine:
        return math.nan
    return math.log(coarse / fine) / abs(math.log(sizes[-2] / sizes[-1]))
