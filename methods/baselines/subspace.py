"""What the baselines in a subspace share: how they see garment and body."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from garmentbench.geometry.blend_skinning import Skin
from garmentbench.geometry.seed_features import seed_features, seed_turns
from garmentbench.method import HISTORY
from garmentbench.methods.baselines.held_out import kind
from garmentbench.methods.novelty import Novelty
from garmentbench.sequence import Sequence

_EXACT = 1000  # samples or dimensions up to which the components are found by a full decomposition
_SPARE, _PASSES = 24, 8  # of the randomised one: further directions, and passes over the samples


@dataclass(frozen=True)
class Subspace:
    """A PCA basis. mean: shape (D,). basis: orthonormal rows, shape (K, D)."""

    mean: np.ndarray
    basis: np.ndarray

    @classmethod
    def of(cls, samples: np.ndarray, count: int) -> "Subspace":
        """The first `count` principal components of samples, shape (T, D).

        Of thousands of samples in thousands of dimensions by a randomised decomposition (Halko et al. 2011) with a
        fixed seed: seconds in place of minutes.
        """
        mean = samples.mean(axis=0)
        centred = samples - mean
        if min(samples.shape) > _EXACT:
            drawn = np.random.default_rng(0).normal(size=(samples.shape[1], count + _SPARE)).astype(samples.dtype)
            for _ in range(_PASSES):
                drawn = np.linalg.qr(centred.T @ (centred @ drawn))[0]
            centred = centred @ drawn
            return cls(mean, (np.linalg.svd(centred, full_matrices=False)[2] @ drawn.T)[:count])
        return cls(mean, np.linalg.svd(centred, full_matrices=False)[2][:count])

    def encode(self, samples: np.ndarray) -> np.ndarray:
        """Codes, shape (..., K), of samples, shape (..., D)."""
        return (samples - self.mean) @ self.basis.T

    def decode(self, codes: np.ndarray) -> np.ndarray:
        """Samples, shape (..., D), of codes, shape (..., K)."""
        return self.mean + codes @ self.basis


@dataclass(frozen=True)
class Sizes:
    """seeds: The largest number of seed points. codes, body_codes: Sizes of the garment's and the body's subspace.
    turns: How the seeds are turned is told beside where they are."""

    seeds: int = 200
    codes: int = 64
    body_codes: int = 64
    turns: bool = False


@dataclass(frozen=True)
class Encoded:
    """What is learnt from: the subspaces of sequences, and the sequences in them.

    Attributes:
        seeds: Body vertices that a body is seen by, shape (N,), the same on all bodies; none where there is no body.
        garment, body: The subspaces.
        recordings: Of each sequence from the fourth frame on the codes of the garment, shape (T - 3, K), and of the
            body, shape (T - 3, Q).
        kinds: Of each sequence's motion.
        novelty: How far others are from them.
    """

    seeds: np.ndarray
    garment: Subspace
    body: Subspace
    recordings: list[tuple[np.ndarray, np.ndarray]]
    kinds: list[str]
    novelty: Novelty

    @classmethod
    def of(cls, train: tuple[Sequence, ...], sizes: Sizes, ago: tuple[int, ...]) -> "Encoded":
        """Of training sequences; ago as for `features`. Seeds are chosen on the first body."""
        skin = Skin.of(train[0].template, sizes.seeds, upright_objects=True)
        seeds = np.zeros(0, np.int64) if skin.seeds is None else skin.seeds.vertices
        known = [recorded(sequence, seeds, ago, sizes.turns) for sequence in train]
        garment = Subspace.of(np.concatenate([shapes for shapes, _ in known]), sizes.codes)
        body = Subspace.of(np.concatenate([seen for _, seen in known]), sizes.body_codes)
        recordings = [(garment.encode(shapes[HISTORY:]), body.encode(seen)) for shapes, seen in known]
        codes, bodies = (np.concatenate(column) for column in zip(*recordings, strict=True))
        novelty = Novelty.of(bodies, codes, [len(z) for z, _ in recordings])
        return cls(seeds, garment, body, recordings, [kind(sequence) for sequence in train], novelty)


_PARTS = {"garment": Subspace, "body": Subspace, "novelty": Novelty}


def save(path: Path, garment: Subspace, body: Subspace, novelty: Novelty, **arrays: np.ndarray) -> None:
    """Write the subspaces of garment and body, what is known, and further arrays, as an .npz file."""
    parts = {"garment": garment, "body": body, "novelty": novelty}
    written: dict[str, Any] = {f"{name}_{key}": v for name, part in parts.items() for key, v in vars(part).items()}
    written |= arrays
    np.savez(path, **written)


def load(path: Path) -> dict[str, Any]:
    """Read what `save` wrote, by the names of its arguments."""
    with np.load(path, allow_pickle=False) as file:
        arrays: dict[str, Any] = dict(file)
    parts = {
        name: kind(*(arrays.pop(f"{name}_{field.name}") for field in fields(kind))) for name, kind in _PARTS.items()
    }
    return parts | arrays


def recorded(
    sequence: Sequence, seeds: Int[np.ndarray, " seeds"], ago: tuple[int, ...], turns: bool = False
) -> tuple[Float[np.ndarray, "frames coordinates"], Float[np.ndarray, "predicted features"]]:
    """What a sequence teaches: canonical displacements [m], shape (T, 3 V), and from the fourth frame on the body's
    features, shape (T - 3, D).

    Args:
        sequence: The recording.
        seeds: Body vertices that the body is seen by, shape (N,).
        ago: How many frames before the present one the body is looked at, the present one (0) last.
        turns: See `Sizes`.
    """
    skin = Skin.of(sequence.template, seeds, upright_objects=True)
    shapes = skin.displacement(sequence.body, sequence.garment)
    frames = range(HISTORY, len(sequence))
    bodies = [None if sequence.body is None else sequence.body[: t + 1] for t in frames]
    return shapes.reshape(len(sequence), -1), np.array([features(skin, b, ago, turns) for b in bodies])


def features(
    skin: Skin, bodies: Float[np.ndarray, "frames body 3"] | None, ago: tuple[int, ...], turns: bool = False
) -> Float[np.ndarray, " features"]:
    """What is seen of the body in the last of some frames, shape (D,): see `seed_features`, and with `turns`
    `seed_turns` of the last. Before the first of them the body is taken to have stood there."""
    if bodies is None:
        return seed_features(skin.seeds, None)
    places = seed_features(skin.seeds, bodies[[max(len(bodies) - 1 - k, 0) for k in ago]])
    return np.concatenate([places, seed_turns(skin.seeds, bodies[-1])]) if turns else places
