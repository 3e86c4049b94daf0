"""The pose alone: ridge regression from half a second of the body's poses to the garment, without any garment state.

What it can't predict takes dynamics. Seed points now and at seven moments of the last half second, as the present
upright root sees them, become PCA codes, and a linear map takes these to the garment's subspace, the same as
`linear_subspace`'s. The strength of the ridge is chosen on kinds of motion that are left out of the fit, where the
training has several, else on the last quarter of each sequence: the one that errs least. On kinds that it has seen this
costs a little: on the pleated skirt's validation scenes 3.34 and 2.27 cm (dance, walk) where the best of all strengths
has 3.16 and 2.13, and the strongest that errs about the least has 3.55 and 2.41.

A roll-out begins with three frames: until half a second has passed, the body is taken to have stood before them. So a
single step sees three poses, not sixteen: read its error in roll-outs.
"""

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from garmentbench.geometry.blend_skinning import Skin, SkinOf, place
from garmentbench.method import BodyFrame, FitRun, History, span
from garmentbench.methods.baselines.held_out import folds
from garmentbench.methods.baselines.ridge import STRENGTHS, Moments
from garmentbench.methods.baselines.subspace import Encoded, Sizes, Subspace, features, load, save
from garmentbench.methods.novelty import Novelty, Telling
from garmentbench.sequence import Sequence, Template

SECONDS = np.array([15, 12, 9, 6, 4, 2, 1, 0]) / 30  # before the present, at which the body is looked at


@dataclass(frozen=True)
class Config(Sizes):
    """As many codes of the body as half a second takes."""

    body_codes: int = 256


@dataclass(frozen=True)
class State(Telling):
    """skin: carries the garment. ago: frames to look back. bodies: the last half second [m], (H, B, 3), or None."""

    skin: Skin
    ago: tuple[int, ...]
    bodies: np.ndarray | None


class StaticRidge:
    """A linear map of the body's recent poses."""

    name = "static_ridge"
    random = False
    Config = Config

    def __init__(
        self, seeds: np.ndarray, garment: Subspace, body: Subspace, novelty: Novelty, linear: np.ndarray
    ) -> None:
        """seeds: body vertices, shape (N,). linear: from body codes and 1 to garment codes, shape (Q + 1, K)."""
        self.seeds, self.garment, self.body, self.novelty, self.linear = seeds, garment, body, novelty, linear
        self.skin_of = SkinOf(seeds, upright_objects=True)

    @classmethod
    def fit(cls, train: tuple[Sequence, ...], config: Config, run: FitRun) -> "StaticRidge":
        """Closed form; nothing is random. All bodies have the seeds that were chosen on the first."""
        known = Encoded.of(train, config, looked_at(train[0].template.fps))
        return cls(known.seeds, known.garment, known.body, known.novelty, fit_static(known.recordings, known.kinds))

    def save(self, folder: Path) -> None:
        """Write the fitted arrays."""
        further = {"seeds": self.seeds, "linear": self.linear}
        save(folder / "static_ridge.npz", self.garment, self.body, self.novelty, **further)

    @classmethod
    def load(cls, folder: Path) -> "StaticRidge":
        """Read them back."""
        return cls(**load(folder / "static_ridge.npz"))

    def begin(self, template: Template, history: History) -> State:
        """Remember the bodies; the garments are not looked at."""
        return State(self.skin_of(template), looked_at(template.fps), history.bodies)

    def step(self, state: State, body: BodyFrame) -> tuple[np.ndarray, State]:
        """The garment of these poses [m], shape (V, 3)."""
        with span("prepare"):
            maps = state.skin.blend(body.vertices)
            bodies = None
            if state.bodies is not None and body.vertices is not None:
                bodies = np.concatenate([state.bodies[-max(state.ago[0], 1) :], body.vertices[None]])
            seen = self.body.encode(features(state.skin, bodies, state.ago))
        code = np.append(seen, 1.0) @ self.linear
        garment = place(maps, state.skin.rest + self.garment.decode(code).reshape(-1, 3)).astype(np.float32)
        return garment, replace(state, bodies=bodies, look=partial(self.novelty, seen, code))


def looked_at(fps: float) -> tuple[int, ...]:
    """How many frames before the present one the body is looked at, at a frame rate."""
    return tuple(int(k) for k in np.round(SECONDS * fps))


def fit_static(recordings: list[tuple[np.ndarray, np.ndarray]], kinds: list[str]) -> np.ndarray:
    """The map from [f_t, 1] to z_t, shape (Q + 1, K), of recordings of codes, (T, K), and inputs, (T, Q)."""

    def joined(starts: list[int], stops: list[int]) -> tuple[np.ndarray, np.ndarray]:
        """Inputs and codes of a part of each recording."""
        parts = [(f[a:b], z[a:b]) for (z, f), a, b in zip(recordings, starts, stops, strict=True)]
        return np.concatenate([f for f, _ in parts]), np.concatenate([z for _, z in parts])

    none, lengths = [0] * len(recordings), [len(z) for z, _ in recordings]
    missed: dict[float, list[np.ndarray]] = {strength: [] for strength in STRENGTHS}
    for cuts in folds(kinds, lengths):
        moments, (seen, wanted) = Moments.of(*joined(none, cuts)), joined(cuts, lengths)
        for strength, misses in missed.items():
            linear = moments.solve(strength * moments.largest())
            misses.append(np.linalg.norm(seen @ linear[:-1] + linear[-1] - wanted, axis=1))
    least = min(STRENGTHS, key=lambda strength: np.concatenate(missed[strength]).mean())
    moments = Moments.of(*joined(none, lengths))
    return moments.solve(least * moments.largest())
