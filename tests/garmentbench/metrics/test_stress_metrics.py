"""Energy left and change, by hand."""

import numpy as np
import pytest

from garmentbench.metrics.change import change
from garmentbench.metrics.energy_left import energy_left
from garmentbench.motion.placing import place
from garmentbench.scenes.scene import Motion


def test_energy_left_of_a_vertex_that_slows_down_to_a_tenth():
    steps = np.concatenate([np.full(10, 0.1), np.full(40, 0.01)])  # metres a frame along x
    x = np.concatenate([[0.0], np.cumsum(steps)])
    garment = np.zeros((51, 2, 3))
    garment[:, 0, 0] = x
    assert energy_left(garment, 10, mass=np.array([2.0, 5.0])) == pytest.approx(1.0)  # (0.01 / 0.1)^2 = 1 %


def test_a_garment_at_rest_has_no_energy_to_lose():
    assert np.isnan(energy_left(np.ones((40, 3, 3)), 5, np.ones(3)))


def test_change_undoes_where_the_scene_was_put():
    plain = np.random.default_rng(0).normal(size=(5, 7, 3))
    motion = Motion("walk", turn=90.0, translate=(1000.0, -3.0, 0.5))
    moved = place(plain, motion)
    assert change(moved, plain, motion.turn, motion.translate) < 1e-9
    moved[:, 0, 2] += 0.07  # one of seven vertices 7 cm up: 1 cm in the mean
    assert change(moved, plain[:4], motion.turn, motion.translate) == pytest.approx(1.0)
