"""Linear dynamics in a PCA subspace, in closed form: seconds to fit, and the baseline to beat.

The garment is taken back to the canonical pose; its displacements from the rest shape become codes in a PCA basis. A
ridge regression predicts a frame's code from the two before it and from the body: seed points now and in the three
frames before, as the upright root sees them, as PCA codes too. On an object "back" means from that root, since cloth
hangs down however the object has rolled.

In the manner of Holden et al. 2019, "Subspace Neural Physics", with a linear map in place of their network.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from garmentbench.geometry.blend_skinning import Skin, SkinOf, place
from garmentbench.geometry.seed_features import seed_features
from garmentbench.method import HISTORY, BodyFrame, FitRun, History, span
from garmentbench.methods.baselines.ridge_dynamics import Subspace, advance, fit_dynamics
from garmentbench.sequence import Sequence, Template


@dataclass(frozen=True)
class Config:
    """seeds: The largest number of seed points. codes, body_codes: Sizes of the garment's and the body's subspace."""

    seeds: int = 200
    codes: int = 64
    body_codes: int = 64


@dataclass(frozen=True)
class State:
    """skin: carries the garment. bodies: the last three [m], (3, B, 3), or None. last, before: the last two codes."""

    skin: Skin
    bodies: np.ndarray | None
    last: np.ndarray
    before: np.ndarray


class LinearSubspace:
    """Ridge regression of PCA codes on their two predecessors and the seed points."""

    name = "linear_subspace"
    random = False
    Config = Config

    def __init__(self, seeds: np.ndarray, garment: Subspace, body: Subspace, dynamics: np.ndarray) -> None:
        """seeds: body vertices, shape (N,). dynamics: as `fit_dynamics` gives it."""
        self.seeds, self.garment, self.body, self.dynamics = seeds, garment, body, dynamics
        self.skin_of = SkinOf(seeds, upright_objects=True)

    @classmethod
    def fit(cls, train: tuple[Sequence, ...], config: Config, run: FitRun) -> "LinearSubspace":
        """Closed form; nothing is random. All bodies have the seeds that were chosen on the first."""
        skin = Skin.of(train[0].template, config.seeds, upright_objects=True)
        seeds = np.zeros(0, np.int64) if skin.seeds is None else skin.seeds.vertices
        recorded = [_recorded(sequence, seeds) for sequence in train]
        garment = Subspace.of(np.concatenate([shapes for shapes, _ in recorded]), config.codes)
        body = Subspace.of(np.concatenate([inputs for _, inputs in recorded]), config.body_codes)
        dynamics = fit_dynamics([(garment.encode(z[HISTORY:]), body.encode(f)) for z, f in recorded])
        return cls(seeds, garment, body, dynamics)

    def save(self, folder: Path) -> None:
        """Write the fitted arrays."""
        subspaces = {f"{n}_{k}": getattr(getattr(self, n), k) for n in ("garment", "body") for k in ("mean", "basis")}
        np.savez(folder / "linear_subspace.npz", seeds=self.seeds, dynamics=self.dynamics, **subspaces)

    @classmethod
    def load(cls, folder: Path) -> "LinearSubspace":
        """Read them back."""
        with np.load(folder / "linear_subspace.npz", allow_pickle=False) as d:
            garment, body = (Subspace(d[f"{n}_mean"], d[f"{n}_basis"]) for n in ("garment", "body"))
            return cls(d["seeds"], garment, body, d["dynamics"])

    def begin(self, template: Template, history: History) -> State:
        """Encode the last two garments."""
        skin = self.skin_of(template)
        shapes = skin.displacement(history.bodies, history.garments).reshape(HISTORY, -1)
        _, before, last = self.garment.encode(shapes)
        return State(skin, history.bodies, last, before)

    def step(self, state: State, body: BodyFrame) -> tuple[np.ndarray, State]:
        """The next code, decoded and carried to the present pose [m], shape (V, 3)."""
        with span("prepare"):
            maps = state.skin.blend(body.vertices)
            bodies = None
            if state.bodies is not None and body.vertices is not None:
                bodies = np.concatenate([state.bodies, body.vertices[None]])
            inputs = self.body.encode(seed_features(state.skin.seeds, bodies))
        code = advance(self.dynamics, state.last, state.before, inputs)
        garment = place(maps, state.skin.rest + self.garment.decode(code).reshape(-1, 3)).astype(np.float32)
        return garment, replace(state, bodies=None if bodies is None else bodies[1:], last=code, before=state.last)


def _recorded(sequence: Sequence, seeds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A sequence's canonical displacements [m], shape (T, 3 V), and its seed features from the fourth frame on, shape
    (T - 3, D)."""
    skin = Skin.of(sequence.template, seeds, upright_objects=True)
    shapes = skin.displacement(sequence.body, sequence.garment)
    windows = [slice(t - HISTORY, t + 1) for t in range(HISTORY, len(sequence))]
    inputs = [seed_features(skin.seeds, None if sequence.body is None else sequence.body[w]) for w in windows]
    return shapes.reshape(len(sequence), -1), np.array(inputs)
