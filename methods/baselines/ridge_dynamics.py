"""Linear dynamics of codes, z_t = A [z_t-1, z_t-2] + B f_t + c, by ridge regression in closed form."""

from itertools import product

import numpy as np

from garmentbench.errors import UserError
from garmentbench.method import HISTORY
from garmentbench.methods.baselines.held_out import folds
from garmentbench.methods.baselines.ridge import STRENGTHS, Moments, strongest

Recording = tuple[np.ndarray, np.ndarray]  # codes, shape (T, K), and the input of each frame, shape (T, Q)


def fit_dynamics(recordings: list[Recording]) -> np.ndarray:
    """The map from [z_t-1, z_t-2, f_t, 1] to z_t, shape (2 K + Q + 1, K), from one or more recordings.

    How strongly A and B are held small is chosen by free roll-outs over the last quarter of each recording, after a fit
    to the rest; strengths that let the dynamics grow (spectral radius of A at least 1) are left out. The map is then
    fitted to all. Chosen on kinds of motion that the fit leaves out, dynamics err more: on the pleated skirt's
    validation scenes 4.6 in place of 3.5 cm (dance) and 3.1 in place of 2.3 (walk).

    Raises `UserError` where no strength is left, or where the recordings are too short.
    """
    lengths = [len(z) for z, _ in recordings]
    (cuts,) = folds([""] * len(lengths), lengths)
    if min(cuts) < 3:
        raise UserError(
            f"linear_subspace: a training sequence has {HISTORY + min(lengths)} frames; wanted at least {HISTORY + 4}"
        )
    cut = [(z, f, at) for (z, f), at in zip(recordings, cuts, strict=True)]
    earlier = Moments.of(*transitions([(z[:at], f[:at]) for z, f, at in cut]))
    complete = Moments.of(*transitions(recordings))
    error: dict[tuple[float, ...], float] = {}
    for strengths in product(STRENGTHS, STRENGTHS):
        part, whole = _ridge(earlier, *strengths), _ridge(complete, *strengths)
        if max(_spectral_radius(part), _spectral_radius(whole)) < 1:
            missed = [_roll_out(part, z, f, at) - z[at:] for z, f, at in cut]
            error[strengths] = float(np.linalg.norm(np.concatenate(missed), axis=1).mean())
    if not error:
        raise UserError("linear_subspace: the fitted motion grows without bound; train on a longer or calmer sequence")
    return _ridge(complete, *strongest(error))


def transitions(recordings: list[Recording]) -> Recording:
    """Inputs [z_t-1, z_t-2, f_t], shape (N, 2 K + Q), and targets z_t, shape (N, K), of all steps within a
    recording."""
    inputs = [np.concatenate([z[1:-1], z[:-2], f[2:]], axis=1) for z, f in recordings]
    return np.concatenate(inputs), np.concatenate([z[2:] for z, _ in recordings])


def advance(dynamics: np.ndarray, last: np.ndarray, before: np.ndarray, f: np.ndarray) -> np.ndarray:
    """The next code, shape (K,), from the last one, the one before it, and the input."""
    return np.concatenate([last, before, f, [1.0]]) @ dynamics


def _ridge(moments: Moments, on_codes: float, on_input: float) -> np.ndarray:
    """The map from `transitions`' inputs to their targets; the ridge's strengths on the two parts of the input."""
    split = 2 * len(moments.y)
    weight = np.full(len(moments.x), on_codes * moments.largest(slice(split)))
    weight[split:] = on_input * moments.largest(slice(split, None))
    return moments.solve(weight)


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
