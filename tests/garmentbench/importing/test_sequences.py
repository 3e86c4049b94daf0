"""Import as it is typed: what is printed, what is refused, and that the file is a scene like any other."""

from dataclasses import replace

import numpy as np
import pytest
from exchange_example import MESHES, SEQUENCE, as_film, imported, positions_agree, typed

from garmentbench import sequence_file
from garmentbench.evaluation.rollout import RollOut
from garmentbench.importing.meshes.arrays import write_npz
from garmentbench.importing.meshes.conventions import Given
from garmentbench.importing.meshes.obj import write_series, write_template
from garmentbench.importing.meshes.point_caches import write_mdd, write_pc2
from garmentbench.importing.sequences import Wanted, import_meshes

CLOTH, BODY = MESHES["garment"], MESHES["body"]
PLAIN = Wanted("x", Given("m", "z", 25.0))


def film(folder):
    """Caches and templates in centimetres, y up, as Maya would write them."""
    for name, mesh in (("cloth", as_film(CLOTH)), ("figure", as_film(BODY))):
        write_pc2(folder / f"{name}.pc2", mesh)
        write_template(folder / f"{name}.obj", mesh)
    return ("import", "cloth.pc2", "--template", "cloth.obj", "--body", "figure.pc2", "--body-template", "figure.obj")


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


def test_the_body_as_its_own_garment_and_an_odd_name_to_write_to(home, capsys):
    write_npz(home / "body.npz", BODY)
    code, _, err = typed(capsys, "import", "body.npz", "--body", "body.npz", "--make-uv", "--out", "x.h5")
    assert code == 1 and "body.npz: garment and body are the same mesh, wanted one worn by the other; name" in err[0]
    code, _, err = typed(capsys, "import", "body.npz", "--out", "x.obj")
    assert code == 2 and err == ["garmentbench: --out is x.obj; wanted a name that ends in .h5"]
