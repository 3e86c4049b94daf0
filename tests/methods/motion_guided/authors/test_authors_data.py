"""The authors' released data as sequences: what was written comes back in our axes.

What is wrong is said in one line.
"""

import shutil
from pathlib import Path

import numpy as np
import pytest
from authors_example import Y_UP, Z_UP, Written, save_arrays, write_release

from garmentbench import sequence_file
from garmentbench.errors import UsageError, UserError
from garmentbench.methods.motion_guided.authors.axes import placement
from garmentbench.methods.motion_guided.authors.files import (
    read_arrays,
    read_chart,
    read_groups,
    read_mesh,
    read_samples,
    read_sampling,
    read_vectors,
)
from garmentbench.methods.motion_guided.authors.read import read_release
from garmentbench.methods.motion_guided.authors.release import open_release
from garmentbench.scenes.bodies import load_body
from garmentbench.scenes.garments import load_garment

VERTICES = len(load_garment("tshirt", "smoke").rest)


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> Written:
    return write_release(tmp_path_factory.mktemp("release") / "walk_75")


@pytest.fixture
def copy(written, tmp_path) -> Path:
    """A copy to be spoilt."""
    return Path(shutil.copytree(written.folder, tmp_path / "walk_75"))


def test_a_sequence_holds_what_was_written_in_our_axes(written, tmp_path):
    sequence, told = read_release(open_release(written.folder), "walk")
    np.testing.assert_array_equal(
        sequence.garment, np.einsum("tvx,yx->tvy", written.garment, Y_UP.turn).astype(np.float32)
    )
    np.testing.assert_array_equal(sequence.body, np.einsum("tvx,yx->tvy", written.body, Y_UP.turn).astype(np.float32))
    garment, body = load_garment("tshirt", "smoke"), load_body("base", "small").body
    np.testing.assert_allclose(sequence.template.garment.rest, garment.rest, atol=2**-12)
    np.testing.assert_array_equal(sequence.template.garment.faces, garment.faces)
    np.testing.assert_allclose(sequence.template.garment.uv, garment.uv, atol=2**-12)
    np.testing.assert_array_equal(sequence.template.body.faces, body.faces)
    assert told[:4] == [
        "unit: m (told by the body's height)",
        "axes: ours are the files' x,-z,y (told by the body's shape)",
        "frame rate: 30 a second (no file says it)",
        "frames: 1 to 6, 6 of them",
    ]
    sequence_file.save(sequence, tmp_path / "walk.h5")
    np.testing.assert_array_equal(sequence_file.load(tmp_path / "walk.h5").garment, sequence.garment)


def test_seams_are_all_pairs_of_copies(written):
    seams = read_release(open_release(written.folder), "walk", frames=1)[0].template.garment.seams
    pairs = {tuple(sorted(p)) for p in seams.tolist()}
    assert {tuple(sorted(p)) for p in written.seams.tolist()} <= pairs
    apart = np.linalg.norm(np.diff(written.rest[seams], axis=1), axis=-1)
    assert apart.max() < 2**-11


def test_parts_are_those_of_the_nearest_seed(written):
    body = read_release(open_release(written.folder), "walk", frames=1)[0].template.body
    points = np.einsum("nk,nkx->nx", written.weights, written.body_rest[written.corners])
    nearest = np.linalg.norm(written.body_rest[:, None] - points, axis=-1).argmin(axis=1)
    np.testing.assert_array_equal(body.labels, written.labels[nearest])
    assert body.part_names == ("part_0", "part_1", "part_2")


@pytest.mark.parametrize(("unit", "scale"), [("cm", 100.0), ("mm", 1000.0)])
def test_units_are_told_by_the_body(tmp_path, unit, scale):
    sequence, told = read_release(
        open_release(write_release(tmp_path / "a", Z_UP, frames=2, scale=scale).folder), "walk"
    )
    assert told[0] == f"unit: {unit} (told by the body's height)"
    assert told[1].startswith("axes: ours are the files' x,y,z")
    np.testing.assert_allclose(sequence.template.garment.rest, load_garment("tshirt", "smoke").rest, atol=2**-12)


@pytest.mark.parametrize("name", ["base", "slim", "heavy"])
@pytest.mark.parametrize("axes", ["x,y,z", "x,-z,y", "-x,z,y", "z,x,y", "-y,x,z", "y,z,x"])
def test_axes_are_told_by_the_body(name, axes):
    rest = load_body(name, "small").body.rest.astype(np.float64)
    asked = placement(rest, "m", axes)
    told = placement(rest @ asked.turn)
    assert (told.axes, told.unit) == (axes, "m")
    np.testing.assert_allclose(told(rest @ asked.turn), rest, atol=1e-6)


def test_axes_and_units_that_are_none(written):
    for unit, axes, complaint in (
        ("auto", "x,y", "no rotation"),
        ("auto", "x,z,y", "no rotation"),
        ("auto", "a,b,c", "wanted three"),
        ("inch", "auto", "units is 'inch'"),
    ):
        with pytest.raises(UsageError, match=complaint):
            placement(written.body_rest, unit, axes)
    with pytest.raises(UserError, match="can't tell which way"):
        placement(np.random.default_rng(0).random((100, 3)))
    with pytest.raises(UserError, match="in no known unit; give --units"):
        placement(7 * written.body_rest)


def test_another_case_and_a_part_of_its_frames(copy):
    case = copy / "unseen_test" / "rumba"
    for name in ("TShirt_pnva", "body_n"):
        shutil.copytree(copy / name, case / name)
    for number in (1, 6):
        (case / "body_n" / f"{number:06d}.obj").unlink()
    sequence, told = read_release(open_release(copy), "rumba", "unseen_test/rumba", fps=60.0)
    assert told[3] == "frames: 2 to 5, 4 of them (2 of garment or body alone left out)"
    assert (sequence.info["motion"], sequence.template.fps, len(sequence)) == ("rumba", 60.0, 4)
    (case / "body_n" / "000004.obj").unlink()
    with pytest.raises(UserError, match="no frame 4 of both garment and body"):
        read_release(open_release(copy), "rumba", "unseen_test/rumba")


def test_frames_that_were_left_out_show_in_their_velocities(copy):
    for k in range(4, 7):
        for folder, suffix in (("TShirt_pnva", "npy"), ("body_n", "obj")):
            here = copy / folder
            (here / f"{k:06d}.{suffix}").rename(here / f"{k - 1:06d}.{suffix}")
    with pytest.warns(UserWarning, match="1 frames, the first 3, have moved otherwise"):
        read_release(open_release(copy), "walk")


@pytest.mark.parametrize(
    ("spoil", "complaint"),
    [
        (lambda f: shutil.rmtree(f / "uv_body"), "wanted the folders uv_body and uv_<garment>"),
        (lambda f: shutil.copytree(f / "uv_tshirt", f / "uv_skirt"), "holds the garments skirt, tshirt; choose one"),
        (lambda f: shutil.rmtree(f / "TShirt_pnva"), "wanted one folder \\*_pnva of 'tshirt', found none"),
        (lambda f: (f / "uv_tshirt" / "ind_B2O_10.txt").unlink(), "wanted one ind_B2O_\\*.txt, found none"),
        (lambda f: shutil.rmtree(f / "body_n"), "wanted frames 000001.obj"),
        (lambda f: (f / "uv_tshirt" / "garment_uv.obj").write_text("v 0 0 0\n"), f"1 points for {VERTICES} vertices"),
        (
            lambda f: (f / "uv_body" / "body_geo.obj").write_text("v 0 0 zero\nf 1 1 1\n"),
            "v 0 0 zero', wanted 3 numbers",
        ),
        (
            lambda f: (f / "uv_body" / "body_geo.obj").write_text("v 0 0 nan\nv 0 1 0\nv 1 0 0\nf 1 2 3\n"),
            "vertex 0 is not finite",
        ),
        (lambda f: (f / "body_n" / "000002.obj").write_text("v 0 0 0\n"), "shape \\(1, 3\\), wanted"),
        (
            lambda f: save_arrays(f / "TShirt_pnva" / "000002.npy", *3 * [np.zeros((3, 3))]),
            f"shape \\(3, 3\\), wanted \\({VERTICES}, 3\\)",
        ),
        (
            lambda f: save_arrays(f / "TShirt_pnva" / "000002.npy", np.zeros((VERTICES, 3))),
            "wanted 3 arrays of numbers",
        ),
    ],
)
def test_what_is_wrong_is_said_in_one_line(copy, spoil, complaint):
    spoil(copy)
    with pytest.raises(UserError, match=complaint) as told:
        read_release(open_release(copy), "walk")
    assert "\n" not in str(told.value)


def test_a_claim_of_ten_gigabytes_is_not_believed(tmp_path):
    save_arrays(tmp_path / "a.npy", np.zeros((3, 3)))
    whole = (tmp_path / "a.npy").read_bytes()
    (tmp_path / "a.npy").write_bytes(whole.replace(b"(3, 3), }         ", b"(416666666, 3), } "))
    with pytest.raises(UserError, match="an array of 9999999984 bytes where 72 are left"):
        read_arrays(tmp_path / "a.npy", 1)


def test_arrays_of_either_byte_order_and_layout(tmp_path):
    array = np.arange(12.0).reshape(4, 3)
    save_arrays(tmp_path / "a.npy", array.astype(">f8"), np.asfortranarray(array.astype("<f4")))
    for read in read_arrays(tmp_path / "a.npy", 2):
        np.testing.assert_array_equal(read, array)


READERS = {
    "uv_body/body_geo.obj": read_mesh,
    "uv_body/body_t_12_sample.txt": lambda p: read_samples(p, 10_000),
    "uv_tshirt/garment_uvMap_8.txt": lambda p: read_chart(p, VERTICES),
    "uv_tshirt/garment_16_vertPixel.txt": lambda p: read_sampling(p, VERTICES, 16),
    "uv_tshirt/garment_canc_normals.txt": read_vectors,
    "uv_tshirt/ind_B2O_10.txt": lambda p: read_groups(p, VERTICES),
    "TShirt_pnva/000002.npy": lambda p: read_arrays(p, 4),
}


@pytest.mark.parametrize("name", READERS)
@pytest.mark.filterwarnings("ignore")
def test_damaged_files_are_read_or_refused_in_one_line(written, tmp_path, name):
    whole, random, path = (written.folder / name).read_bytes(), np.random.default_rng(0), tmp_path / "spoilt"
    start = min(len(whole), 400)  # headers and counts are here
    places = [*random.integers(0, len(whole), 25), *random.integers(0, start, 50)]
    spoilt = [whole[:k] for k in (0, 1, 9, *random.integers(0, len(whole), 25))]
    spoilt += [whole[:k] + bytes([int(random.integers(256))]) + whole[k + 1 :] for k in places]
    spoilt += [whole[:k] + b"x" + whole[k:] for k in places[:10]] + [
        b"\x00" * 100,
        b"# 9999999999\n1 2 3\n",
        b"NaN " * 60,
    ]
    refused = 0
    for data in spoilt:
        path.write_bytes(data)
        try:
            READERS[name](path)
        except UserError as e:
            refused += 1
            assert "\n" not in str(e) and str(path) in str(e)
    assert refused >= 20
