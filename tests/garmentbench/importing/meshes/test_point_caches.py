"""PC2 and MDD, written here byte by byte as their formats say."""

import struct

import numpy as np
import pytest
from exchange_example import MESHES

from garmentbench.errors import UserError
from garmentbench.importing.meshes.obj import read_template, write_template
from garmentbench.importing.meshes.point_caches import read_mdd, read_pc2, write_mdd, write_pc2

MESH = MESHES["garment"]
FRAMES, POINTS = MESH.frames.shape[:2]


@pytest.fixture
def template(tmp_path):
    write_template(tmp_path / "cloth.obj", MESH)
    return read_template(tmp_path / "cloth.obj")


def pc2(rate=1.0, version=1, points=POINTS, samples=FRAMES, order="<") -> bytes:
    header = b"POINTCACHE2\0" + struct.pack(f"{order}iiffi", version, points, 0.0, rate, samples)
    return header + b"".join(struct.pack(f"{order}3f", *map(float, x)) for x in MESH.frames.reshape(-1, 3))


def mdd(times=None, count=FRAMES, points=POINTS, order=">") -> bytes:
    times = np.arange(FRAMES) / 25 if times is None else times
    header = struct.pack(f"{order}ii", count, points) + struct.pack(f"{order}{len(times)}f", *times)
    return header + b"".join(struct.pack(f"{order}3f", *map(float, x)) for x in MESH.frames.reshape(-1, 3))


def test_pc2_by_its_published_format(tmp_path, template):
    (tmp_path / "a.pc2").write_bytes(pc2())
    read = read_pc2(tmp_path / "a.pc2", template)
    np.testing.assert_array_equal(read.frames, MESH.frames)
    np.testing.assert_array_equal(read.faces, MESH.faces)
    assert (read.fps, read.unit, read.up, read.name) == (None, None, None, "a")
    write_pc2(tmp_path / "b.pc2", MESH)
    assert (tmp_path / "b.pc2").read_bytes() == pc2()


@pytest.mark.parametrize(
    ("rate", "fps", "note"),
    [
        (1.0, None, None),
        (2.0, None, "one sample every 2 frames"),
        (10.0, None, "one sample every 10 frames"),
        (0.0, None, "its sampling of 0 means nothing: taken as 1"),
        (-1.0, None, "its sampling of -1 means nothing: taken as 1"),
        (float("nan"), None, "its sampling of nan means nothing: taken as 1"),
        (24.0, 24.0, "taken as frames a second"),
        (29.97, pytest.approx(29.97), "taken as frames a second"),
    ],
)
def test_pc2_says_what_its_sampling_was_taken_for(tmp_path, template, rate, fps, note):
    (tmp_path / "a.pc2").write_bytes(pc2(rate))
    read = read_pc2(tmp_path / "a.pc2", template)
    assert read.fps == fps and read.counted
    assert (note is None and read.notes == ()) or (note is not None and note in read.notes[0])
    np.testing.assert_allclose(np.diff(read.times), rate if note and "every" in note else 1)


def test_a_frame_more_than_the_header_says_is_left_out(tmp_path, template):
    frame = MESH.frames[0].astype("<f4").tobytes()
    (tmp_path / "a.pc2").write_bytes(pc2() + frame)
    (tmp_path / "a.mdd").write_bytes(mdd() + frame)
    for read in (read_pc2(tmp_path / "a.pc2", template), read_mdd(tmp_path / "a.mdd", template)):
        np.testing.assert_array_equal(read.frames, MESH.frames)
        assert read.notes == ("one frame more than its header says: left out",)


def test_mdd_by_its_published_format(tmp_path, template):
    (tmp_path / "a.mdd").write_bytes(mdd())
    read = read_mdd(tmp_path / "a.mdd", template)
    np.testing.assert_array_equal(read.frames, MESH.frames)
    assert read.fps == 25.0
    write_mdd(tmp_path / "b.mdd", MESH)
    assert (tmp_path / "b.mdd").read_bytes() == mdd()


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (pc2(version=7), "version 7, wanted 1"),
        (pc2(order=">"), "its bytes are in big-endian order"),
        (pc2(samples=0), "105 points and 0 frames"),
        (pc2(points=-3), "-3 points"),
        (
            pc2(samples=9_000_000),
            "its header (9000000 frames of 105 points) wants 11340000032: it is damaged or cut off",
        ),
        (pc2()[:-1], "cut off"),
        (pc2() + b"\0", "it is damaged"),
        (pc2()[:20], "cut off in its header"),
        (b"v 0 0 0\n" * 40, "no PC2 file"),
        (b"", "an empty file"),
    ],
)
def test_damaged_pc2(tmp_path, template, content, says):
    refused(tmp_path / "a.pc2", content, says, read_pc2, template)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (mdd(order="<"), "its bytes are in little-endian order"),
        (mdd(count=0), "0 frames and 105 points"),
        (mdd(points=2**30), "wants"),
        (mdd()[:-1], "cut off"),
        (mdd()[:5], "cut off in its header"),
        (mdd(times=[0, 0.04, 0.08, 0.5, 0.54, 0.58]), "frames 2 and 3 are at 0.08 s and 0.5 s, wanted evenly spaced"),
        (mdd(times=[0.0] * 6), "wanted times that increase"),
        (mdd(times=[float("nan")] * 6), "wanted times that increase"),
        (mdd(times=[0, 1, 2, float("inf"), 4, 5]), "wanted times that increase"),
    ],
)
def test_damaged_mdd(tmp_path, template, content, says):
    refused(tmp_path / "a.mdd", content, says, read_mdd, template)


def refused(path, content, says, read, template):
    path.write_bytes(content)
    with pytest.raises(UserError) as error:
        read(path, template)
    message = str(error.value)
    assert message.startswith(str(path)) and says in message and "\n" not in message


def test_a_template_of_another_mesh(tmp_path, template):
    (tmp_path / "a.pc2").write_bytes(pc2(points=POINTS * 2, samples=FRAMES // 2))
    with pytest.raises(
        UserError, match="has 210 points, its template .*cloth.obj has 105 vertices; export both from the same"
    ):
        read_pc2(tmp_path / "a.pc2", template)
