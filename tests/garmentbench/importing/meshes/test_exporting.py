"""What is exported can be imported again, the same to the stated rounding."""

from dataclasses import replace

import numpy as np
import pytest
from exchange_example import SEQUENCE, imported, positions_agree, typed

from garmentbench import sequence_file
from garmentbench.errors import UserError
from garmentbench.importing.meshes.exporting import ROUNDING, export

TEMPLATES = ("obj", "pc2", "mdd")


@pytest.mark.parametrize("form", ROUNDING)
def test_round_trip(tmp_path, monkeypatch, capsys, form):
    if form == "usd":
        pytest.importorskip("pxr", reason="usd-core is an extra")
    monkeypatch.chdir(tmp_path)
    sequence_file.save(SEQUENCE, tmp_path / "a.h5")
    code, out, complaints = typed(capsys, "export", "a.h5", "--to", form, "--out", "out")
    assert code == 0, complaints
    garment, *body = out.splitlines()
    bodies = ("--body", body[0]) if body else ()
    templates = ("--template", "out/garment.obj", "--body-template", "out/body.obj") if form in TEMPLATES else ()
    says_all = ("npz", "usd")
    known = () if form in says_all else ("--units", "m", "--up", "z", "--fps", "25")
    code, out, complaints = typed(capsys, "import", garment, *bodies, *templates, *known, "--out", "b.h5")
    assert code == 0, complaints
    read = imported(tmp_path / "b.h5")
    rest = 0.5e-6 if form in TEMPLATES else 0.0  # templates are OBJ files
    assert positions_agree(read, SEQUENCE, within=max(ROUNDING[form], rest) + 6e-8)
    assert ROUNDING[form] > 0 or np.array_equal(read.garment, SEQUENCE.garment)
    np.testing.assert_array_equal(read.template.garment.uv, SEQUENCE.template.garment.uv)
    assert read.template.fps == 25.0
    if form in says_all:
        assert {"units: m (as the file says)", "up: z (as the file says)", "fps: 25 (as the file says)"} < set(
            out.splitlines()
        )


def test_a_garment_alone_and_few_frames(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    alone = replace(SEQUENCE, template=replace(SEQUENCE.template, body=None), body=None)
    sequence_file.save(alone, tmp_path / "a.h5")
    code, out, _ = typed(capsys, "export", "a.h5", "--to", "obj", "--out", "out", "--frames", "2")
    assert code == 0 and out.splitlines() == ["out/garment"]
    assert sorted(p.name for p in (tmp_path / "out" / "garment").iterdir()) == ["0001.obj", "0002.obj"]
    code, _, complaints = typed(capsys, "export", "a.h5", "--to", "obj", "--out", "out", "--frames", "99")
    assert code == 2 and "--frames is 99; there are 6" in complaints[0]


def test_usd_core_sees_units_axes_rate_and_uv(tmp_path):
    pytest.importorskip("pxr", reason="usd-core is an extra")
    from pxr import Usd, UsdGeom

    (path,) = export(SEQUENCE, "usd", tmp_path)
    stage = Usd.Stage.Open(str(path))
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0 and UsdGeom.GetStageUpAxis(stage) == "Z"
    assert (stage.GetTimeCodesPerSecond(), stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (25.0, 1.0, 6.0)
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/garmentbench/garment"))
    np.testing.assert_array_equal(np.array(mesh.GetPointsAttr().Get(4.0)), SEQUENCE.garment[3])
    st = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st")
    assert st.GetInterpolation() == "faceVarying" and len(st.Get()) == 3 * len(SEQUENCE.template.garment.faces)
    assert not list(tmp_path.glob("*partial*"))


def test_a_folder_that_can_not_be_written_to(tmp_path):
    (tmp_path / "out").write_text("a file")
    for form in ("npz", "obj"):
        with pytest.raises(UserError, match="can't be written"):
            export(SEQUENCE, form, tmp_path / "out")


def test_unknown_things_are_named(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, _, complaints = typed(capsys, "export", "nothing", "--to", "usd", "--out", str(tmp_path))
    assert code == 2 and len(complaints) == 1 and "nothing" in complaints[0]
    code, _, complaints = typed(capsys, "export", "a.h5", "--to", "fbx", "--out", str(tmp_path))
    assert code == 2 and "fbx" in complaints[0]
