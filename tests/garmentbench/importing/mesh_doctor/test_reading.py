"""Meshes are read as they lie in the file, from OBJ, PLY and .npz; broken files end in one line."""

import warnings

import numpy as np
import pytest
import trimesh
from faulty_meshes import ball, tube

from garmentbench.errors import UserError
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.importing.mesh_doctor.examine import examine
from garmentbench.importing.mesh_doctor.files import mesh_of, read_mesh, read_wearer, write_mesh
from garmentbench.importing.meshes.conventions import converter
from garmentbench.scenes.bodies import load_body
from garmentbench.sequence_file.read_write import save

CLEAN = tube()
OBJ = """\
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 9 9 9
vt 0 0
vt 0.5 0
vt 0.5 1
vt 0 1
vt 0.6 0.1
f 1/1 2/2 3/3
f 1/5 3/3 4/4
"""


def problems(mesh) -> list[str]:
    return [str(f.problem) for f in examine(mesh)]


def test_an_obj_s_vertices_keep_their_numbers_and_are_split_where_uv_differ(tmp_path):
    (tmp_path / "a.obj").write_text(OBJ)
    mesh = read_mesh(tmp_path / "a.obj")
    assert mesh.numbers.tolist() == [0, 1, 2, 3, 4, 0] and mesh.seams.tolist() == [[0, 5]]
    assert sorted(map(tuple, mesh.uv[[0, 5]].tolist())) == [(0, 0), (pytest.approx(0.6), pytest.approx(0.1))]
    assert mesh.corners.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert any("1 vertex without a face, at vertex 4;" in line for line in problems(mesh))


def test_uv_outside_the_square_are_read_as_they_are(tmp_path):
    (tmp_path / "a.obj").write_text(OBJ.replace("vt 0.6 0.1", "vt -3 0.1"))
    assert read_mesh(tmp_path / "a.obj").uv.min() == -3


def test_nan_and_missing_uv_are_read_and_told(tmp_path):
    (tmp_path / "a.obj").write_text(OBJ.replace("v 1 1 0", "v 1 nan 0"))
    assert "1 vertex with NaN or infinite positions, at vertex 2;" in problems(read_mesh(tmp_path / "a.obj"))[0]
    (tmp_path / "b.obj").write_text(OBJ.replace("vt 0.6 0.1", "vt nan 0.1"))
    assert any("2 faces without UV coordinates" in line for line in problems(read_mesh(tmp_path / "b.obj")))


@pytest.mark.parametrize("suffix", ["obj", "npz"])
def test_what_is_written_is_read_again(tmp_path, suffix):
    path = tmp_path / f"tube.{suffix}"
    assert write_mesh(path, CLEAN) == []
    mesh = read_mesh(path)
    assert problems(mesh) == [] and (len(mesh.vertices), len(mesh.faces), len(mesh.seams)) == (1891, 3600, 31)
    np.testing.assert_allclose(mesh.vertices[mesh.faces], CLEAN.vertices[CLEAN.faces], atol=1e-6)
    np.testing.assert_allclose(mesh.uv[mesh.faces], CLEAN.uv[CLEAN.faces], atol=1e-7)
    write_mesh(tmp_path / f"again.{suffix}", mesh)
    assert (tmp_path / f"again.{suffix}").read_bytes() == path.read_bytes()


def test_npz_keeps_licence_pins_and_seams(tmp_path):
    path = tmp_path / "a.npz"
    arrays = dict(rest=CLEAN.vertices.astype(np.float32), faces=CLEAN.faces, seams=CLEAN.seams, pins=np.array([3, 1]))
    np.savez(path, **arrays, uv=CLEAN.uv, licence=np.array("CC0-1.0"))
    mesh = read_mesh(path)
    assert mesh.notes == {"licence": "CC0-1.0"} and mesh.pins.tolist() == [3, 1] and mesh.says_seams
    write_mesh(tmp_path / "b.npz", mesh)
    with np.load(tmp_path / "b.npz") as file:
        assert str(file["licence"]) == "CC0-1.0" and file["pins"].tolist() == [3, 1] and file["pins"].dtype == np.int32


def test_npz_needs_uv_to_be_written(tmp_path):
    path = tmp_path / "bare.npz"
    np.savez(path, rest=CLEAN.vertices, faces=CLEAN.faces)
    mesh = read_mesh(path)
    with pytest.raises(UserError, match="needs UV.*--make-uv"):
        write_mesh(tmp_path / "b.npz", mesh)
    write_mesh(tmp_path / "b.obj", mesh)
    assert read_mesh(tmp_path / "b.obj").uv is None and list(tmp_path.glob("*.partial")) == []


def ply(path, encoding: str) -> None:
    mesh = trimesh.Trimesh(CLEAN.vertices, CLEAN.faces, process=False)
    path.write_bytes(
        trimesh.exchange.ply.export_ply(mesh, encoding=encoding, vertex_normal=False, include_attributes=False)
    )


def ply_with_uv(path, encoding: str) -> None:
    """As Blender writes it: s and t of each vertex."""
    form = "ascii" if encoding == "ascii" else "binary_little_endian"
    header = f"ply\nformat {form} 1.0\nelement vertex {len(CLEAN.vertices)}\n"
    header += "".join(f"property float {name}\n" for name in "xyzst") + f"element face {len(CLEAN.faces)}\n"
    header += "property list uchar uint vertex_indices\nend_header\n"
    rows = np.concatenate([CLEAN.vertices, CLEAN.uv], axis=1).astype("<f4")
    faces = np.zeros(len(CLEAN.faces), np.dtype([("count", "u1"), ("corners", "<u4", 3)]))
    faces["count"], faces["corners"] = 3, CLEAN.faces
    if encoding == "ascii":
        lines = [" ".join(f"{x:.9g}" for x in row) for row in rows] + [f"3 {a} {b} {c}" for a, b, c in CLEAN.faces]
        path.write_text(header + "\n".join(lines) + "\n")
    else:
        path.write_bytes(header.encode() + rows.tobytes() + faces.tobytes())


@pytest.mark.parametrize("encoding", ["ascii", "binary"])
def test_ply_by_another_library(tmp_path, encoding):
    ply(tmp_path / "a.ply", encoding)
    mesh = read_mesh(tmp_path / "a.ply")
    np.testing.assert_array_equal(mesh.faces, CLEAN.faces)
    np.testing.assert_allclose(mesh.vertices, CLEAN.vertices, atol=1e-6)
    assert mesh.uv is None and mesh.numbers.tolist() == list(range(1891))
    ply_with_uv(tmp_path / "b.ply", encoding)
    mesh = read_mesh(tmp_path / "b.ply")
    np.testing.assert_array_equal(mesh.faces, CLEAN.faces)
    np.testing.assert_allclose(mesh.uv, CLEAN.uv, atol=1e-7)
    (line,) = problems(mesh)
    assert "30 edges of UV seams whose two sides are joined by position only" in line


def test_ply_with_uv_at_the_corners_and_quads(tmp_path):
    (tmp_path / "a.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face "
        "2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
        "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 6 0 0 0.5 0 0.5 1\n3 0 2 3 6 0.6 0.1 0.5 1 0 1\n"
    )
    mesh = read_mesh(tmp_path / "a.ply")
    assert mesh.numbers.tolist() == [0, 1, 2, 3, 0] and mesh.seams.tolist() == [[0, 4]]
    (tmp_path / "b.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face "
        "1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"
    )
    assert read_mesh(tmp_path / "b.ply").faces.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_a_sequence_s_garment_and_body(tmp_path):
    sequence = tiny_sequence(4)
    save(sequence, tmp_path / "a.h5")
    np.testing.assert_array_equal(read_mesh(tmp_path / "a.h5").faces, sequence.template.garment.faces)
    assert set(read_wearer(str(tmp_path / "a.h5")).parts) == {"lower", "upper"}
    save(tiny_sequence(4, kind=None), tmp_path / "b.h5")
    with pytest.raises(UserError, match="has no body"):
        read_wearer(str(tmp_path / "b.h5"))


def test_bodies_by_name_and_from_meshes_in_any_unit(tmp_path):
    assert read_wearer("base").body.name == "base" and "upper_arm.L" in read_wearer("base").parts
    with pytest.raises(UserError, match="unknown body 'bas': did you mean 'base'"):
        read_wearer("bas")
    body = ball()
    for name, factor in (("m", 1.0), ("cm", 100.0)):
        trimesh.Trimesh(body.rest * factor, body.faces, process=False).export(tmp_path / f"{name}.obj")
        np.testing.assert_allclose(read_wearer(str(tmp_path / f"{name}.obj")).body.rest, body.rest, atol=1e-5)
    trimesh.Trimesh(body.rest * 1e4, body.faces, process=False).export(tmp_path / "odd.obj")
    with pytest.raises(UserError, match="wanted a person of 1 to 2.4 m; give --body-units"):
        read_wearer(str(tmp_path / "odd.obj"))
    assert read_wearer(str(tmp_path / "odd.obj"), "mm").body.rest.max() == pytest.approx(10 * body.rest.max())


@pytest.mark.parametrize(("units", "metres"), [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254), ("ft", 0.3048)])
@pytest.mark.parametrize("up", ["x", "y", "z"])
def test_a_standing_body_s_unit_and_axis_are_seen_and_said(tmp_path, units, metres, up):
    """Another program's copy of our own body, with a vertex far away that no face uses."""
    body = load_body("base", "small").body
    matrix = converter(metres, up)
    there = np.concatenate([body.rest @ np.linalg.inv(matrix).T, [[1e5, 1e5, 1e5]]])
    trimesh.Trimesh(there, body.faces, process=False).export(tmp_path / "a.obj")
    found = read_wearer(str(tmp_path / "a.obj"))
    np.testing.assert_allclose(found.body.rest, body.rest, atol=1e-4)
    assert found.assumed[0].startswith(f"units: {units} (inferred: body height")
    assert found.assumed[1].startswith(f"up: {up} (inferred: the body measures")
    given = read_wearer(str(tmp_path / "a.obj"), units, up)
    assert given.assumed == (f"units: {units} (given)", f"up: {up} (given)")
    np.testing.assert_allclose(given.body.rest, body.rest, atol=1e-4)


def one_line(path) -> str:
    """Reads a file that may be broken. Gives the complaint, or "" where it could be read after all."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            read_mesh(path)
        except UserError as e:
            assert "\n" not in str(e) and str(path) in str(e) and len(str(e)) < 600, str(e)
            return str(e)
    return ""


@pytest.mark.parametrize("name", ["a.obj", "a.npz", "ascii.ply", "binary.ply"])
def test_a_file_cut_off_anywhere_ends_in_one_line_or_is_a_smaller_mesh(tmp_path, name):
    source, cut = tmp_path / name, tmp_path / f"cut-{name}"
    if source.suffix == ".ply":
        ply(source, source.stem)
    else:
        write_mesh(source, CLEAN)
    whole = source.read_bytes()
    stops = [*range(0, 400, 3), *np.random.default_rng(0).integers(0, len(whole), 40), len(whole) - 1]
    complaints = 0
    for stop in stops:
        cut.write_bytes(whole[:stop])
        complaints += bool(one_line(cut))
    assert complaints >= (len(stops) if source.suffix == ".npz" else 100)


@pytest.mark.parametrize("name", ["a.obj", "a.npz", "ascii.ply", "binary.ply"])
def test_damaged_bytes_end_in_one_line_or_another_mesh(tmp_path, name):
    source, bad = tmp_path / name, tmp_path / f"bad-{name}"
    mesh = read_mesh_of_few(tmp_path)
    if source.suffix == ".ply":
        few = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        source.write_bytes(trimesh.exchange.ply.export_ply(few, encoding=source.stem))
    else:
        write_mesh(source, mesh)
    whole, random = np.frombuffer(source.read_bytes(), np.uint8), np.random.default_rng(1)
    for _ in range(150):
        changed = whole.copy()
        at = random.integers(0, len(whole), random.integers(1, 4))
        changed[at] = random.integers(0, 256, len(at))
        bad.write_bytes(changed.tobytes())
        one_line(bad)


def read_mesh_of_few(folder):
    (folder / "few.obj").write_text(OBJ)
    return read_mesh(folder / "few.obj").compact()


BAD_NPZ = {
    "no faces key": (dict(rest=np.zeros((3, 3))), "has no array 'faces' (found: rest)"),
    "objects": (dict(rest=np.array([{}] * 3), faces=np.array([[0, 1, 2]])), "damaged, or no .npz file"),
    "out of range": (
        dict(rest=np.zeros((3, 3)), faces=np.array([[0, 1, 3]])),
        "faces name vertices from 0 to 3, there are 3",
    ),
    "negative": (dict(rest=np.zeros((3, 3)), faces=np.array([[0, 1, -1]])), "faces name vertices from -1 to 1"),
    "floats for faces": (
        dict(rest=np.zeros((3, 3)), faces=np.array([[0, 1, 2.0]])),
        "faces is float64 of shape (1, 3)",
    ),
    "two dimensions": (dict(rest=np.zeros((3, 2)), faces=np.array([[0, 1, 2]])), "rest is float64 of shape (3, 2)"),
    "no faces": (dict(rest=np.zeros((3, 3)), faces=np.zeros((0, 3), int)), "has no faces"),
    "uv of others": (
        dict(rest=np.zeros((3, 3)), faces=np.array([[0, 1, 2]]), uv=np.zeros((4, 2))),
        "uv has 4 rows, rest has 3",
    ),
}


@pytest.mark.parametrize("case", BAD_NPZ)
def test_wrong_arrays_are_told(tmp_path, case):
    arrays, says = BAD_NPZ[case]
    np.savez(tmp_path / "a.npz", **arrays)
    line = one_line(tmp_path / "a.npz")
    assert says in line and "; write it again" in line


def test_a_huge_claim_is_not_believed(tmp_path):
    header = "{'descr': '<f8', 'fortran_order': False, 'shape': (500000000, 3), }"
    header = header.ljust(117) + "\n"
    import zipfile

    with zipfile.ZipFile(tmp_path / "a.npz", "w") as file:
        file.writestr("rest.npy", b"\x93NUMPY\x01\x00v\x00" + header.encode() + bytes(64))
        file.writestr("faces.npy", b"")
    assert "claims 12000000000 bytes" in one_line(tmp_path / "a.npz")


@pytest.mark.parametrize("name", ["a.obj", "a.ply", "a.npz"])
def test_files_that_are_not_there_or_something_else(tmp_path, name):
    path = tmp_path / name
    assert "no such file" in one_line(path)
    path.write_bytes(b"")
    assert one_line(path)
    path.write_text("hello, this is a letter\n" * 20)
    assert one_line(path)
    path.unlink()
    path.mkdir()
    assert "a folder" in one_line(path)


def test_the_sequence_s_mesh_is_its_rest_shape():
    garment = tiny_sequence(1).template.garment
    assert mesh_of(garment).says_seams and np.array_equal(mesh_of(garment).vertices, garment.rest)
