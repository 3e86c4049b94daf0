"""Ridge regression in a subspace: exact where the truth is linear, stable where it is not."""

import numpy as np
import pytest

from garmentbench.evaluation.rollout import roll_out
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.geometry.seed_features import seed_features
from garmentbench.geometry.seeds import select_seeds
from garmentbench.methods.baselines.linear_subspace import LinearSubspace
from garmentbench.methods.baselines.ridge import Moments
from garmentbench.methods.baselines.ridge_dynamics import _ridge, _spectral_radius, advance, fit_dynamics, transitions
from garmentbench.methods.baselines.subspace import Sizes, Subspace
from garmentbench.metrics.l2 import l2


def oscillator(frames, damping=0.97, noise=0.0, seed=0):
    """Two driven, damped oscillators: codes, shape (T, 2), and what drives them, shape (T, 3)."""
    rng = np.random.default_rng(seed)
    f = rng.normal(size=(frames, 3))
    z = np.zeros((frames, 2))
    drive = np.array([[0.1, 0.0], [0.0, 0.2], [0.05, -0.1]])
    for t in range(2, frames):
        z[t] = 2 * damping * np.cos([0.3, 0.7]) * z[t - 1] - damping**2 * z[t - 2] + f[t] @ drive + 0.02
    return z + noise * rng.normal(size=z.shape), f


def test_ridge_finds_linear_dynamics():
    z, f = oscillator(200)
    found = _ridge(Moments.of(*transitions([(z, f)])), 1e-12, 1e-12)
    expected = np.zeros((8, 2))
    expected[:2] = np.diag(2 * 0.97 * np.cos([0.3, 0.7]))
    expected[2:4] = -(0.97**2) * np.eye(2)
    expected[4:7] = [[0.1, 0.0], [0.0, 0.2], [0.05, -0.1]]
    expected[7] = 0.02
    np.testing.assert_allclose(found, expected, atol=1e-6)
    np.testing.assert_allclose(advance(found, z[9], z[8], f[10]), z[10], atol=1e-6)


def test_the_spectral_radius_is_that_of_the_recursion():
    z, f = oscillator(200, damping=0.9)
    assert _spectral_radius(_ridge(Moments.of(*transitions([(z, f)])), 1e-12, 1e-12)) == pytest.approx(0.9, abs=1e-6)


def test_dynamics_that_grow_are_left_out():
    z, f = oscillator(120, damping=1.01)
    assert _spectral_radius(_ridge(Moments.of(*transitions([(z, f)])), 1e-12, 1e-12)) > 1
    chosen = fit_dynamics([(z, f)])
    assert _spectral_radius(chosen) < 1


def test_noise_is_answered_with_a_stronger_ridge():
    clean, noisy = (np.linalg.norm(fit_dynamics([oscillator(150, noise=n)])[:-1]) for n in (0.0, 0.5))
    assert noisy < clean


def test_a_subspace_projects():
    rng = np.random.default_rng(0)
    samples = rng.normal(size=(30, 3)) @ rng.normal(size=(3, 10)) + rng.normal(size=10)
    whole, part = Subspace.of(samples, 3), Subspace.of(samples, 2)
    np.testing.assert_allclose(whole.decode(whole.encode(samples)), samples, atol=1e-10)
    np.testing.assert_allclose(part.basis @ part.basis.T, np.eye(2), atol=1e-12)
    residual = samples - part.decode(part.encode(samples))
    variances = np.linalg.svd(samples - samples.mean(axis=0))[1] ** 2
    assert np.sum(residual**2) == pytest.approx(variances[2])


def test_a_subspace_of_many_samples_is_that_of_few():
    """Beyond a thousand samples and dimensions it is found by drawing directions, and is the same."""
    rng = np.random.default_rng(1)
    low = rng.normal(size=(1100, 6)) * [9, 7, 5, 3, 2, 1]
    samples = low @ np.linalg.qr(rng.normal(size=(1050, 6)))[0].T + 1e-3 * rng.normal(size=(1100, 1050))
    drawn, mean = Subspace.of(samples, 6), samples.mean(axis=0)
    exact = np.linalg.svd(samples - mean, full_matrices=False)[2][:6]
    np.testing.assert_allclose(np.abs(drawn.basis @ exact.T), np.eye(6), atol=1e-5)
    np.testing.assert_array_equal(Subspace.of(samples, 6).basis, drawn.basis)


def test_features_see_how_the_body_moves_not_where_it_is():
    sequence = tiny_sequence(30)
    seeds = select_seeds(sequence.template, 30)
    bodies = sequence.body[10:14]
    moved = bodies @ np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]], np.float32) + np.float32([5, 6, 7])
    np.testing.assert_allclose(seed_features(seeds, moved), seed_features(seeds, bodies), atol=1e-5)
    assert np.abs(seed_features(seeds, sequence.body[11:15]) - seed_features(seeds, bodies)).max() > 1e-3
    at_rest = np.repeat(sequence.template.body.rest[None], 4, axis=0)
    np.testing.assert_allclose(seed_features(seeds, at_rest), 0, atol=1e-6)


@pytest.mark.parametrize("kind", ["human", "object"])
def test_a_swaying_tube_is_learnt_and_stays_stable(kind):
    train, test = tiny_sequence(150, kind), tiny_sequence(1150, kind, phase=2.0)
    roll = roll_out(LinearSubspace.fit((train,), Sizes(codes=16), None), test)
    assert roll.status == "ok"
    assert l2(roll.garment[3:], test.garment[3:]) < 0.05  # skinning has 1.3
    assert l2(roll.garment[-100:], test.garment[-100:]) < 0.05


def test_another_body_keeps_the_seeds_of_training():
    train = tiny_sequence(60)
    method = LinearSubspace.fit((train,), Sizes(), None)
    wide = tiny_sequence(20, phase=1.0)
    wide.body[:] += 0.02 * (wide.body - wide.body.mean(axis=1, keepdims=True))
    wide.template.body.rest[:] *= 1.02
    roll = roll_out(method, wide)
    assert roll.status == "ok" and l2(roll.garment[3:], wide.garment[3:]) < 1.0
