"""Is what is imported worn? Said where it isn't, with the likely cause and what can be done."""

from dataclasses import replace

import numpy as np
import pytest
from exchange_example import MESHES, beside, dancer, typed

from garmentbench.importing.meshes.arrays import write_npz
from garmentbench.importing.meshes.conventions import Given
from garmentbench.importing.meshes.mesh_sequence import MeshSequence
from garmentbench.importing.meshes.obj import write_series, write_template
from garmentbench.importing.meshes.point_caches import write_mdd, write_pc2
from garmentbench.importing.sequences import Wanted, import_meshes
from garmentbench.scenes.bodies import load_body
from garmentbench.scenes.garments import load_garment

CLOTH, BODY = MESHES["garment"], MESHES["body"]
PLAIN = Wanted("x", Given("m", "z", 25.0))


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


@pytest.mark.parametrize("late", [5, -3])
def test_a_garment_that_is_late_is_told_by_how_many_frames(home, capsys, late):
    """Without times in its file."""
    cloth, body = dancer()
    moved = np.clip(np.arange(len(cloth.frames)) + late, 0, len(cloth.frames) - 1)
    write_npz(home / "body.npz", body)
    write_npz(home / "cloth.npz", replace(cloth, frames=cloth.frames[moved]))
    code, out, _ = typed(capsys, "import", "cloth.npz", "--body", "body.npz", "--out", "x.h5")
    assert code == 0 and f"it fits the body {late:+d} frames away" in out


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


def test_a_body_elsewhere_is_told(home):
    _, notes = import_meshes(CLOTH, replace(BODY, frames=BODY.frames + np.float32(5)), PLAIN)
    assert any(line.startswith("warning: the garment is") and "away from the body" in line for line in notes)
