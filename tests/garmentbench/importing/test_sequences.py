"""Import as it is typed: what is printed, what is refused, and that the file is a scene like any other."""

from dataclasses import replace

import numpy as np
import pytest
from exchange_example import MESHES, SEQUENCE, as_film, imported, positions_agree, typed

from garmentbench import sequence_file
from garmentbench.errors import UsageError, UserError
from garmentbench.evaluation.rollout import RollOut
from garmentbench.geometry.mesh import vertex_normals
from garmentbench.geometry.nearest import nearest_vertices
from garmentbench.importing.meshes.arrays import write_npz
from garmentbench.importing.meshes.conventions import Given
from garmentbench.importing.meshes.mesh_sequence import MeshSequence
from garmentbench.importing.meshes.obj import write_series, write_template
from garmentbench.importing.meshes.point_caches import write_mdd, write_pc2
from garmentbench.importing.sequences import Wanted, import_meshes
from garmentbench.motion.gait import GAITS
from garmentbench.motion.walk import walk
from garmentbench.scenes.bodies import load_body, pose
from garmentbench.scenes.garments import load_garment

CLOTH, BODY = MESHES["garment"], MESHES["body"]
FLIP = np.float32([-1, 1, 1])
PLAIN = Wanted("x", Given("m", "z", 25.0))


def film(folder):
    """Caches and templates in centimetres, y up, as Maya would write them."""
    for name, mesh in (("cloth", as_film(CLOTH)), ("figure", as_film(BODY))):
        write_pc2(folder / f"{name}.pc2", mesh)
        write_template(folder / f"{name}.obj", mesh)
    return ("import", "cloth.pc2", "--template", "cloth.obj", "--body", "figure.pc2", "--body-template", "figure.obj")


def swapped(mesh: MeshSequence) -> MeshSequence:
    """y and z swapped, which is a mirror image."""
    return replace(mesh, frames=mesh.frames[..., [0, 2, 1]], rest=mesh.still[:, [0, 2, 1]])


def test_meshes_with_y_and_z_swapped_are_mirrored_with_a_word():
    given = replace(PLAIN, given=Given("m", "y", 25.0))
    sequence, notes = import_meshes(*(replace(swapped(m), up=None) for m in (CLOTH, BODY)), given)
    plain, told = import_meshes(CLOTH, BODY, PLAIN)
    assert any("mirrored" in line and "y and z swapped" in line for line in notes)
    assert not any("mirrored" in line or "inwards" in line for line in told)
    np.testing.assert_allclose(sequence.garment, plain.garment, atol=1e-6)
    np.testing.assert_allclose(sequence.body, plain.body, atol=1e-6)
    np.testing.assert_array_equal(sequence.template.body.faces, plain.template.body.faces)
    np.testing.assert_allclose(sequence.template.garment.rest, plain.template.garment.rest, atol=1e-6)


def test_faces_of_the_garment_alone_are_turned():
    turned = replace(CLOTH, faces=CLOTH.faces[:, ::-1], corner_uv=CLOTH.corner_uv[:, ::-1])
    sequence, notes = import_meshes(turned, BODY, PLAIN)
    assert "faces of the garment pointed inwards: turned" in notes
    np.testing.assert_allclose(sequence.garment[0].min(axis=0), CLOTH.frames[0].min(axis=0), atol=1e-6)


def test_where_faces_point_outwards_the_hand_is_said_to_be_assumed():
    """A mirror image whose faces were turned can't be told from a symmetric body; nothing is claimed of it."""
    mirrored = [replace(m, frames=m.frames * FLIP, rest=m.still * FLIP, faces=m.faces[:, ::-1]) for m in (CLOTH, BODY)]
    for meshes in ((CLOTH, BODY), mirrored):
        _, notes = import_meshes(*meshes, PLAIN)
        assert any(line.startswith("handedness: right-handed axes assumed: faces point outwards") for line in notes)


def beside(mesh: MeshSequence, shift: float) -> MeshSequence:
    """Moved along x."""
    return replace(mesh, frames=mesh.frames + np.float32([shift, 0, 0]), rest=mesh.still + np.float32([shift, 0, 0]))


@pytest.mark.parametrize(
    ("matrix", "said"),
    [
        (np.diag([-1.0, 1, 1]), "x turned round"),
        (np.diag([1.0, -1, 1]), "y turned round"),
        (np.array([[1.0, 0, 0], [0, 0, 1], [0, 1, 0]]), "y and z swapped"),
        (np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, 1]]), "x and y swapped"),
    ],
)
def test_a_garment_that_fits_only_as_its_mirror_image_is_refused(home, capsys, matrix, said):
    """Its faces were turned outwards, so that these don't tell; garment and body stand off the origin."""
    away = [replace(beside(m, 0.7), frames=beside(m, 0.7).frames + np.float32([0, 0.4, 0])) for m in (CLOTH, BODY)]
    away = [replace(m, rest=None) for m in away]
    write_npz(home / "body.npz", away[1])
    turned = (away[0].frames @ matrix.T).astype(np.float32)
    write_npz(home / "cloth.npz", replace(away[0], frames=turned, faces=CLOTH.faces[:, ::-1]))
    code, out, err = typed(capsys, "import", "cloth.npz", "--body", "body.npz", "--out", "x.h5")
    assert code == 1 and len(err) == 1 and out == "" and not (home / "x.h5").exists()
    assert "garmentbench: cloth on body: " in err[0] and "of the garment's vertices lie inside the body" in err[0]
    assert f"but hardly one of its mirror image ({said})" in err[0]
    assert "export garment and body with the same axes" in err[0]


@pytest.mark.parametrize("write", ["npz", "obj", "pc2", "mdd"])
def test_how_much_is_inside_is_a_warning_and_most_of_it_an_error(home, capsys, write):
    """The garment made narrower by the tenth part, and by half."""
    for narrow, expected in ((0.84, 0), (0.5, 1)):
        cloth = replace(
            CLOTH, frames=CLOTH.frames * np.float32([1, narrow, 1]), rest=CLOTH.still * np.float32([1, narrow, 1])
        )
        call = []
        for mesh, name in ((cloth, "cloth"), (BODY, "figure")):
            option = [] if name == "cloth" else ["--body"]
            template = "--template" if name == "cloth" else "--body-template"
            if write == "npz":
                write_npz(home / f"{name}.npz", mesh)
                call += [*option, f"{name}.npz"]
            elif write == "obj":
                write_series(home / name, mesh)
                call += [*option, name]
            else:
                {"pc2": write_pc2, "mdd": write_mdd}[write](home / f"{name}.{write}", mesh)
                write_template(home / f"{name}.obj", mesh)
                call += [*option, f"{name}.{write}", template, f"{name}.obj"]
        code, out, err = typed(capsys, "import", *call, "--units", "m", "--up", "z", "--fps", "25", "--out", "x.h5")
        assert code == expected
        if expected:
            assert len(err) == 1 and "of the garment's vertices lie inside the body, wanted it worn; " in err[0]
        else:
            assert "warning: interpenetration: " in out and "do both have the same times, axes and unit" in out
            code, card, _ = typed(capsys, "card", "x.h5")
            assert "- warning: interpenetration: " in card


def test_the_depth_of_none_inside_is_no_number(home, capsys):
    write_npz(home / "cloth.npz", CLOTH)
    write_npz(home / "body.npz", BODY)
    assert typed(capsys, "import", "cloth.npz", "--body", "body.npz", "--out", "x.h5")[0] == 0
    card = typed(capsys, "card", "x.h5")[1]
    assert "| strict, by signed distance [%] | 0 |" in card and "| depth of those, 95th percentile [mm] | – |" in card


def test_the_body_as_its_own_garment_and_an_odd_name_to_write_to(home, capsys):
    write_npz(home / "body.npz", BODY)
    code, _, err = typed(capsys, "import", "body.npz", "--body", "body.npz", "--make-uv", "--out", "x.h5")
    assert code == 1 and "body.npz: garment and body are the same mesh, wanted one worn by the other; name" in err[0]
    code, _, err = typed(capsys, "import", "body.npz", "--out", "x.obj")
    assert code == 2 and err == ["garmentbench: --out is x.obj; wanted a name that ends in .h5"]


def dancer(frames: int = 16) -> tuple[MeshSequence, MeshSequence]:
    """A bodysuit that keeps to a body which steps aside, in a pose that is no mirror image of itself."""
    baked, suit = load_body("base", "small"), load_garment("bodysuit", "smoke")
    steps = walk(baked, GAITS["armspace-75"], 2 + np.arange(frames) / 12, np.ones(frames))
    root = steps.root + np.arange(frames)[:, None] * [0.08, 0.0, 0.0]
    skin = pose(baked, steps.rotations, root).astype(np.float32)
    distance, nearest = nearest_vertices(suit.rest, baked.body.rest)
    normals = np.stack([vertex_normals(x.astype(np.float64), baked.body.faces)[nearest] for x in skin])
    cloth = (skin[:, nearest] + 1.5 * np.maximum(distance, 0.012)[:, None] * normals).astype(np.float32)
    says = {"fps": 25.0, "unit": 1.0, "up": "z"}
    return (MeshSequence("suit", cloth, suit.faces, suit.uv[suit.faces], **says),
            MeshSequence("body", skin, baked.body.faces, **says))  # fmt: skip


def test_a_mirror_image_of_a_garment_is_known_by_its_body_s_motion(home, capsys):
    """In frame 0 it fits as well, on a body that is symmetric and stands over the origin."""
    cloth, body = dancer()
    write_npz(home / "body.npz", body)
    for faces in (cloth.faces, cloth.faces[:, ::-1]):
        write_npz(home / "cloth.npz", replace(cloth, frames=cloth.frames * FLIP, faces=faces))
        code, _, err = typed(capsys, "import", "cloth.npz", "--body", "body.npz", "--out", "x.h5")
        assert code == 1 and len(err) == 1 and "mirror image (x turned round); export garment and body" in err[0]
    both = [replace(m, frames=m.frames * FLIP) for m in (cloth, body)]  # faces inwards
    sequence, notes = import_meshes(*both, Wanted("x"))
    assert any(line.endswith("mirrored") for line in notes)
    turned = sequence.body - body.frames * np.float32([1, -1, 1]) * FLIP  # by half a turn, which is no matter
    assert np.abs(turned).max() < 1e-5


@pytest.mark.parametrize("late", [5, -3])
def test_a_garment_that_is_late_is_told_by_how_many_frames(home, capsys, late):
    """Without times in its file."""
    cloth, body = dancer()
    moved = np.clip(np.arange(len(cloth.frames)) + late, 0, len(cloth.frames) - 1)
    write_npz(home / "body.npz", body)
    write_npz(home / "cloth.npz", replace(cloth, frames=cloth.frames[moved]))
    code, out, _ = typed(capsys, "import", "cloth.npz", "--body", "body.npz", "--out", "x.h5")
    assert code == 0 and f"it fits the body {late:+d} frames away" in out


def test_a_garment_of_no_garment_s_size_is_asked_about(home, capsys):
    cloth = replace(CLOTH, frames=CLOTH.frames / np.float32(0.0254), rest=None, unit=None, up=None)
    write_npz(home / "cloth.npz", replace(cloth, unit=1.0, up="z"))
    write_npz(home / "body.npz", BODY)
    code, _, err = typed(capsys, "import", "cloth.npz", "--body", "body.npz", "--out", "x.h5")
    assert (
        code == 1 and len(err) == 1 and "cloth.npz: the garment measures" in err[0] and "wanted 0.05 to 8 m" in err[0]
    )
    assert "give --units, for " in err[0] and "in (0." in err[0] and "--body-units" in err[0]


def test_a_garment_beside_its_body_gets_no_reassuring_number(home, capsys):
    write_npz(home / "cloth.npz", beside(CLOTH, 2.0))
    write_npz(home / "body.npz", BODY)
    code, out, _ = typed(capsys, "import", "cloth.npz", "--body", "body.npz", "--out", "x.h5")
    assert code == 0 and "warning: frame 0: 'body' doesn't go through most of the garment's openings" in out
    assert (
        "interpenetration" not in out
        and "moved by (-2, 0, 0) m would bring it on: move it in the program that it comes from" in out
    )
    code, out, err = typed(capsys, "check", "x.h5")
    assert code == 1 and "error: frame 0: 'body' doesn't go through" in out and "good" not in out
    code, out, _ = typed(capsys, "card", "x.h5")
    assert "- warning: frame 0: 'body' doesn't go through" in out
    assert "| strict, by signed distance [%] | not measured |" in out


@pytest.mark.parametrize(("factor", "said"), [(2.54, "cm taken for in"), (100 / 30.48, "ft taken for m")])
def test_a_garment_of_another_unit_than_its_body_is_told(home, capsys, factor, said):
    """Of a body of no stated unit nothing can be told; none of the garment is inside it."""
    shirt, base = load_garment("tshirt", "smoke"), load_body("base", "small").body
    uv = shirt.uv[shirt.faces]
    cloth = MeshSequence("shirt", (factor * shirt.rest)[None].astype(np.float32), shirt.faces, uv, fps=25.0, up="z")
    write_npz(home / "cloth.npz", replace(cloth, unit=1.0))
    write_npz(home / "body.npz", MeshSequence("body", base.rest[None], base.faces, fps=25.0, up="z", unit=1.0))
    code, out, _ = typed(capsys, "import", "cloth.npz", "--body", "body.npz", "--out", "x.h5")
    assert code == 0 and f"worn at {1 / factor:.3g} times its size: {said}?" in out and "interpenetration" not in out
    assert typed(capsys, "check", "x.h5")[0] == 1


def test_a_garment_that_slips_off_later_is_told(home, capsys):
    """As where the body moves at another rate than the garment."""
    along = np.linspace(0, 2, len(CLOTH.frames))[:, None, None].astype(np.float32)
    write_npz(home / "cloth.npz", replace(CLOTH, frames=CLOTH.frames + along))
    write_npz(home / "body.npz", BODY)
    code, out, _ = typed(capsys, "import", "cloth.npz", "--body", "body.npz", "--out", "x.h5")
    assert code == 0 and "warning: frame 2: worn in frame 0, but here 'body' doesn't go through" in out
    code, out, _ = typed(capsys, "check", "x.h5")
    assert code == 0 and "warning: frame 2: worn in frame 0" in out
    assert out.splitlines()[-1] == "x.h5: whole, but not worn from frame 2 on at the latest: see the warnings"


@pytest.mark.parametrize("which", ["garment", "body"])
def test_spare_vertices_are_left_out_by_number_and_decide_nothing(which):
    """One a kilometre away, one that isn't finite: neither says anything of unit, axes and rest shape."""
    spoilt = {}
    for name, mesh in (("garment", CLOTH), ("body", BODY)):
        frames, rest, faces, pins = mesh.frames, mesh.still, mesh.faces, mesh.pins
        if name == which:
            spare = np.float32([[1e3, 0, 0], [np.nan, 0, 0]])
            frames = np.concatenate([np.tile(spare[None], (len(frames), 1, 1)), frames], axis=1)
            rest, faces, pins = np.concatenate([spare, rest]), faces + 2, np.array([0, 7])
        spoilt[name] = replace(mesh, frames=frames, rest=rest, faces=faces, pins=pins, unit=None, up=None)
    sequence, notes = import_meshes(spoilt["garment"], spoilt["body"], Wanted("x", Given(fps=25.0)))
    plain, _ = import_meshes(CLOTH, BODY, PLAIN)
    assert sum("2 vertices without a face left out" in line for line in notes) == 1
    np.testing.assert_allclose(sequence.garment, plain.garment, atol=1e-6)
    np.testing.assert_allclose(sequence.body, plain.body, atol=1e-6)
    if which == "garment":
        assert sequence.template.garment.pins.tolist() == [5]
    bad = spoilt[which].frames.copy()
    bad[3, 40, 1] = np.nan
    with pytest.raises(UserError, match="frame 3, vertex 40 is at"):
        import_meshes(**{**spoilt, which: replace(spoilt[which], frames=bad)}, wanted=PLAIN)


def test_a_body_of_another_unit_and_axis_than_its_garment(home):
    body = replace(
        as_film(BODY), frames=as_film(BODY).frames / np.float32(2.54), rest=as_film(BODY).rest / np.float32(2.54)
    )
    cloth = replace(CLOTH, unit=None, up=None)
    sequence, notes = import_meshes(cloth, body, replace(PLAIN, given=Given("m", "z", 25.0, "in", "y")))
    assert notes[:2] == ["units: m, of the body in (given)", "up: z, of the body y (given)"]
    np.testing.assert_allclose(sequence.body, BODY.frames, atol=1e-5)
    np.testing.assert_allclose(sequence.garment[:, 0], CLOTH.frames[:, 0], atol=1e-6)
    sequence, notes = import_meshes(cloth, body, replace(PLAIN, given=Given(None, "z", 25.0, "in", "y")))
    assert notes[0].startswith("units: m (inferred: the garment's diagonal") and notes[0].endswith(
        "of the body in (given)"
    )
    with pytest.raises(UsageError, match="--body-units is 'inch'; wanted m, cm, mm, in, ft"):
        Given(body_units="inch")


def test_without_a_body_the_hand_is_said_to_be_assumed():
    _, notes = import_meshes(CLOTH, None, PLAIN)
    assert "handedness: right-handed axes assumed; there is no body whose faces would tell" in notes


def test_a_film_s_caches_become_the_sequence_they_were(home, capsys):
    code, out, complaints = typed(
        capsys, *film(home), "--fps", "25", "--split", "test", "--body-name", "me", "--out", "my.h5"
    )
    assert (code, complaints) == (0, [])
    assert out.splitlines()[:3] == [
        "units: cm (inferred: body height 160)",
        "up: y (inferred: the body measures 39.7 x 160 x 31.8)",
        "fps: 25 (given)",
    ]
    assert "interpenetration: 0 % of the garment's vertices lie inside the body" in out
    read = imported(home / "my.h5")
    assert positions_agree(read, SEQUENCE, within=1e-6)
    template, info = read.template, read.info
    assert (template.fps, template.garment.name, template.body.name, template.body.labels) == (
        25.0,
        "cloth",
        "me",
        None,
    )
    assert (info["scene"], info["split"], read.spread_cm) == ("my", "test", None)
    assert not template.needs.part_radii and template.needs.body
    files = info["imported"]["files"]
    assert (
        files["garment"]["first"] == "cloth.pc2"
        and files["garment"]["count"] == 2
        and len(files["body"]["sha256"]) == 64
    )


def test_what_the_user_asks_for_is_asked_for(home, capsys):
    code, _, complaints = typed(capsys, *film(home), "--out", "my.h5")
    assert code == 1 and complaints == [
        "garmentbench: fps: the files don't say how many frames a second they have; give --fps, e.g. --fps 30"
    ]
    code, _, complaints = typed(capsys, "import", "cloth.pc2", "--out", "my.h5")
    assert (
        code == 1
        and "holds positions only, wanted faces and UV too; give an OBJ file of the same mesh (--template)"
        in complaints[0]
    )
    code, _, complaints = typed(capsys, "import", "cloth.fbx", "--out", "my.h5")
    assert code == 2 and "what is '.fbx'? Read here are" in complaints[0]
    assert not (home / "my.h5").exists()


def test_from_import_to_evaluation(home, capsys):
    """The whole road, as typed; an imported file stands wherever a scene's name does."""
    from garmentbench.evaluation.toy import tiny_sequence

    for name, phase in (("train", 0.0), ("test", 1.0)):
        sequence = tiny_sequence(12, phase=phase)
        for part, mesh in (
            ("cloth", replace(CLOTH, frames=sequence.garment)),
            ("figure", replace(BODY, frames=sequence.body)),
        ):
            write_mdd(home / f"{part}.mdd", replace(mesh, fps=30.0))
            write_template(home / f"{part}.obj", mesh)
        code, out, _ = typed(
            capsys,
            "import",
            "cloth.mdd",
            "--template",
            "cloth.obj",
            "--body",
            "figure.mdd",
            "--body-template",
            "figure.obj",
            "--out",
            f"{name}.h5",
        )
        assert code == 0 and "fps: 30 (as the file says)" in out
    assert typed(capsys, "check", "train.h5")[0] == 0
    small = ("--preset", "smoke", "--frames", "12", "--device", "cpu")
    code, out, complaints = typed(capsys, "train", "skinning", "--scene", "train.h5", *small)
    assert code == 0, complaints
    code, out, complaints = typed(
        capsys, "evaluate", "skinning", "--train-scene", "train.h5", "--scene", "test.h5", *small
    )
    assert code == 0 and "rollout_l2" in out, complaints
    run = out.splitlines()[-1].split(":")[0]
    code, _, complaints = typed(capsys, "export", run, "--to", "npz", "--out", "back")
    assert code == 1 and "name it with --sequence" in complaints[0]
    code, _, complaints = typed(capsys, "export", run, "--to", "npz", "--out", "back", "--sequence", "train.h5")
    assert code == 1 and "was evaluated on another sequence than train.h5" in complaints[0]
    code, out, _ = typed(capsys, "export", run, "--to", "npz", "--out", "back", "--sequence", "test.h5")
    assert code == 0 and out.splitlines() == ["back/garment.npz", "back/body.npz"]
    with np.load(home / "back" / "garment.npz") as arrays:
        np.testing.assert_array_equal(arrays["positions"], RollOut.load(home / "runs" / run / "rollout.h5").garment)
    code, _, complaints = typed(capsys, "train", "skinning", "--scene", "nothing.h5", *small)
    assert code == 1 and "nothing.h5: no such file" in complaints[0]


def test_a_sequence_file_is_taken_as_it_is(home, capsys):
    sequence_file.save(SEQUENCE, home / "a.h5")
    code, out, _ = typed(
        capsys, "import", "a.h5", "--frames", "4", "--split", "test", "--name", "gown", "--out", "b.h5"
    )
    read = imported(home / "b.h5")
    assert code == 0 and "taken as it is: 4 frames" in out and len(read) == 4
    assert read.template.body.part_names == ("lower", "upper") and read.template.garment.name == "gown"
    np.testing.assert_array_equal(read.garment, SEQUENCE.garment[:4])
    code, _, complaints = typed(capsys, "import", "a.h5", "--up", "y", "--out", "c.h5")
    assert code == 2 and "says all of itself" in complaints[0]


def test_a_frame_that_stands_still(home):
    still = replace(BODY, frames=BODY.frames[:1])
    sequence, notes = import_meshes(CLOTH, still, PLAIN)
    assert "the body has one frame: it stands still" in notes
    np.testing.assert_array_equal(sequence.body, np.repeat(BODY.frames[:1], 6, axis=0))


def test_frames_that_do_not_fit(home):
    short = replace(BODY, frames=BODY.frames[:5])
    with pytest.raises(
        UserError, match="the garment has 6 frames, the body 5; export the same frames of both, or give --frames 5"
    ):
        import_meshes(CLOTH, short, PLAIN)
    assert len(import_meshes(CLOTH, short, replace(PLAIN, frames=5))[0]) == 5
    with pytest.raises(UsageError, match="--frames is 7; the garment has 6"):
        import_meshes(CLOTH, None, replace(PLAIN, frames=7))


@pytest.mark.parametrize("value", [np.nan, np.inf, 3e30])
def test_no_number_is_named_by_file_frame_and_vertex(home, value):
    frames = CLOTH.frames.copy()
    frames[3, 40, 1] = value
    write_npz(home / "bad.npz", replace(CLOTH, frames=frames))
    from garmentbench.importing.meshes.arrays import read_npz

    with pytest.raises(UserError, match=r"bad.npz: frame 3, vertex 40 is at \(.*\), wanted finite positions"):
        import_meshes(read_npz(home / "bad.npz"), None, PLAIN)


def test_a_template_with_other_axes_is_turned_and_told(home):
    lying = replace(CLOTH, rest=as_film(CLOTH).rest / 100)
    sequence, notes = import_meshes(lying, BODY, PLAIN)
    np.testing.assert_allclose(sequence.template.garment.rest, CLOTH.rest, atol=1e-6)
    assert "rest shape of garment: turned from y up to z up, as the recording lies" in notes


def test_a_recording_that_walks_and_turns_keeps_its_rest_shape(home):
    c, s = np.cos(2.0), np.sin(2.0)
    turned = replace(
        CLOTH, frames=(CLOTH.frames @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [3, 4, 0]).astype(np.float32)
    )
    sequence, notes = import_meshes(turned, None, PLAIN)
    np.testing.assert_array_equal(sequence.template.garment.rest, CLOTH.rest)
    assert not any("turned" in line for line in notes)


def test_a_body_inside_out_is_turned(home):
    sequence, notes = import_meshes(CLOTH, replace(BODY, faces=BODY.faces[:, ::-1]), PLAIN)
    assert "faces of the body pointed inwards: turned" in notes
    assert not any("inwards" in line for line in import_meshes(CLOTH, BODY, PLAIN)[1])
    assert {frozenset(f) for f in sequence.template.body.faces.tolist()} == {frozenset(f) for f in BODY.faces.tolist()}


def test_a_wrong_unit_in_a_file_is_noticed(home):
    with pytest.raises(
        UserError, match="the body measures 0.016 m when its unit is cm, wanted 0.5 to 3 m; give --units"
    ):
        import_meshes(replace(CLOTH, unit=0.01), replace(BODY, unit=0.01), Wanted("x", Given(None, "z", 25.0)))


def test_a_body_elsewhere_is_told(home):
    _, notes = import_meshes(CLOTH, replace(BODY, frames=BODY.frames + np.float32(5)), PLAIN)
    assert any(line.startswith("warning: the garment is") and "away from the body" in line for line in notes)


def test_an_obj_series_without_template_rests_as_it_begins(home, capsys):
    write_series(home / "cloth", CLOTH)
    code, out, _ = typed(capsys, "import", "cloth", "--units", "m", "--up", "z", "--fps", "25", "--out", "a.h5")
    assert code == 0 and "cloth: its first frame is its rest shape" in out
    read = imported(home / "a.h5")
    np.testing.assert_array_equal(read.template.garment.rest, read.garment[0])
    assert read.body is None and read.template.garment.name == "cloth"


def test_making_uv_as_asked(home, capsys):
    pytest.importorskip("xatlas", reason="xatlas is an extra")
    write_npz(home / "cloth.npz", replace(CLOTH, corner_uv=None))
    code, _, complaints = typed(capsys, "import", "cloth.npz", "--out", "a.h5")
    assert (
        code == 1
        and "has no UV map, which the methods need; unwrap the garment and export UV, or give --make-uv"
        in complaints[0]
    )
    code, out, _ = typed(capsys, "import", "cloth.npz", "--make-uv", "--out", "a.h5")
    assert code == 0 and "UV map made by xatlas" in out
    assert typed(capsys, "check", "a.h5")[0] == 0


def test_pins_stay_with_their_vertices(home):
    sequence, _ = import_meshes(replace(CLOTH, pins=np.array([5, 9])), BODY, PLAIN)
    assert sequence.template.garment.pins.tolist() == [5, 9] and sequence.template.needs.pins
