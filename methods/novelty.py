"""How far the present pose and garment are from all that a method was trained on: it knows when it does not know.

    d(p, z)^2 = |p - p_k|^2 / spread_p^2 + |z - z_k|^2 / spread_z^2,   of the training frame k that is nearest
    novelty = d / (that of the training frames themselves, 99th percentile)

p is the body as the method sees it and z the garment's code; a spread is the root mean square distance from the mean.
A training frame's own neighbours in time don't count as near to it. So 1 is as far as the farthest hundredth of the
training frames are from the others.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from jaxtyping import Float

NEIGHBOURS = 15  # frames before and after one, which are like it
KEPT = 4_000  # training frames that are compared with, at most
_PERCENTILE = 99
_BLOCK = 256


@dataclass(frozen=True, kw_only=True)
class Telling:
    """A state that tells the novelty of its frame.

    Attributes:
        look: What it is asked of; None before the first step, and where the training frames are not known.
    """

    look: Callable[[], float] | None = None

    @property
    def novelty(self) -> float | None:
        """Of the last frame. It is found when it is asked for, so that it adds nothing to a step's time."""
        return None if self.look is None else self.look()


@dataclass(frozen=True)
class Novelty:
    """What was trained on.

    Attributes:
        known: Body and garment of training frames, each in its spread, shape (T, P + Z), float32.
        spread: The two spreads, shape (2,).
        unit: The distance that is 1.
    """

    known: Float[np.ndarray, "frames features"]
    spread: Float[np.ndarray, "2"]
    unit: float

    @classmethod
    def of(
        cls, bodies: Float[np.ndarray, "frames body"], garments: Float[np.ndarray, "frames codes"], lengths: list[int]
    ) -> "Novelty":
        """Of training frames.

        Args:
            bodies: The body in each, shape (T, P).
            garments: The garment, shape (T, Z).
            lengths: Frames of each recording, which lie one after another.
        """
        spread = np.array([_spread(bodies), _spread(garments)])
        known = np.concatenate([bodies / spread[0], garments / spread[1]], axis=1).astype(np.float32)
        found = np.concatenate([_nearest(known, a, b) for a, b in pairwise(np.cumsum([0, *lengths]))])
        found = found[np.isfinite(found)]
        # Where all are neighbours in time it is not known how far apart they are, and nothing is said.
        unit = float(np.percentile(found, _PERCENTILE)) if len(found) else np.nan
        chosen = np.linspace(0, len(known) - 1, min(KEPT, len(known))).round().astype(int)
        return cls(known[chosen], spread, max(unit, 1e-9))

    def __call__(self, body: Float[np.ndarray, " body"], garment: Float[np.ndarray, " codes"]) -> float:
        """The novelty of a frame: of the body, shape (P,), and the garment's code, shape (Z,)."""
        here = np.concatenate([body / self.spread[0], garment / self.spread[1]]).astype(np.float32)
        return float(np.sqrt(np.square(self.known - here).sum(axis=1).min())) / self.unit

    def save(self, path: Path) -> None:
        """Write it as an .npz file."""
        np.savez(path, known=self.known, spread=self.spread, unit=self.unit)

    @classmethod
    def load(cls, path: Path) -> "Novelty":
        """Read it back."""
        with np.load(path, allow_pickle=False) as file:
            return cls(file["known"], file["spread"], float(file["unit"]))


def _spread(values: np.ndarray) -> float:
    return max(float(np.sqrt(values.var(axis=0).sum())), 1e-9)


def _nearest(known: np.ndarray, begin: int, end: int) -> np.ndarray:
    """The distance from each frame of a recording to the nearest of all that is not its neighbour in time."""
    squares, found = np.square(known).sum(axis=1), []
    for start in range(begin, end, _BLOCK):
        rows = np.arange(start, min(start + _BLOCK, end))
        distance = squares[rows, None] + squares - 2 * known[rows] @ known.T
        for k, row in enumerate(rows):
            distance[k, max(row - NEIGHBOURS, begin) : min(row + NEIGHBOURS + 1, end)] = np.inf
        found.append(np.sqrt(np.maximum(distance.min(axis=1), 0)))
    return np.concatenate(found) if found else np.zeros(0)
