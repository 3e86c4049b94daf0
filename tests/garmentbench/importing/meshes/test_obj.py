"""OBJ files of other programs: what trimesh writes, and the dialects that it doesn't write."""

import numpy as np
import pytest
import trimesh
from exchange_example import MESHES

from garmentbench.errors import UserError
from garmentbench.importing.meshes.obj import read_series, read_template, series, write_series
from garmentbench.importing.meshes.uv_map import vertex_uv

QUAD = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def text(tmp_path, content, name="a.obj"):
    (tmp_path / name).write_bytes(content.encode() if isinstance(content, str) else content)
    return tmp_path / name


def test_a_series_that_trimesh_wrote(tmp_path):
    mesh = MESHES["garment"]
    for t in (0, 1, 2, 9, 10):  # natural order: 10 comes last
        shape = trimesh.Trimesh(mesh.frames[t % 6], mesh.faces, process=False)
        uv = np.zeros((len(mesh.still), 2))
        uv[mesh.faces.ravel()] = mesh.corner_uv.reshape(-1, 2)
        shape.visual = trimesh.visual.TextureVisuals(uv=uv)
        (tmp_path / f"cloth{t}.obj").write_text(trimesh.exchange.obj.export_obj(shape, digits=8, write_texture=False))
    with pytest.raises(UserError, match="cloth2.obj is followed by cloth9.obj: a frame is missing"):
        series(str(tmp_path))
    for t in (0, 1, 2):
        (tmp_path / f"cloth{t}.obj").rename(tmp_path / f"cloth{t + 6}.obj")
    read = read_series(series(str(tmp_path)))
    assert [f.name for f in read.files] == ["cloth6.obj", "cloth7.obj", "cloth8.obj", "cloth9.obj", "cloth10.obj"]
    np.testing.assert_array_equal(read.faces, mesh.faces)
    np.testing.assert_allclose(read.frames, mesh.frames[[0, 1, 2, 3, 4]], atol=1e-7)
    np.testing.assert_allclose(read.corner_uv, mesh.corner_uv, atol=1e-7)


def test_trimesh_reads_what_is_written(tmp_path):
    mesh = MESHES["garment"]
    paths = write_series(tmp_path, mesh)
    loaded = trimesh.load(paths[3], process=False)
    np.testing.assert_allclose(loaded.vertices, mesh.frames[3], atol=6e-7)
    np.testing.assert_array_equal(loaded.faces, mesh.faces)


@pytest.mark.parametrize(
    "content",
    [
        QUAD + "f 1 2 3 4\n",
        QUAD + "f -4 -3 -2 -1",  # and no newline at the end
        "# note\r\no cloth\r\n" + QUAD.replace("\n", "\r\n") + "vn 0 0 1\r\ng a\r\ns off\r\nf 1//1 2//1 3//1 4//1\r\n",
        QUAD.replace("0\n", "0 1.0\n") + "f\t1 2 \\\n3 4\n",  # homogeneous, a tab, a line that goes on
        QUAD.replace("0\n", "0 0.5 0.5 0.5\n") + "usemtl red\nf 1 2 3 4\n",  # colours
    ],
)
def test_dialects(tmp_path, content):
    mesh = read_template(text(tmp_path, content))
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]] and mesh.corner_uv is None
    assert mesh.frames[0].tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert mesh.notes == ("1 quad cut into triangles",)


@pytest.mark.parametrize(
    "content",
    [
        "\ufeff" + QUAD + "f 1 2 3 4\n",
        QUAD.replace("v 1 1 0", "v 1 1 0 # the corner") + "f 1 2 3 4 # all of it\n",
        QUAD.replace("v 1 1 0", "v 1 1 0 0.5 0.5 0.5") + "f 1 2 3 4\n",  # a colour on one
        QUAD.replace("v 1 1 0", "v 1 1 0 0.5 0.5 0.5").replace("v 0 0 0", "v 0 0 0 1") + "f 1 2 3 4\n",
        QUAD + "f 1/ 2/ 3/ 4/\n",
        QUAD + "f 1// 2// 3// 4//\n",
        "  " + QUAD.replace("\n", "\n\t") + "f 1 2 3 4\n",
        QUAD.replace("v 1", "  v 1") + "  f 1 2 3 4\n",
        (QUAD + "f 1 2 3 4\n").replace("\n", "\r"),
    ],
)
def test_lines_that_others_read_are_read(tmp_path, content):
    mesh = read_template(text(tmp_path, content))
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]] and mesh.corner_uv is None
    assert mesh.frames[0].tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be", "utf-8-sig", "utf-8", "latin-1"])
def test_text_of_any_encoding(tmp_path, encoding):
    """As Windows' editors save it."""
    content = "# Größe\no Hüfte\n" + QUAD + "f 1 2 3 4\n"
    (tmp_path / "a.obj").write_bytes(content.encode(encoding))
    mesh = read_template(tmp_path / "a.obj")
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert mesh.frames[0].tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


def test_corners_with_and_without_uv(tmp_path):
    half = read_template(text(tmp_path, QUAD + "vt 0 0\nvt 1 0\nf 1/1 2/2 3/1\nf 1 3 4\n"))
    assert half.faces.tolist() == [[0, 1, 2], [0, 2, 3]] and np.isnan(half.corner_uv[1]).all()
    assert half.corner_uv[0].tolist() == [[0, 0], [1, 0], [0, 0]]
    with pytest.raises(UserError, match="has no UV, or none that is finite, for 1 of its 2 triangles.*--make-uv"):
        vertex_uv(half)
    mixed = read_template(text(tmp_path, QUAD + "vt 0 0\nvt 1 0\nvn 0 0 1\nf 1/1 2/2 3/1\nf 1/1/1 3/2/1 4/1/1\n"))
    assert mixed.corner_uv.tolist() == [[[0, 0], [1, 0], [0, 0]], [[0, 0], [1, 0], [0, 0]]]


def test_two_objects_are_asked_for_and_one_is_read(tmp_path):
    """The second counts on from the first, as in every OBJ file."""
    second = "o body\nv 0 0 5\nv 1 0 5\nv 1 1 5\nf 5 6 7\n"
    path = text(tmp_path, "o shirt\n" + QUAD + "f 1 2 3 4\n" + second)
    with pytest.raises(
        UserError, match=r"holds 2 objects \(shirt, body\), wanted to know which is the garment.*--mesh"
    ):
        read_template(path)
    with pytest.raises(UserError, match="no object is called 'skirt' .there are: shirt, body"):
        read_template(path, "skirt")
    shirt, body, both = (read_template(path, name) for name in ("shirt", "body", "all"))
    assert shirt.frames.shape == (1, 4, 3) and shirt.notes[0] == "object 'shirt' read, left out: body"
    assert body.faces.tolist() == [[0, 1, 2]] and body.frames[0, :, 2].tolist() == [5, 5, 5]
    assert both.frames.shape == (1, 7, 3) and both.notes[0] == "objects taken as one mesh: shirt, body"
    assert read_template(path, points=3).faces.tolist() == [[0, 1, 2]]  # a cache of three points tells
    moved = text(tmp_path, path.read_text().replace("v 0 0 5", "v 0 0 6"), "b.obj")
    assert read_series([path, moved], prim="body").frames[:, 0].tolist() == [[0, 0, 5], [0, 0, 6]]


def test_groups_are_one_mesh_unless_they_say_garment_and_body(tmp_path):
    second = "g {}\nv 0 0 5\nv 1 0 5\nv 1 1 5\nf 5 6 7\n"
    panels = read_template(text(tmp_path, "g front\n" + QUAD + "f 1 2 3 4\n" + second.format("back")))
    assert len(panels.faces) == 3 and panels.notes[0] == "groups taken as one mesh: front, back"
    two = text(tmp_path, "g shirt\n" + QUAD + "f 1 2 3 4\n" + second.format("avatar"))
    with pytest.raises(UserError, match=r"holds 2 objects \(shirt, avatar\)"):
        read_template(two)
    assert len(read_template(two, "avatar", "body").faces) == 1


def test_uv_follows_the_corners_through_the_cut(tmp_path):
    mesh = read_template(text(tmp_path, QUAD + "vt 0 0\nvt 0.5 0\nvt 0.5 1\nvt 0 1\n" + "f 1/4 2/3 3/2 4/1\n"))
    assert mesh.corner_uv.tolist() == [[[0, 1], [0.5, 1], [0.5, 0]], [[0, 1], [0.5, 0], [0, 0]]]


def test_negative_indices_count_from_what_was_listed_so_far(tmp_path):
    other = "v 0 0 5\nv 1 0 5\nv 1 1 5\n"
    mesh = read_template(text(tmp_path, QUAD + "f -4 -3 -2\n" + other + "f -3 -2 -1\n"))
    assert mesh.faces.tolist() == [[0, 1, 2], [4, 5, 6]]


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("", "an empty file"),
        ("hello\n", "has no v lines"),
        (QUAD, "has no f lines"),
        (QUAD.replace("1 1 0", "1 one 0") + "f 1 2 3\n", "line 3 is 'v 1 one 0', wanted 3 numbers or more"),
        (QUAD.replace("1 1 0", "1 1") + "f 1 2 3\n", "line 3 is 'v 1 1'"),
        (QUAD.replace("1 1 0", "1,0 1,0 0,0") + "f 1 2 3\n", "line 3 is 'v 1,0 1,0 0,0'"),
        (QUAD + "f 1 2 5\n", "line 5 names v 5, there are 4"),
        (QUAD + "f 1 2 -5\n", "line 5 names v -5, there are 4"),
        (QUAD + "f 0 1 2\n", "line 5 names v 0"),
        (QUAD + "f 1 2 2.5\n", "line 5 is 'f 1 2 2.5'"),
        (QUAD + "f 1 2\n", "line 5 is 'f 1 2'"),
        (QUAD + "f 1/1/1/1 2 3\n", "line 5 is 'f 1/1/1/1 2 3'"),
        (QUAD + "vt 0 0\nf 1/1 2/2 3/1\n", "line 6 names vt 2, there are 1"),
        (QUAD + "f 1 2 99999999999999999999\n", "there are 4"),
        (QUAD + "f" + " 1" * 200 + "\n", "face 0 has 200 corners"),
        (QUAD + "f a b c\n", "line 5 is 'f a b c'"),
    ],
)
def test_what_is_no_mesh_is_refused_in_one_line(tmp_path, content, says):
    path = text(tmp_path, content)
    with pytest.raises(UserError) as error:
        read_template(path)
    message = str(error.value)
    assert message.startswith(str(path)) and says in message and "\n" not in message


@pytest.mark.parametrize(
    ("second", "says"),
    [
        (QUAD + "v 2 2 2\nf 1 2 3 4\n", "2.obj: has 5 vertices, 1.obj has 4"),
        (QUAD + "f 1 2 4 3\n", "2.obj: has other faces than 1.obj"),
        (QUAD + "f 1 2 3\nf 1 3 4\n", "2.obj: has other faces than 1.obj"),
    ],
)
def test_a_frame_of_another_mesh_is_named(tmp_path, second, says):
    files = [text(tmp_path, QUAD + "f 1 2 3 4\n", "1.obj"), text(tmp_path, second, "2.obj")]
    with pytest.raises(UserError, match=says):
        read_series(files)


def test_the_same_faces_written_otherwise_are_the_same(tmp_path):
    files = [
        text(tmp_path, QUAD + "f 1 2 3 4\n", "1.obj"),
        text(tmp_path, QUAD + "vn 0 0 1\nf 1//1 2//1 3//1 4//1\n", "2.obj"),
    ]
    assert read_series(files).frames.shape == (2, 4, 3)


@pytest.mark.parametrize("form", ["shirt.{:04d}", "{:04d}_shirt", "take2_{}_lod1", "shirt_{:d}", "2024-11-{:02d}"])
def test_numbers_anywhere_in_the_names(tmp_path, form):
    for number in (5, 7, 9, 11):
        text(tmp_path, QUAD.replace("0 1 0", f"0 1 {number}") + "f 1 2 3 4\n", form.format(number) + ".obj")
    read = read_series(series(str(tmp_path)))
    assert read.times.tolist() == [5, 7, 9, 11] and read.frames[:, 3, 2].tolist() == [5, 7, 9, 11]
    text(tmp_path, QUAD + "f 1 2 3 4\n", form.format(12) + ".obj")
    with pytest.raises(UserError, match="a frame is missing or too many"):
        series(str(tmp_path))


def test_a_folder_of_two_series_asks_for_a_pattern(tmp_path):
    for name in ("body_1.obj", "body_2.obj", "shirt_1.obj", "shirt_2.obj"):
        text(tmp_path, QUAD + "f 1 2 3\n", name)
    with pytest.raises(
        UserError, match=r"files of different names \(body_, shirt_ ...\), wanted one numbered series; name one by"
    ):
        series(str(tmp_path))
    assert [p.name for p in series(str(tmp_path / "shirt_*.obj"))] == ["shirt_1.obj", "shirt_2.obj"]
    with pytest.raises(UserError, match="no OBJ file there"):
        series(str(tmp_path / "trousers_*.obj"))
