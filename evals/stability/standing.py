"""What the report knows of a line of the ladder: from results.csv, and of each start from its run."""

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from garmentbench.evals.stability.course import Rung
from garmentbench.evals.stability.rungs import PLAIN, RUNGS
from garmentbench.evals.stability.statistics import wilson
from garmentbench.report.lines import REFERENCE, Line

if TYPE_CHECKING:
    from garmentbench.report.lines import Results

NAMES = {REFERENCE: "simulator", "xpbd": "XPBD"}
ORDER = (REFERENCE, "xpbd", "skinning", "linear_subspace", "linear_memory", "tuned", "motion_guided")


@dataclass(frozen=True)
class Standing:
    """A method or simulator on a rung.

    Attributes:
        rung, line: Which, and its rows in results.csv.
        starts: How each start went, as its run keeps it; none where there is no run.
    """

    rung: Rung
    line: Line
    starts: list[dict[str, Any]] = field(default_factory=list)

    @property
    def label(self) -> str:
        """Its name for people."""
        return self.line.label

    @property
    def reference(self) -> bool:
        """Is it the reference solver's own line?"""
        return self.line.method == REFERENCE

    @property
    def count(self) -> int:
        """From how many starts it was climbed; 0 where it could not be."""
        return round(self.value("starts") or 0)

    @property
    def passed(self) -> int:
        """How many starts it passed."""
        return round(self.value("passed") or 0)

    @property
    def whole(self) -> bool:
        """Did it pass the rung: from every start?"""
        return 0 < self.count == self.passed

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval of the share of starts that it passes."""
        return wilson(self.passed, self.count)

    @property
    def first(self) -> dict[str, Any] | None:
        """The start that went bad first; None where none did."""
        bad = [start for start in self.starts if start["first_bad_frame"] is not None]
        return min(bad, key=lambda start: start["first_bad_frame"], default=None)

    def value(self, metric: str) -> float | None:
        """A value of results.csv; None where it has none."""
        found = self.line.value(metric)
        return None if found is None or not np.isfinite(found.mean) else found.mean


def standings(results: "Results", table: str) -> list[Standing]:
    """All lines of a ladder, rung by rung, the simulators first."""
    known, made = {rung.name: rung for rung in RUNGS}, []
    for line in results.lines(table):
        rung = known.setdefault(line.scene, Rung(name=line.scene, title=line.scene, group="others", course=PLAIN))
        kept = [results.record(run).get("results", {}) for run in line.run_ids]
        line = replace(line, label=NAMES.get(line.method, line.label))
        made.append(Standing(rung, line, [start for each in kept for start in each.get("starts", ())]))
    place = {name: i for i, name in enumerate(known)}
    methods = [*ORDER, *dict.fromkeys(standing.line.method for standing in made if standing.line.method not in ORDER)]
    return sorted(made, key=lambda standing: (place[standing.rung.name], methods.index(standing.line.method)))
