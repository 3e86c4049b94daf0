"""Ridge regression in closed form, from moments that are gathered once."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

STRENGTHS = tuple(10.0 ** np.arange(-6, 1))  # of the ridge, relative to the largest variance among the inputs
TOLERANCE = 1.05  # the strongest ridge whose held-out error is within this factor of the least is taken


@dataclass(frozen=True)
class Moments:
    """All that ridge regression asks of samples. x, y: means, shapes (P,), (K,). gram: (P, P). cross: (P, K)."""

    x: np.ndarray
    y: np.ndarray
    gram: np.ndarray
    cross: np.ndarray

    @classmethod
    def of(cls, inputs: np.ndarray, targets: np.ndarray) -> "Moments":
        """Of inputs, shape (N, P), and targets, shape (N, K)."""
        x, y = inputs.mean(axis=0), targets.mean(axis=0)
        centred = inputs - x
        return cls(x, y, centred.T @ centred, centred.T @ (targets - y))

    def largest(self, part: slice = slice(None)) -> float:
        """The largest variance among some inputs, times the number of samples; 0 where there are none."""
        return float(np.diag(self.gram)[part].max(initial=0.0))

    def solve(self, weight: np.ndarray | float) -> np.ndarray:
        """The affine map from inputs to targets, shape (P + 1, K), its last row the constant.

        weight: The ridge on each input, in the units of the Gram matrix, shape (P,).
        """
        linear = np.linalg.solve(self.gram + np.diag(np.broadcast_to(weight, len(self.x))), self.cross)
        return np.concatenate([linear, (self.y - self.x @ linear)[None]])


S = TypeVar("S", float, tuple[float, ...])


def strongest(error: Mapping[S, float]) -> S:
    """The strength, or strengths, to take, of the held-out error by strength: of those that err about the least the
    strongest."""
    near_best = [s for s, e in error.items() if e <= TOLERANCE * min(error.values())]
    return max(near_best, key=lambda s: float(np.prod(s)))
