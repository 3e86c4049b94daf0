import matplotlib.image

from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.sequence_file import save
from garmentbench.viewing.first_frame import draw_first_frame


def test_the_picture_shows_something(tmp_path):
    save(tiny_sequence(4), tmp_path / "a.h5")
    draw_first_frame(tmp_path / "a.h5", tmp_path / "a.png")
    image = matplotlib.image.imread(tmp_path / "a.png")[..., :3]
    coloured = (image.max(axis=2) - image.min(axis=2)) > 0.1
    assert image.shape == (600, 900, 3)
    assert 0.02 < coloured.mean() < 0.9
