"""What is measured by blocks of frames, or once for several metrics, is what the plain formula says of each frame."""

from dataclasses import replace

import numpy as np
import pytest

from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.geometry.mesh import angles, face_normals, lengths
from garmentbench.metrics import METRICS
from garmentbench.metrics.dihedral_rms import dihedral_rms, face_pairs
from garmentbench.metrics.displacement_spectrum import band_energies
from garmentbench.metrics.interpenetration import inside_vertices
from garmentbench.metrics.metric import BLOCK, Motion
from garmentbench.metrics.normal_angle import normal_angle

FRAMES = BLOCK + 5


@pytest.fixture(scope="module")
def motion():
    """A prediction that is wrong everywhere, and its collision stage, which moved a third of the vertices."""
    sequence, rng = tiny_sequence(FRAMES), np.random.default_rng(0)
    predicted = (sequence.garment + rng.normal(scale=0.02, size=sequence.garment.shape)).astype(np.float32)
    before = predicted - np.float32(0.03) * (rng.random(predicted.shape[:2] + (1,)) < 0.3)
    return replace(Motion.of(sequence), predicted=predicted, before_collision=before.astype(np.float32))


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_vectors_are_measured_as_numpy_does_to_the_last_digit(kind):
    u, v = np.random.default_rng(0).normal(size=(2, 7, 11, 3)).astype(kind)
    np.testing.assert_array_equal(lengths(u), np.linalg.norm(u, axis=-1))
    np.testing.assert_array_equal(
        angles(u, v), np.arctan2(np.linalg.norm(np.cross(u, v), axis=-1), (u * v).sum(axis=-1))
    )
    faces = np.array([[0, 1, 2], [3, 9, 10], [4, 4, 5]])  # the last has no area
    a, b, c = (u[:, faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    size = np.linalg.norm(normals, axis=-1, keepdims=True)
    np.testing.assert_array_equal(face_normals(u, faces), normals / np.where(size > 0, size, 1))


def test_blocks_of_frames_give_the_mean_over_frames(motion):
    garment = motion.template.garment
    each = [dihedral_rms(x[None], garment.faces, face_pairs(garment)) for x in motion.predicted]
    whole = dihedral_rms(motion.predicted, garment.faces, face_pairs(garment))
    assert whole == pytest.approx(np.sqrt(np.mean(np.square(each))), rel=1e-12)
    areas, pairs = np.ones(len(garment.faces)), zip(motion.predicted, motion.reference, strict=True)
    each = [normal_angle(x[None], y[None], garment.faces, areas) for x, y in pairs]
    assert normal_angle(motion.predicted, motion.reference, garment.faces, areas) == pytest.approx(np.mean(each))
    each = [band_energies(x[None], garment) for x in motion.predicted]
    np.testing.assert_allclose(band_energies(motion.predicted, garment), np.mean(each, axis=0), rtol=1e-12)


def test_what_the_collision_stage_has_left_alone_is_not_looked_at_twice(motion):
    body, faces = motion.body, motion.template.body.faces
    for name, garment in (("", motion.predicted), ("_before", motion.before_collision)):
        value = METRICS[f"interpenetration{name}"].compute(motion)
        assert value == 100 * inside_vertices(garment, body, faces).mean() > 0


def test_what_two_metrics_ask_of_the_same_positions_is_measured_once(motion):
    asked = []

    def measure(positions, of):
        asked.append(positions)
        return len(asked)

    assert motion.once(measure, motion.reference) == motion.truth.once(measure, motion.truth.predicted) == 1
    assert motion.once(measure, motion.predicted) == 2
    assert asked[0] is motion.reference and asked[1] is motion.predicted
