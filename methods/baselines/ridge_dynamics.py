"""Linear dynamics of codes, z_t = A [z_t-1, z_t-2] + B f_t + c, by ridge regression in closed form."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from garmentbench.errors import UserError
from garmentbench.method import HISTORY

STRENGTHS = tuple(10.0 ** np.arange(-6, 1))  # of the ridge, relative to the largest variance among the inputs
_HELD_OUT = 0.25  # of the frames, the last ones
_TOLERANCE = 1.05  # the strongest ridge whose held-out error is within this factor of the least is taken


@dataclass(frozen=True)
class Subspace:
    """A PCA basis. mean: shape (D,). basis: orthonormal rows, shape (K, D)."""

    mean: np.ndarray
    basis: np.ndarray

    @classmethod
    def of(cls, samples: np.ndarray, count: int) -> "Subspace":
        """The first `count` principal components of samples, shape (T, D)."""
        mean = samples.mean(axis=0)
        return cls(mean, np.linalg.svd(samples - mean, full_matrices=False)[2][:count])

    def encode(self, samples: np.ndarray) -> np.ndarray:
        """Codes, shape (..., K), of samples, shape (..., D)."""
        return (samples - self.mean) @ self.basis.T

    def decode(self, codes: np.ndarray) -> np.ndarray:
        """Samples, shape (..., D), of codes, shape (..., K)."""
        return self.mean + codes @ self.basis


Recording = tuple[np.ndarray, np.ndarray]  # codes, shape (T, K), and the input of each frame, shape (T, Q)


def fit_dynamics(recordings: list[Recording]) -> np.ndarray:
    """The map from [z_t-1, z_t-2, f_t, 1] to z_t, shape (2 K + Q + 1, K), from one or more recordings.

    How strongly A and B are held small is chosen by free roll-outs over the last quarter of each recording, after a fit
    to the rest; strengths that let the dynamics grow (spectral radius of A at least 1) are left out. The map is then
    fitted to all. Raises `UserError` where no strength is left, or where the recordings are too short.
    """
    cuts = [int(len(z) * (1 - _HELD_OUT)) for z, _ in recordings]
    if min(cuts) < 3:
        shortest = HISTORY + min(len(z) for z, _ in recordings)
        raise UserError(f"linear_subspace: a training sequence has {shortest} frames; wanted at least {HISTORY + 4}")
    earlier = transitions([(z[:cut], f[:cut]) for (z, f), cut in zip(recordings, cuts, strict=True)])
    complete = transitions(recordings)
    error = {}
    for strengths in product(STRENGTHS, STRENGTHS):
        part, whole = _ridge(*earlier, *strengths), _ridge(*complete, *strengths)
        if max(_spectral_radius(part), _spectral_radius(whole)) < 1:
            missed = [_roll_out(part, z, f, cut) - z[cut:] for (z, f), cut in zip(recordings, cuts, strict=True)]
            error[strengths] = np.linalg.norm(np.concatenate(missed), axis=1).mean()
    if not error:
        raise UserError("linear_subspace: the fitted motion grows without bound; train on a longer or calmer sequence")
    near_best = [s for s, e in error.items() if e <= _TOLERANCE * min(error.values())]
    return _ridge(*complete, *max(near_best, key=lambda s: s[0] * s[1]))


def transitions(recordings: list[Recording]) -> Recording:
    """Inputs [z_t-1, z_t-2, f_t], shape (N, 2 K + Q), and targets z_t, shape (N, K), of all steps within a
    recording."""
    inputs = [np.concatenate([z[1:-1], z[:-2], f[2:]], axis=1) for z, f in recordings]
    return np.concatenate(inputs), np.concatenate([z[2:] for z, _ in recordings])


def advance(dynamics: np.ndarray, last: np.ndarray, before: np.ndarray, f: np.ndarray) -> np.ndarray:
    """The next code, shape (K,), from the last one, the one before it, and the input."""
    return np.concatenate([last, before, f, [1.0]]) @ dynamics


def _ridge(inputs: np.ndarray, target: np.ndarray, on_codes: float, on_input: float) -> np.ndarray:
    """The map from `transitions`' inputs to their targets; the ridge's strengths on the two parts of the input."""
    x_mean, y_mean = inputs.mean(axis=0), target.mean(axis=0)
    x, y, split = inputs - x_mean, target - y_mean, 2 * target.shape[1]
    gram = x.T @ x
    scale = np.diag(gram)
    weight = np.full(len(gram), on_codes * scale[:split].max())
    weight[split:] = on_input * scale[split:].max(initial=0.0)
    linear = np.linalg.solve(gram + np.diag(weight), x.T @ y)
    return np.concatenate([linear, (y_mean - x_mean @ linear)[None]])


def _roll_out(dynamics: np.ndarray, z: np.ndarray, f: np.ndarray, start: int) -> np.ndarray:
    """Codes from `start` on, shape (T - start, K)."""
    codes = [z[start - 2], z[start - 1]]
    for inputs in f[start:]:
        codes.append(advance(dynamics, codes[-1], codes[-2], inputs))
    return np.array(codes[2:])


def _spectral_radius(dynamics: np.ndarray) -> float:
    """Of [z_t-1, z_t-2] -> [z_t, z_t-1]."""
    count = dynamics.shape[1]
    companion = np.zeros((2 * count, 2 * count))
    companion[:, :count] = dynamics[: 2 * count]
    companion[:count, count:] = np.eye(count)
    return float(np.abs(np.linalg.eigvals(companion)).max())
