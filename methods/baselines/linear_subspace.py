"""Linear dynamics in a PCA subspace, in closed form: seconds to fit, and the baseline to beat.

The garment is taken back to the canonical pose; its displacements from the rest shape become codes in a PCA basis. A
ridge regression predicts a frame's code from the two before it and from the body: seed points now and in the three
frames before, as the upright root sees them, as PCA codes too. On an object "back" means from that root, since cloth
hangs down however the object has rolled.

In the manner of Holden et al. 2019, "Subspace Neural Physics", with a linear map in place of their network.
"""

from pathlib import Path

import numpy as np

from garmentbench.method import FitRun
from garmentbench.methods.baselines.code_dynamics import AGO, CodeDynamics
from garmentbench.methods.baselines.ridge_dynamics import advance, fit_dynamics
from garmentbench.methods.baselines.subspace import Encoded, Sizes, Subspace, load, save
from garmentbench.methods.novelty import Novelty
from garmentbench.sequence import Sequence

Memory = tuple[np.ndarray, np.ndarray]  # the last code and the one before it


class LinearSubspace(CodeDynamics):
    """Ridge regression of PCA codes on their two predecessors and the seed points."""

    name = "linear_subspace"
    random = False
    Config = Sizes

    def __init__(
        self, seeds: np.ndarray, garment: Subspace, body: Subspace, novelty: Novelty, dynamics: np.ndarray
    ) -> None:
        """seeds: body vertices, shape (N,). dynamics: as `fit_dynamics` gives it."""
        super().__init__(seeds, garment, body, novelty)
        self.dynamics = dynamics

    @classmethod
    def fit(cls, train: tuple[Sequence, ...], config: Sizes, run: FitRun) -> "LinearSubspace":
        """Closed form; nothing is random. All bodies have the seeds that were chosen on the first."""
        known = Encoded.of(train, config, AGO)
        return cls(known.seeds, known.garment, known.body, known.novelty, fit_dynamics(known.recordings))

    def save(self, folder: Path) -> None:
        """Write the fitted arrays."""
        further = {"seeds": self.seeds, "dynamics": self.dynamics}
        save(folder / "linear_subspace.npz", self.garment, self.body, self.novelty, **further)

    @classmethod
    def load(cls, folder: Path) -> "LinearSubspace":
        """Read them back."""
        return cls(**load(folder / "linear_subspace.npz"))

    def following(self, memory: Memory, seen: np.ndarray) -> tuple[np.ndarray, Memory]:
        """The next code, shape (K,), by the linear map."""
        last, before = memory
        code = advance(self.dynamics, last, before, seen)
        return code, (code, last)
