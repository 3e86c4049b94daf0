"""A fine mesh hung up in a coarse one: exact at rest and in whatever moves the whole."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from garmentbench.evals.error_time.carry import Carrier
from garmentbench.scenes.garments import load_garment
from garmentbench.sequence import Garment


def flat(places, faces):
    rest = np.column_stack([places, np.zeros(len(places))]).astype(np.float32)
    return Garment("sheet", rest, np.array(faces, np.int32), np.asarray(places, np.float32), np.zeros((0, 2), np.int32))


def test_by_hand():
    """One triangle; the middle of its hypotenuse and a point above its first corner, at rest 1 out of the plane."""
    coarse = flat([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])
    fine = flat([[0.5, 0.5], [0, 0], [0.25, 0.25]], [[0, 1, 2]])
    fine.rest[1, 2] = 1.0
    moved = np.array([[0, 0, 0], [2, 0, 0], [0, 0, 2.0]])  # twice as large, turned upwards: its normal is -y
    np.testing.assert_allclose(Carrier.of(coarse, fine)(moved), [[1, 0, 1], [0, -1, 0], [0.5, 0, 0.5]], atol=1e-6)


@pytest.mark.parametrize("garment", ["pleated_skirt", "dress", "tshirt"])
def test_at_rest_and_moved_as_a_whole_it_is_exact(garment):
    coarse, fine = load_garment(garment, "smoke"), load_garment(garment, "laptop")
    carry, turn = Carrier.of(coarse, fine), Rotation.from_euler("xyz", [0.4, -1.0, 2.0]).as_matrix()
    np.testing.assert_allclose(carry(coarse.rest @ turn.T + [1, 2, 3]), fine.rest @ turn.T + [1, 2, 3], atol=1e-5)
    assert np.linalg.norm(carry.offset, axis=1).mean() < 0.006  # what it adds to the coarse surface is millimetres
