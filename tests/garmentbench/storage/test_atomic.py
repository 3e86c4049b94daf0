"""A file is there whole or not at all."""

import pytest

from garmentbench.errors import UserError
from garmentbench.storage.atomic import write_text, written_whole


def test_a_block_that_fails_leaves_the_old_file(tmp_path):
    path = tmp_path / "a" / "file.txt"
    write_text(path, "old")
    with pytest.raises(ValueError, match="stop"), written_whole(path) as partial:
        partial.write_text("ne")
        raise ValueError("stop")
    assert path.read_text() == "old" and [p.name for p in path.parent.iterdir()] == ["file.txt"]
    write_text(path, "new")
    assert path.read_text() == "new"


def test_a_place_that_cannot_be_written_to(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="can't be written .* same command again"):
        write_text(tmp_path / "file" / "below.txt", "text")
