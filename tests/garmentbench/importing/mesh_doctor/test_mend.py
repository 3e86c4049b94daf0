"""Repairs do what they say, leave the rest alone, and find nothing to do the second time."""

from dataclasses import replace

import numpy as np
import pytest
from faulty_meshes import COLUMNS, at, ball, more, moved, parted, tube, with_uv

from garmentbench.errors import UserError
from garmentbench.importing.mesh_doctor.body import of_body
from garmentbench.importing.mesh_doctor.examine import examine
from garmentbench.importing.mesh_doctor.files import mesh_of, read_mesh, write_mesh
from garmentbench.importing.mesh_doctor.mesh import Mesh
from garmentbench.importing.mesh_doctor.repairs import mend
from garmentbench.scenes.garment_file import read_garment
from garmentbench.scenes.garments import load_garment
from garmentbench.scenes.scene import MeshFile

CLEAN = tube()
INNER = at(10, 10)
BALL = of_body(ball())


def turned(mesh: Mesh, faces) -> Mesh:
    turned = mesh.faces.copy()
    turned[faces] = turned[faces][..., ::-1]
    return replace(mesh, faces=turned)


def same(a: Mesh, b: Mesh) -> bool:
    fields = ("vertices", "faces", "uv", "seams", "pins", "numbers")
    return all(np.array_equal(getattr(a, f), getattr(b, f)) for f in fields)


def left(mesh: Mesh, wearer=None) -> list[str]:
    return [str(f.problem) for f in examine(mesh, wearer)]


def twice(mesh: Mesh, **options) -> tuple[Mesh, list[str]]:
    """Mended; asserts that a second time changes nothing."""
    mended, lines = mend(mesh, **options)
    again, nothing = mend(mended, **options)
    assert nothing == [] and same(mended, again)
    return mended, lines


def soup(mesh: Mesh) -> Mesh:
    """Each face with vertices of its own, as in an STL file."""
    corners = mesh.faces.ravel()
    count = len(corners)
    return Mesh("soup", mesh.vertices[corners], np.arange(count).reshape(-1, 3), mesh.uv[corners], np.arange(count))


def test_a_clean_mesh_is_left_alone():
    mended, lines = mend(CLEAN, BALL, make_uv=True)
    assert lines == [] and same(mended, CLEAN)


def with_cut(mesh: Mesh) -> Mesh:
    """With a pattern: the tube unrolled, a tenth wider."""
    return replace(mesh, cut=mesh.uv * [1.1, 0.7])


def test_the_flat_pattern_is_kept(tmp_path):
    """What was mended had lost its cut, and with it the garment's ease."""
    clean = with_cut(CLEAN)
    mended, lines = mend(replace(clean, faces=np.concatenate([clean.faces, clean.faces[:1]])))
    assert lines == ["removed 1 face that lay on another"]
    np.testing.assert_array_equal(mended.cut, clean.cut)
    assert write_mesh(tmp_path / "tube.npz", mended) == []
    np.testing.assert_allclose(read_mesh(tmp_path / "tube.npz").cut, mended.cut, atol=1e-7)
    assert read_garment("tube", MeshFile(str(tmp_path / "tube.npz"))).cut is not None
    assert "left out the flat pattern (cut): OBJ" in write_mesh(tmp_path / "tube.obj", mended)[0]
    inches = clean.scaled(1 / 0.0254)
    np.testing.assert_allclose(mend(inches, units="in")[0].cut, clean.cut)


def test_vertices_that_go_take_their_place_in_the_pattern_along():
    mesh = more(CLEAN, [[0, 0, 0]], [], [[0, 0]])
    mended, _ = mend(replace(mesh, cut=mesh.uv * 2.0))
    np.testing.assert_array_equal(mended.cut, CLEAN.uv * 2.0)


def test_borders_that_are_apart_in_the_pattern_are_sewn_and_not_welded():
    mesh = parted(CLEAN, 12, sewn=False)
    lower = np.arange(len(mesh.vertices)) >= len(CLEAN.vertices)
    mended, lines = mend(replace(mesh, cut=mesh.uv + 2.0 * lower[:, None]))
    assert f"(0 welded, {COLUMNS + 1} sewn across UV seams)" in lines[0]
    assert len(mended.cut) == len(mended.vertices) == len(mesh.vertices)


def test_a_pattern_that_cannot_be_kept_is_told():
    mended, lines = mend(replace(with_cut(CLEAN), uv=None), make_uv=True)
    assert mended.cut is None and lines[1].startswith("left out the flat pattern (cut), whose panels are parted")
    mended, lines = mend(replace(CLEAN, cut=np.full((len(CLEAN.vertices), 2), np.nan)))
    assert mended.cut is None and lines == [
        "left out the flat pattern (cut), which is not finite: the cloth is at rest as it is put on"
    ]


def test_unused_vertices_go_and_pins_and_seams_follow():
    mesh = replace(more(CLEAN, [[0, 0, 0]], [], [[0, 0]]), pins=np.array([5, 1891, 9]))
    order = np.roll(np.arange(1892), 1)  # the unused one comes first
    first = replace(
        mesh,
        vertices=mesh.vertices[order],
        uv=mesh.uv[order],
        numbers=mesh.numbers[order],
        faces=mesh.faces + 1,
        seams=mesh.seams + 1,
        pins=np.array([6, 0, 10]),
    )
    mended, lines = twice(first)
    assert lines == ["removed 1 vertex without a face"] and left(mended) == []
    assert same(mended, replace(CLEAN, pins=np.array([5, 9])))


def test_an_edge_without_length_and_its_faces_go():
    mended, lines = twice(moved(CLEAN, INNER, CLEAN.vertices[INNER + 1]))
    assert lines == ["merged the ends of 1 edge without length", "removed 2 faces that named a point twice"]
    assert len(mended.vertices) == 1890 and len(mended.faces) == 3598 and left(mended) == []


def test_an_edge_without_length_on_a_seam():
    mesh = moved(CLEAN, at(10, 0), CLEAN.vertices[at(11, 0)])
    mended, lines = twice(moved(mesh, at(10, COLUMNS), CLEAN.vertices[at(11, 0)]))
    assert lines == ["merged the ends of 2 edges without length", "removed 2 faces that named a point twice"]
    assert left(mended) == [] and len(mended.seams) == 30


def test_faces_that_lie_on_others_go():
    mended, lines = twice(replace(CLEAN, faces=np.concatenate([CLEAN.faces, CLEAN.faces[[30, 4]][:, ::-1]])))
    assert lines == ["removed 2 faces that lay on another"] and same(mended, CLEAN)


def test_a_flat_face_goes_only_where_that_opens_no_slit():
    a, b = CLEAN.vertices[[at(0, 4), at(0, 5)]]
    on_border = more(CLEAN, [(a + b) / 2], [[at(0, 4), -1, at(0, 5)]], [[0.95, 0.95]])
    mended, lines = twice(on_border)
    assert lines == ["removed 1 face without area from the borders"] and same(mended, CLEAN)
    inside = moved(CLEAN, INNER, CLEAN.vertices[[at(10, 9), at(9, 10)]].mean(axis=0))
    mended, lines = twice(inside)
    assert lines == [] and ["1 face without area" in line for line in left(mended)] == [True]


def test_cracks_are_welded():
    mended, lines = twice(parted(CLEAN, 15, sewn=False))
    assert lines == ["joined 61 pairs of vertices along coinciding borders (61 welded, 0 sewn across UV seams)"]
    assert left(mended) == [] and same(mended, CLEAN)


def test_uv_seams_are_sewn_and_not_welded():
    mended, lines = twice(replace(CLEAN, seams=CLEAN.seams[:0]))
    assert lines == ["joined 31 pairs of vertices along coinciding borders (0 welded, 31 sewn across UV seams)"]
    assert left(mended) == [] and same(mended, CLEAN)


def test_a_soup_becomes_cloth():
    mended, lines = twice(soup(CLEAN))
    assert len(lines) == 1 and left(mended) == []
    assert (len(mended.vertices), len(mended.vertex), len(mended.faces)) == (1891, 1860, 3600)
    np.testing.assert_allclose(mended.vertices[mended.faces], CLEAN.vertices[CLEAN.faces])
    np.testing.assert_allclose(mended.uv[mended.faces], CLEAN.uv[CLEAN.faces])


def test_cracks_a_little_apart_are_welded_when_asked():
    mesh = parted(CLEAN, 15, sewn=False)
    apart = moved(mesh, np.arange(1891, 1952), mesh.vertices[1891:] - [0, 0, 3e-4])
    assert mend(apart)[1] == []
    mended, lines = twice(apart, tolerance=1e-3)
    assert "61 welded" in lines[0] and left(mended) == []


def test_no_weld_makes_a_fin():
    """Three borders in one place: none of them is joined."""
    other = replace(parted(CLEAN, 15, sewn=False), uv=None)
    third = np.concatenate([other.vertices[1891:], other.vertices[1891:] * [1.2, 1.2, 1]])
    count, k = len(other.vertices), np.arange(COLUMNS)
    strip = np.stack([k, k + 1, k + 61], 1) + count
    mesh = replace(
        other,
        vertices=np.concatenate([other.vertices, third]),
        faces=np.concatenate([other.faces, strip]),
        numbers=np.arange(count + len(third)),
    )
    mended, _ = twice(mesh)
    assert (mended.sides.count <= 2).all()


@pytest.mark.parametrize("faces", [[7, 500, 501], slice(None), slice(0, 1000)])
def test_faces_are_turned_outwards(faces):
    mended, lines = twice(turned(CLEAN, faces))
    assert same(mended, CLEAN) and len(lines) == 1 and lines[0].startswith("turned ")


def test_the_body_says_where_out_is():
    apron = replace(CLEAN, faces=CLEAN.faces[CLEAN.vertices[CLEAN.faces][..., 1].min(axis=1) > 0.05]).compact()
    mended, lines = twice(turned(apron, slice(None)), wearer=BALL)
    assert lines == [f"turned {len(apron.faces)} faces that faced inwards"] and same(mended, apron)


@pytest.mark.parametrize(
    ("factor", "says"),
    [
        (180, "scaled from cm to m, by 0.01 (it measured 132.3 across)"),
        (1000, "scaled from mm to m, by 0.001 (it measured 734.8 across)"),
    ],
)
def test_units_are_changed_where_they_can_be_told(factor, says):
    mended, lines = twice(CLEAN.scaled(factor))
    assert lines == [says]
    np.testing.assert_allclose(mended.vertices, CLEAN.vertices * (1.8 if factor == 180 else 1))


def test_units_that_can_t_be_told_are_left_unless_given():
    assert mend(CLEAN.scaled(400.0))[1] == mend(CLEAN.scaled(100.0))[1] == []
    mended, lines = mend(CLEAN.scaled(1000.0), units="mm")
    assert lines == ["scaled from mm to m, by 0.001 (as --units says)"] and left(mended) == []


def test_shallow_penetration_is_pushed_out_smoothly():
    dented = replace(
        CLEAN, vertices=CLEAN.vertices * np.where(np.abs(CLEAN.vertices[:, 2:]) < 0.1, [0.93, 0.93, 1], 1.0)
    )
    assert any("inside 'ball'" in line for line in left(dented, BALL))
    mended, (line,) = twice(dented, wearer=BALL)
    assert left(mended, BALL) == [] and line.startswith("pushed ") and line.endswith(" mm")
    way = np.linalg.norm(mended.vertices - dented.vertices, axis=1)
    assert 0.004 < way.max() < 0.012 and way[np.abs(CLEAN.vertices[:, 2]) > 0.2].max() == 0
    np.testing.assert_array_equal(mended.vertices[mended.seams[:, 0]], mended.vertices[mended.seams[:, 1]])


def test_deep_penetration_is_left():
    deep = replace(CLEAN, vertices=CLEAN.vertices * [0.8, 0.8, 1])
    mended, (line,) = mend(deep, BALL)
    assert line.startswith("left 1") and "only less than 20 mm is pushed" in line and same(mended, deep)


@pytest.mark.parametrize(
    ("factor", "shift", "says"),
    [
        (1.0, [3, -1], "moved the UV map by (-3, 1) into the unit square"),
        (2.0, [0, 0], "moved the UV map by (0, 0) and scaled it by 1/2 into the unit square"),
    ],
)
def test_uv_go_into_the_unit_square(factor, shift, says):
    mended, lines = twice(replace(CLEAN, uv=CLEAN.uv * factor + shift))
    assert lines == [says] and left(mended) == []
    np.testing.assert_allclose(mended.uv, CLEAN.uv, atol=1e-12)


def test_what_is_not_safe_is_left():
    a, b = at(10, 10), at(10, 11)
    ends = CLEAN.vertices[[a, b]]
    fin = more(
        CLEAN,
        [*ends, ends.mean(axis=0) * [1.2, 1.2, 1]],
        [[-3, -2, -1]],
        [[0.95, 0.95], [0.99, 0.95], [0.95, 0.99]],
        [[a, -3], [b, -2]],
    )
    holed = replace(CLEAN, faces=np.delete(CLEAN.faces, 900, axis=0))
    for mesh in (fin, holed):
        mended, lines = mend(mesh)
        assert lines == [] and same(mended, mesh)


def test_uv_are_made_where_asked_and_needed():
    pytest.importorskip("xatlas", reason="xatlas is an extra")
    bare = replace(CLEAN, uv=None, pins=np.array([at(30, 0), at(30, COLUMNS)]))
    assert mend(bare)[1] == []
    mended, (line,) = twice(bare, make_uv=True)
    assert line.startswith("made a UV map by xatlas: ") and left(mended) == []
    assert len(mended.vertex) == 1860 and set(mended.point[mended.pins]) == {mended.point[mended.pins[0]]}
    np.testing.assert_allclose(mended.vertices[mended.faces], CLEAN.vertices[CLEAN.faces])
    folded = with_uv(CLEAN, INNER, CLEAN.uv[at(10, 12)])
    assert left(twice(folded, make_uv=True)[0]) == []


def test_everything_at_once():
    mesh = soup(CLEAN).scaled(1000.0)
    mesh = turned(mesh, np.arange(0, 1000, 7))
    mesh = more(mesh, [[1, 2, 3]], [mesh.faces[3]], [[0, 0]])
    mended, lines = twice(replace(mesh, uv=mesh.uv * 2), wearer=BALL)
    assert len(lines) == 6 and left(mended, BALL) == []


@pytest.mark.parametrize("name", ["tshirt", "sheet"])
def test_baked_garments_need_no_repair(name):
    garment = mesh_of(load_garment(name, "laptop"))
    mended, lines = mend(garment)
    assert lines == [] and same(mended, garment)


def test_what_can_t_be_mended_is_refused():
    with pytest.raises(UserError, match="1 vertex with NaN"):
        mend(moved(CLEAN, 9, np.nan))
    with pytest.raises(UserError, match="all faces are without area"):
        mend(replace(CLEAN, vertices=CLEAN.vertices * 0 + 1))
