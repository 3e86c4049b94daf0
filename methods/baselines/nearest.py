"""Nearest frames: what the garment did in the training frames whose last half second of poses was most like this one.

    z_t = sum_k w_k z_k,    w_k ~ 1 / d_k^2,    d_k: distance of frame k's poses from the present ones [m]

of the `count` nearest frames of all recordings. Nothing is fitted but the two subspaces: it says what memory alone is
worth, and costs, since every frame looks through all of the training. Poses are seen as `static_ridge` sees them.
"""

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from garmentbench.geometry.blend_skinning import SkinOf, place
from garmentbench.method import BodyFrame, FitRun, History, span
from garmentbench.methods.baselines.static_ridge import State, looked_at
from garmentbench.methods.baselines.subspace import Encoded, Sizes, Subspace, features, load, save
from garmentbench.methods.novelty import Novelty
from garmentbench.sequence import Sequence, Template

_SAME = 1e-9  # [m^2] a pose that was trained on gives its own frame


@dataclass(frozen=True)
class Config(Sizes):
    """count: Frames that are blended, at most."""

    count: int = 4


class Nearest:
    """The training frames nearest in their recent poses, blended."""

    name = "nearest"
    random = False
    Config = Config

    def __init__(
        self, seeds: np.ndarray, garment: Subspace, body: Subspace, novelty: Novelty, **frames: np.ndarray
    ) -> None:
        """seeds: body vertices, shape (N,). frames: codes (T, K), poses (T, Q) of the training; count, ()."""
        self.seeds, self.garment, self.body, self.novelty = seeds, garment, body, novelty
        self.codes, self.poses, self.count = frames["codes"], frames["poses"], int(frames["count"])
        self.skin_of = SkinOf(seeds, upright_objects=True)

    @classmethod
    def fit(cls, train: tuple[Sequence, ...], config: Config, run: FitRun) -> "Nearest":
        """Keep the training frames. All bodies have the seeds that were chosen on the first."""
        known = Encoded.of(train, config, looked_at(train[0].template.fps))
        codes, poses = (np.concatenate(column) for column in zip(*known.recordings, strict=True))
        frames = {"codes": codes, "poses": poses, "count": np.array(min(config.count, len(poses)))}
        return cls(known.seeds, known.garment, known.body, known.novelty, **frames)

    def save(self, folder: Path) -> None:
        """Write the frames."""
        frames = {"codes": self.codes, "poses": self.poses, "count": np.array(self.count)}
        save(folder / "nearest.npz", self.garment, self.body, self.novelty, seeds=self.seeds, **frames)

    @classmethod
    def load(cls, folder: Path) -> "Nearest":
        """Read them back."""
        return cls(**load(folder / "nearest.npz"))

    def begin(self, template: Template, history: History) -> State:
        """Remember the bodies; the garments are not looked at."""
        return State(self.skin_of(template), looked_at(template.fps), history.bodies)

    def step(self, state: State, body: BodyFrame) -> tuple[np.ndarray, State]:
        """The blend of the nearest frames, carried to the present pose [m], shape (V, 3)."""
        with span("prepare"):
            maps = state.skin.blend(body.vertices)
            bodies = None
            if state.bodies is not None and body.vertices is not None:
                bodies = np.concatenate([state.bodies[-max(state.ago[0], 1) :], body.vertices[None]])
            seen = self.body.encode(features(state.skin, bodies, state.ago))
        code = self.blended(seen)
        garment = place(maps, state.skin.rest + self.garment.decode(code).reshape(-1, 3))
        return garment.astype(np.float32), replace(state, bodies=bodies, look=partial(self.novelty, seen, code))

    def blended(self, seen: np.ndarray) -> np.ndarray:
        """The garment's code, shape (K,), of poses' code, shape (Q,)."""
        squares = np.square(self.poses - seen).sum(axis=1)
        near = np.argpartition(squares, self.count - 1)[: self.count]
        weights = 1 / np.maximum(squares[near], _SAME)
        return weights @ self.codes[near] / weights.sum()
