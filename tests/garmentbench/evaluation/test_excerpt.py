import numpy as np
import pytest

from garmentbench.errors import UserError
from garmentbench.evaluation.excerpt import FILE, frames_drawn, read_excerpt, write_excerpt
from garmentbench.evaluation.rollout import ROLL_OUT, RollOut
from garmentbench.evaluation.toy import tiny_sequence


def shifted(sequence, bad=None) -> RollOut:
    """A roll-out 3 cm off in every vertex."""
    garment = sequence.garment + np.float32([0.0, 0.0, 0.03])
    garment[:3] = sequence.garment[:3]
    if bad is not None:
        garment[bad:] = np.nan
    return RollOut(ROLL_OUT, 3, garment, None, np.ones((len(sequence), 3)))


def test_the_frames_drawn_spread_evenly_to_the_last():
    assert frames_drawn(3, 1150).tolist() == [194, 385, 576, 767, 958, 1149]
    assert frames_drawn(3, 6).tolist() == [3, 4, 5]


def test_material_reads_back(tmp_path):
    sequence = tiny_sequence(30)
    write_excerpt(tmp_path, sequence, shifted(sequence))
    excerpt = read_excerpt(tmp_path)
    np.testing.assert_allclose(excerpt.error_cm, np.full(27, 3.0), rtol=1e-4)
    np.testing.assert_array_equal(excerpt.reference, sequence.garment[excerpt.frames])
    np.testing.assert_array_equal(excerpt.body, sequence.body[excerpt.frames])
    assert int(excerpt.start) == 3 and excerpt.frames[-1] == 29


def test_without_a_body_and_after_the_end(tmp_path):
    sequence = tiny_sequence(30, kind=None)
    write_excerpt(tmp_path, sequence, shifted(sequence, bad=10))
    excerpt = read_excerpt(tmp_path)
    assert excerpt.body.shape == (6, 0, 3) and len(excerpt.body_faces) == 0
    assert np.isfinite(excerpt.error_cm).sum() == 7 and np.isnan(excerpt.prediction[-1]).all()


def test_a_damaged_file_is_named(tmp_path):
    sequence = tiny_sequence(10)
    write_excerpt(tmp_path, sequence, shifted(sequence))
    path = tmp_path / FILE
    path.write_bytes(path.read_bytes()[:200])
    with pytest.raises(UserError, match=r"report.npz: damaged .*delete"):
        read_excerpt(tmp_path)
