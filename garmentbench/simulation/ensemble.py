"""The runs of an ensemble: the same scene again, changed in what should not matter.

Loose cloth is chaotic: a fold falls to the left or to the right, and a push of a millimetre decides which. A single run
can't be the truth for it. How far runs are apart that differ by nothing that matters says what a prediction can be held
to at all, as in weather forecasting.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from garmentbench.metrics.l2 import l2
from garmentbench.metrics.push_growth import CHAOTIC_ABOVE, push_growth
from garmentbench.metrics.spread import finite_runs, spread
from garmentbench.scenes.material import Settings
from garmentbench.sequence import Sequence

RUNS = 4  # of a test scene: the run itself, two pushed ones, one with a finer step
PUSH = 1e-3  # [m]
WAVELENGTH = 0.2  # [m] so the push strains the cloth by 3 % at most, whatever its mesh


@dataclass(frozen=True)
class Member:
    """A run of an ensemble.

    Attributes:
        name: What is changed: "first" (nothing), "pushed_warm_up", "pushed_frame_0", "finer".
        push: How far every vertex is pushed [m].
        seed: Of the push.
        after_warm_up: Pushed at frame 0, the first after the warm-up; else before the warm-up.
        finer: Times as many substeps and queries.
    """

    name: str
    push: float = 0.0
    seed: int = 0
    after_warm_up: bool = False
    finer: int = 1

    def settings(self, settings: Settings) -> Settings:
        """A layer's settings in this run."""
        return replace(
            settings,
            substep_factor=self.finer * settings.substep_factor,
            queries=self.finer * settings.queries,
        )

    def push_at(self, warm_up: int) -> "Push | None":
        """The push, of a simulation that begins with `warm_up` frames; None where nothing is pushed."""
        return Push(warm_up if self.after_warm_up else 0, self.push, self.seed) if self.push else None


@dataclass(frozen=True)
class Push:
    """All particles moved by one distance, each a little otherwise than its neighbours, without a change of speed.

    Attributes:
        frame: When, counted from the start of the simulation.
        distance: How far [m].
        seed: Another seed, another push.
    """

    frame: int
    distance: float
    seed: int = 0

    def offsets(
        self, positions: Float[np.ndarray, "particles 3"], pinned: Bool[np.ndarray, " particles"]
    ) -> Float[np.ndarray, "particles 3"]:
        """The way of each particle [m], shape (P, 3), from its position [m], shape (P, 3).

        The direction turns with the place, once in `WAVELENGTH`. So layers of cloth that lie on each other are pushed
        the same way and not through each other, and a finer mesh is pushed as the coarse one. Pinned particles, shape
        (P,), stay: they would be held elsewhere for ever, and the scene would be another.
        """
        rng = np.random.default_rng(self.seed)
        along, *across = np.linalg.qr(rng.standard_normal((3, 3)))[0]
        turn = 2 * np.pi * (positions @ along / WAVELENGTH + rng.random())
        ways = self.distance * (np.cos(turn)[:, None] * across[0] + np.sin(turn)[:, None] * across[1])
        return np.where(pinned[:, None], 0.0, ways)


FIRST = Member("first")


def members(runs: int) -> tuple[Member, ...]:
    """The members of an ensemble: the run itself, one pushed by 1 mm before the warm-up, one at frame 0, one with twice
    the substeps and queries, and then pushed ones with other seeds."""
    found = [FIRST, *_pushed(0), Member("finer", finer=2)]
    seed = 1
    while len(found) < runs:
        found += _pushed(seed)
        seed += 1
    return tuple(found[:runs])


def _pushed(seed: int) -> tuple[Member, Member]:
    return Member("pushed_warm_up", PUSH, seed), Member("pushed_frame_0", PUSH, seed, after_warm_up=True)


def summary(sequence: Sequence) -> dict[str, float | bool | None]:
    """What the runs of a sequence say of it; to be kept in its info, since it needs all of its frames.

    Returns:
        `spread_cm` (what another run errs by), `pushed_cm` and `finer_cm` (how far the pushed runs and the one with
        the finer step are from the first), `push_growth` (what became of the push) and `chaotic` (did it grow); None
        where no run, or not all of its frames, can say so.
    """
    runs = [] if sequence.runs is None else list(sequence.runs)
    changes = [run["name"] for run in sequence.info["runs"]]
    pushed = [run for run, name in zip(runs, changes, strict=True) if name.startswith("pushed")]
    finer = [run for run, name in zip(runs, changes, strict=True) if name == "finer"]
    growth = push_growth(sequence.garment, pushed, PUSH)
    found = {
        "spread_cm": spread([sequence.garment, *runs]),
        "pushed_cm": _apart(sequence.garment, pushed),
        "finer_cm": _apart(sequence.garment, finer),
        "push_growth": growth,
    }
    told: dict[str, float | bool | None] = {k: float(v) if np.isfinite(v) else None for k, v in found.items()}
    return told | {"chaotic": bool(growth > CHAOTIC_ABOVE) if np.isfinite(growth) else None}


def _apart(first: np.ndarray, runs: list[np.ndarray]) -> float:
    """Mean distance of runs from the first [cm], those that are not finite left out; NaN where none is."""
    apart = [l2(run, first) for run in finite_runs(runs)]
    return float(np.mean(apart)) if apart else math.nan
