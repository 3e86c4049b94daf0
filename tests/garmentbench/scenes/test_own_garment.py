"""Garments of the user's own: read from OBJ and .npz, pinned, sewn, in a wardrobe or on the command line."""

from dataclasses import replace

import numpy as np
import pytest
from poncho import AROUND, RINGS, write_poncho

from garmentbench import sequence_file
from garmentbench.cli import main
from garmentbench.errors import UserError
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.reference import Reference, reference_identity, resolve_source
from garmentbench.scenes.garment_file import read_garment
from garmentbench.scenes.garments import garment_names, load_garment
from garmentbench.scenes.presets import preset
from garmentbench.scenes.scene import MeshFile
from garmentbench.scenes.wardrobe import load_scene, scene_names

SMOKE = preset("smoke")
PANELS = """
v 0 0 1
v .1 0 1
v .1 0 1.1
v 0 0 1.1
v .1 0 1
v .2 0 1
v .2 0 1.1
v .1 0 1.1
vt 0 0
vt .4 0
vt .4 .4
vt 0 .4
vt .5 .5
vt .9 .5
vt .9 .9
vt .5 .9
g left
f 1/1 2/2 3/3 4/4
g right band
f 5/5 6/6 7/7 8/8
"""


@pytest.mark.parametrize(
    ("old", "new", "listed"),
    [
        ("g left\n", "o shirt\n", "shirt, body"),
        ("g left\n", "", "(without a name), body"),
        ("g left\n", "g shirt\n", "shirt, body"),
    ],
)
def test_two_objects_are_no_garment(home, capsys, old, new, listed):
    """A shirt and a body in one file were one cloth; groups are two things only where their names say so."""
    kind = "g" if "g shirt" in new else "o"
    text = PANELS.replace(old, new).replace("g right band\n", f"{kind} body\n")
    (home / "two.obj").write_text(text)
    code, _, err = typed(capsys, "simulate", "--garment", "two.obj", "--frames", "4", "--preset", "smoke")
    assert code == 1 and f"two.obj: holds 2 objects ({listed}), wanted one garment; `garmentbench check" in err
    if "shirt" in new and kind == "o":
        assert "--mesh 'shirt' --fix OUT.npz" in err
        assert typed(capsys, "check", "two.obj", "--mesh", "shirt", "--fix", "one.npz", "--make-uv")[0] in (0, 1)
        assert read_garment("one", MeshFile(str(home / "one.npz"))).faces.shape == (2, 3)


@pytest.fixture
def home(tmp_path, monkeypatch):
    """The working folder, an exported body and a poncho in it."""
    monkeypatch.chdir(tmp_path)
    assert main(["bodies", "export", "base", "body.obj", "--size", "small"]) == 0
    write_poncho(tmp_path / "poncho.obj", tmp_path / "body.obj")
    return tmp_path


def typed(capsys, *arguments: str) -> tuple[int, str, str]:
    capsys.readouterr()
    return main(arguments), *capsys.readouterr()


def panels(folder, **choices):
    (folder / "panels.obj").write_text(PANELS)
    return read_garment("panels", MeshFile(str(folder / "panels.obj"), **choices))


def test_panels_are_sewn_where_their_borders_touch(tmp_path):
    garment = panels(tmp_path)
    assert garment.rest.shape == (8, 3) and len(garment.faces) == 4 and garment.uv.max() < 1
    assert garment.seams.tolist() == [[1, 4], [2, 7]] and len(garment.pins) == 0
    assert len(panels(tmp_path, seams="file").seams) == 0
    assert panels(tmp_path, seams=((0, 5), (3, 6))).seams.tolist() == [[0, 5], [3, 6]]


def test_pins_are_the_top_a_group_of_faces_or_vertices(tmp_path):
    assert panels(tmp_path, pins="top 1 cm").pins.tolist() == [2, 3, 6, 7]
    assert panels(tmp_path, pins="band").pins.tolist() == panels(tmp_path, pins="right").pins.tolist() == [4, 5, 6, 7]
    assert panels(tmp_path, pins=(7, 0, 7)).pins.tolist() == [0, 7]
    with pytest.raises(UserError, match="unknown group of faces to pin 'bamd': did you mean 'band'"):
        panels(tmp_path, pins="bamd")
    with pytest.raises(UserError, match="pins name vertices 3 to 8; wanted 0 to 7"):
        panels(tmp_path, pins=(3, 8))


def test_obj_is_read_as_programs_write_it(tmp_path):
    """Byte order marks, comments, colours, indented and continued lines, numbers from the end."""
    vertices = "\ufeffv 0 0 0 1 0 0\n# a\n\tv .1 0 0\nv \\\n.1 0 .1\nv 0 0 .1\nvt 0 0\nvt 1 0\nvt 1 1\n"
    text = vertices + "f -4/-3/1 -3/-2/1 -2/-1/1 -1/3/1\n"
    (tmp_path / "odd.obj").write_text(text, "utf-8")
    garment = read_garment("odd", MeshFile(str(tmp_path / "odd.obj")))
    assert garment.faces.tolist() == [[0, 1, 2], [0, 2, 3]] and len(garment.rest) == 4


def test_a_mesh_without_uv_gets_a_map_and_pins_follow_its_cuts(home):
    garment = read_garment("poncho", MeshFile("poncho.obj", pins="collar"))
    assert garment.uv.min() >= 0 and garment.uv.max() <= 1
    names = np.arange(len(garment.rest))
    names[garment.seams[:, 1]] = garment.seams[:, 0]
    assert len(np.unique(names)) == AROUND * RINGS and len(np.unique(names[garment.pins])) == 2 * AROUND


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "no vertices or no faces"),
        ("v 0 0 one\n", "line 1 is 'v 0 0 one', wanted OBJ"),
        ("v 0\n", "line 1 is 'v 0', wanted OBJ"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "names a vertex or UV that is not there"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/2 3/1\n", "names a vertex or UV that is not there"),
        ("v 0 0 0\nv 100 0 0\nv 0 100 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n", "141 m across"),
        ("v 0 0 0\nv 1 0 0\nv 0 nan 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n", "not finite"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 7 0\nvt 0 1\nf 1/1 2/2 3/3\n", "leaves the unit square"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n", "1 vertices belong to no face"),
    ],
)
def test_what_can_not_be_worn_is_one_line(tmp_path, text, complaint):
    (tmp_path / "odd.obj").write_text(text)
    with pytest.raises(UserError) as error:
        read_garment("odd", MeshFile(str(tmp_path / "odd.obj")))
    assert complaint in str(error.value) and "\n" not in str(error.value)


def test_npz_is_read_as_check_writes_it_and_refused_where_it_is_not(home, capsys):
    assert typed(capsys, "check", "poncho.obj", "--fix", "poncho.npz")[0] == 0
    garment = read_garment("poncho", MeshFile("poncho.npz"))
    with np.load("poncho.npz") as stored:
        for key in ("rest", "faces", "uv", "pins"):
            np.testing.assert_array_equal(getattr(garment, key), stored[key])
    np.savez("odd.npz", rest=garment.rest, faces=garment.faces)
    for file, complaint in (
        ("odd.npz", "uv is missing"),
        ("none.npz", "no such file"),
        ("poncho.fbx", "wanted a mesh"),
    ):
        with pytest.raises(UserError, match=complaint):
            read_garment("odd", MeshFile(file))


def test_a_baked_garment_read_as_a_file_is_the_same(tmp_path):
    baked = load_garment("over_skirt", "smoke")
    arrays = {key: getattr(baked, key) for key in ("rest", "faces", "uv", "seams", "pins")}
    np.savez(tmp_path / "skirt.npz", **arrays)
    read = read_garment("over_skirt", MeshFile(str(tmp_path / "skirt.npz")))
    np.testing.assert_array_equal(read.rest, baked.rest)
    np.testing.assert_array_equal(read.pins, baked.pins)
    assert len(read.seams) == len(baked.seams)


def test_an_entry_of_the_own_wardrobe_makes_the_whole_grid(home, capsys):
    """... of scenes; the mesh is named relative to the file, and counts by its contents, not by where it lies."""
    entry = '[garments.poncho]\nmesh = {file = "poncho.obj", pins = "collar"}\nmaterial = {bending = 1e-4}\n'
    (home / "wardrobe.toml").write_text(entry + "[motions]\nstill = {split = 'test', frames = 30}\n")
    names = {"poncho-armspace-75", "poncho-catwalk-slim", "poncho-still-tall", "dress-still"}
    assert names <= set(scene_names())
    scene = resolve_source("poncho-still-tall")
    assert (scene.body, scene.frames, scene.material.bending) == ("tall", 30, 1e-4)
    code, out, _ = typed(capsys, "scenes", "garment=poncho", "split=train")
    assert code == 0 and "poncho-armspace-75" in out
    (home / "elsewhere").mkdir()
    for file in ("wardrobe.toml", "poncho.obj"):
        (home / file).rename(home / "elsewhere" / file)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("GARMENTBENCH_HOME", str(home / "elsewhere"))
        moved = load_scene("poncho-still-tall")
        assert moved.mesh != scene.mesh and reference_identity(moved, SMOKE)
        first = reference_identity(moved, SMOKE)
        write_poncho(home / "elsewhere" / "poncho.obj", home / "body.obj", scale=1.01)
        assert reference_identity(moved, SMOKE) != first


@pytest.mark.parametrize(
    ("entry", "complaint"),
    [
        ("[garments.tshirt]\n", "garments.tshirt is the suite's name"),
        ("[garments.sheet]\n", "garments.sheet is the suite's name"),
        ("[motions]\nfast = {split = 'test', frames = 9}\n", "motions.fast is the suite's name"),
        ("[garments.poncho]\nmesh = 3\n", "garments.poncho.mesh is 3; wanted a text in quotes or a table"),
        (
            "[garments.poncho]\nmesh = {pins = 'top 3 cm'}\n",
            "garments.poncho.mesh: file is missing; wanted a text in quotes",
        ),
        ("[garments.poncho]\nmesh = {file = 'a.obj', pins = 3}\n", "garments.poncho.mesh.pins is 3; wanted a text"),
        ("[garments.poncho]\nmesh = {file = 'a.obj', pinz = 3}\n", "did you mean 'pins'?"),
        (
            "[garments.poncho]\nmaterial = {bending = 1e-4}\n",
            "garments.poncho.mesh is missing; wanted the garment's file",
        ),
        ("[garments.poncho]\nmesh = 'a.obj'\nworn_over = 'tshrt'\n", "did you mean 'tshirt'?"),
        ("[garments.cape]\nmesh = 'a.obj'\nworn_over = 'over_skirt'\n", "itself worn over 'dress'"),
        ("[motions]\nnope = {split = 'test', frames = 9}\n", "motions: unknown motion 'nope': Known: armspace-60, "),
        ("[motions]\nstick-a = {split = 'test', frames = 9}\n", "motions: unknown motion 'stick-a'"),
        ("[bodies.nope]\n", "bodies: unknown body 'nope'; `garmentbench bodies` lists all"),
        ("[garments.my-poncho]\n", "a garment is called 'my-poncho'; wanted letters, digits and _"),
    ],
)
def test_a_wrong_entry_is_one_line(home, capsys, entry, complaint):
    (home / "wardrobe.toml").write_text(entry)
    code, out, err = typed(capsys, "scenes")
    assert code == 1 and out == "" and err.count("\n") == 1 and "wardrobe.toml: " in err and complaint in err


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("--motion", "still", "--body", "tall"), "`--garment poncho`, or rename poncho.obj"),
        (("--motion", "catwalk", "--body", "slim"), "`simulate poncho-catwalk-slim`, or rename poncho.obj"),
        (("--motion", "rnu"), "did you mean 'run'"),
        (("--body", "tal"), "did you mean 'tall'"),
    ],
)
def test_a_garment_of_the_wardrobe_given_as_a_file_is_told_what_to_do(home, capsys, arguments, complaint):
    (home / "wardrobe.toml").write_text('[garments.poncho]\nmesh = "poncho.obj"\n')
    code, _, err = typed(capsys, "simulate", "--garment", "poncho.obj", *arguments, "--preset", "smoke")
    assert code == 2 and err.count("\n") == 1 and complaint in err and not (home / "scenes").exists()
    assert ("'poncho' is already a garment" in err) == ("rename" in complaint)


@pytest.mark.parametrize(("cm", "warned"), [(3.9, True), (0.2, False)])
def test_a_spread_in_which_errors_drown_is_warned_of(home, capsys, monkeypatch, cm, warned):
    """... with the words of the data card's known flaws, and what to do."""
    sequence = tiny_sequence(8)
    sequence_file.save(replace(sequence, info={**sequence.info, "ensemble": {"spread_cm": cm}}), home / "a.h5")
    reference = Reference("sheet-stick-a", home / "a.h5", "")
    monkeypatch.setattr("garmentbench.reference.make_reference", lambda *_: reference)
    code, out, _ = typed(capsys, "simulate", "sheet-stick-a", "--preset", "smoke")
    warning = (
        "sheet-stick-a: warning: Two runs of it are 3.9 cm apart, more than 1 cm. Errors below it mean nothing: raise"
    )
    assert code == 0 and (warning in out) == warned and ("warning" in out) == warned


@pytest.mark.parametrize("name", ["dress-catwalk", "tshirt-still"])
def test_an_own_scene_never_stands_in_for_one_of_the_suite(home, capsys, name):
    (home / "scenes").mkdir()
    (home / "scenes" / f"{name}.toml").write_text('garment = "tshirt"\nbody = "base"\nmotion = "fast"\n')
    code, _, err = typed(capsys, "scenes", "show", name)
    assert code == 1 and f"{name}.toml: '{name}' is a scene of the suite; rename the file" in err


def test_a_garment_file_on_the_command_line_becomes_a_scene_with_a_name(home, capsys, monkeypatch):
    monkeypatch.setattr("garmentbench.reference._simulated", None)  # nothing is simulated here
    given = ("--garment", "poncho.obj", "--motion", "catwalk", "--body", "slim", "--frames", "30")
    with pytest.raises(TypeError):
        main(["simulate", *given, "--pins", "collar", "--preset", "smoke"])
    scene = load_scene("poncho-catwalk-slim")
    assert (scene.garment, scene.body, scene.frames, scene.split) == ("poncho", "slim", 30, "test")
    assert scene.mesh == MeshFile((home / "poncho.obj").as_posix(), "collar")
    assert typed(capsys, "scenes", "show", "poncho-catwalk-slim")[0] == 0
    code, _, err = typed(capsys, "simulate", *given[:-1], "40", "--preset", "smoke")
    assert code == 1 and "scenes/poncho-catwalk-slim.toml: has been written before and differs" in err


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("--garment", "ponco.obj"), "ponco.obj: No such file"),
        (("--garment", "ponco"), "unknown garment 'ponco'"),
        (("--garment", "poncho.obj", "--motion", "catwlk"), "did you mean 'catwalk'?"),
        (("--garment", "poncho.obj", "--motion", "walk.npz"), "walk.npz: no such file"),
        (("--garment", "poncho.obj", "--motion", "body.obj"), "garmentbench import-motion"),
        (("--garment", "poncho.obj", "--body", "tal"), "did you mean 'tall'?"),
        (("--garment", "poncho.obj", "--frames", "2"), "--frames is 2; wanted at least 4"),
        (("--garment", "poncho.obj", "--all"), "give it without names"),
        (("--garment", "tshirt", "--pins", "top 3 cm"), "--pins says what is pinned of your own mesh"),
        (("--garment", "poncho.obj", "--pins", "colar"), "did you mean 'collar'?"),
    ],
)
def test_a_wrong_call_leaves_nothing_behind(home, capsys, arguments, complaint):
    code, _, err = typed(capsys, "simulate", *arguments, "--preset", "smoke")
    assert code in (1, 2) and err.count("\n") == 1 and complaint in err and not (home / "scenes").exists()


def test_no_garment_is_suggested_for_itself(tmp_path, monkeypatch):
    """A garment that lacks a size was "unknown: did you mean" itself."""
    monkeypatch.setattr("garmentbench.scenes.garments.GARMENTS", tmp_path)
    (tmp_path / "poncho-laptop.npz").write_bytes(b"")
    assert garment_names() == ["poncho"]
    with pytest.raises(UserError, match="garment 'poncho' has no mesh of size smoke; it has laptop"):
        load_garment("poncho", "smoke")


def test_bodies_are_exported_in_metres_at_rest(home, capsys):
    points = [line.split()[1:] for line in (home / "body.obj").read_text().splitlines() if line.startswith("v ")]
    height = np.ptp(np.array(points, float)[:, 2])
    assert 1.7 < height < 1.9
    assert typed(capsys, "bodies", "export", "slim", "slim.ply")[0] == 0
    assert typed(capsys, "check", "slim.ply")[1].startswith("slim.ply: 13348 vertices")
    for wrong, complaint in (
        (("base",), "which body, and where to?"),
        (("bse", "a.obj"), "did you mean 'base'?"),
        (("base", "a.fbx"), "ends in .obj or .ply"),
    ):
        code, _, err = typed(capsys, "bodies", "export", *wrong)
        assert code == 2 and complaint in err


def test_scenes_are_named_wherever_a_file_goes(home, capsys):
    (home / "short.toml").write_text('garment="sheet"\nbody="stick"\nmotion="stick-a"\nsplit="test"\nframes=5\n')
    (home / "scenes").mkdir()
    (home / "short.toml").rename(home / "scenes" / "short.toml")
    assert "# Data card: short (smoke)" in typed(capsys, "card", "short", "--preset", "smoke")[1]
    assert typed(capsys, "export", "short", "--preset", "smoke", "--to", "npz", "--out", "out")[0] == 0
    assert "nothing was evaluated on short" in typed(capsys, "view", "short")[2]
    for command in (
        ("card", "shrt"),
        ("export", "shrt", "--to", "npz", "--out", "o"),
        ("train", "hold", "--scene", "shrt"),
    ):
        assert "did you mean 'short'?" in typed(capsys, *command)[2]
