"""`garmentbench check` on meshes, as it is typed."""

import sys
import tomllib
from dataclasses import replace

import matplotlib.image
import numpy as np
import pytest
from faulty_meshes import at, ball, more, moved, parted, tube

from garmentbench.cli import main
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.importing.mesh_doctor.files import write_mesh
from garmentbench.sequence_file.read_write import save

CLEAN = tube()


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_mesh(tmp_path / "good.npz", CLEAN)
    write_mesh(tmp_path / "good.obj", CLEAN)
    body = ball()
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in body.rest] + [f"f {a} {b} {c}" for a, b, c in body.faces + 1]
    (tmp_path / "ball.obj").write_text("\n".join(lines))
    bad = parted(CLEAN, 15, sewn=False)
    bad = replace(bad, faces=np.where((np.arange(3600) % 50 == 0)[:, None], bad.faces[:, ::-1], bad.faces))
    bad = more(moved(bad, at(5, 7), 0.94 * bad.vertices[at(5, 7)]), [[0, 0, 0]], [], [[0, 0]])
    write_mesh(tmp_path / "bad.npz", replace(bad, uv=1.5 * bad.uv))
    return tmp_path


def typed(capsys, *arguments: str) -> tuple[int, list[str], list[str]]:
    code = main(("check", *arguments))
    out, err = capsys.readouterr()
    said = [line for line in out.splitlines() if not line.startswith("body ball.obj: ")]  # what its unit and axes are
    return code, said, err.splitlines()


@pytest.mark.parametrize("name", ["good.npz", "good.obj"])
def test_a_good_mesh(home, capsys, name):
    code, out, err = typed(capsys, name, "--body", "ball.obj")
    assert code == 0 and err == [] and out[1:] == [f"{name}: good"]
    assert (
        out[0].startswith(f"{name}: 1891 vertices, 3600 faces, 1 piece, 2 openings, ") and "substeps a frame" in out[0]
    )


def test_a_bad_mesh_has_all_its_faults_told_errors_first(home, capsys):
    code, out, err = typed(capsys, "bad.npz", "--body", "ball.obj")
    assert code == 1 and err == ["garmentbench: bad.npz: 4 errors, listed above; the file can't be used as it is"]
    kinds = [":".join(line.split(":")[:2]) for line in out[1:]]
    assert kinds == [
        "error: vertices",
        "error: winding",
        "error: cracks",
        "error: uv",
        "warning: pieces",
        "warning: body",
    ]


def test_warnings_alone_are_no_failure(home, capsys):
    write_mesh(home / "a.npz", moved(CLEAN, at(5, 7), 0.94 * CLEAN.vertices[at(5, 7)]))
    code, out, _ = typed(capsys, "a.npz", "--body", "ball.obj")
    assert code == 0 and out[-1] == "a.npz: good, but see the warnings" and len(out) == 3


@pytest.mark.parametrize("suffix", ["npz", "obj"])
def test_fix_writes_a_good_mesh_and_the_fixed_is_fixed_to_the_same_bytes(home, capsys, suffix):
    code, out, _ = typed(capsys, "bad.npz", "--body", "ball.obj", "--fix", f"a.{suffix}")
    assert code == 0 and f"a.{suffix}: good" in out
    done = [line for line in out if line.startswith("fix: ")]
    for start, line in zip(
        ("removed 1 vertex", "joined 61 pairs", "turned 72 faces", "pushed 1 point", "moved the UV map"),
        done,
        strict=True,
    ):
        assert line.startswith(f"fix: {start}")
    assert "what is left" in out[len(done)]
    code, out, _ = typed(capsys, f"a.{suffix}", "--body", "ball.obj", "--fix", f"b.{suffix}")
    assert code == 0 and out[0] == "fix: nothing to repair"
    assert (home / f"a.{suffix}").read_bytes() == (home / f"b.{suffix}").read_bytes()


def test_what_is_left_decides_the_exit_code(home, capsys):
    deep = replace(CLEAN, vertices=CLEAN.vertices * [0.8, 0.8, 1])
    write_mesh(home / "deep.npz", deep)
    code, out, err = typed(capsys, "deep.npz", "--body", "ball.obj", "--fix", "a.npz")
    assert code == 1 and out[0].startswith("fix: left ") and "error: body: " in out[-1] and "a.npz: 1 error" in err[0]


def test_units_and_uv(home, capsys):
    write_mesh(home / "odd.obj", replace(CLEAN, uv=None).scaled(350.0))
    code, out, _ = typed(capsys, "odd.obj")
    assert code == 1 and "the unit can't be told" in out[1]
    code, out, _ = typed(capsys, "odd.obj", "--fix", "a.npz", "--units", "mm", "--make-uv")
    assert code == 0 and out[0] == "fix: scaled from mm to m, by 0.001 (as --units says)" and "made a UV map" in out[1]


def test_a_mesh_without_uv_becomes_a_garment_in_one_step(home, capsys):
    """N4: no option and no package beyond the installation; the wardrobe's lines are printed."""
    write_mesh(home / "My poncho.obj", replace(CLEAN, uv=None))
    code, out, _ = typed(capsys, "My poncho.obj", "--fix", "My poncho.npz")
    assert code == 0 and "made a UV map by xatlas" in out[0]
    assert out[-3:] == [
        "to wear it in scenes, put into your wardrobe.toml:",
        "[garments.my_poncho]",
        f'mesh = "{home / "My poncho.npz"}"',
    ]
    assert tomllib.loads("\n".join(out[-2:]))["garments"]["my_poncho"]["mesh"].endswith("My poncho.npz")


def test_an_obj_without_uv_gets_a_map_too(home, capsys):
    """`--fix out.obj` left it out, failed for want of it, and advised --fix."""
    write_mesh(home / "bare.obj", replace(CLEAN, uv=None))
    assert "unwrap the garment (--fix OUT does" in typed(capsys, "bare.obj")[1][1]
    code, out, err = typed(capsys, "bare.obj", "--fix", "a.obj")
    assert code == 0 and "made a UV map by xatlas" in out[0] and out[-1] == "a.obj: good" and err == []


def test_without_xatlas_the_message_names_the_one_step(home, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "xatlas", None)
    write_mesh(home / "bare.obj", replace(CLEAN, uv=None))
    code, _, err = typed(capsys, "bare.obj", "--fix", "a.npz")
    assert code == 1 and len(err) == 1 and "pip install xatlas" in err[0] and not (home / "a.npz").exists()


def test_what_a_body_s_mesh_was_taken_for_is_said(home, capsys):
    """In inches, y up, as its height tells; and as it is told."""
    turned = ball().rest[:, [0, 2, 1]] * [1, 1, -1] / 0.0254
    faces = "".join(f"f {a} {b} {c}\n" for a, b, c in ball().faces + 1)
    (home / "inches.obj").write_text("".join(f"v {x:.5f} {y:.5f} {z:.5f}\n" for x, y, z in turned) + faces)
    for options, why in (((), "inferred: body height 70.87"), (("--body-units", "in", "--body-up", "y"), "given")):
        assert main(("check", "good.npz", "--body", "inches.obj", *options)) == 0
        out = capsys.readouterr().out.splitlines()
        assert out[0] == f"body inches.obj: units: in ({why})" and out[1].startswith("body inches.obj: up: y")
        assert out[-1] == "good.npz: good"


def test_the_picture_shows_the_body_too(home, capsys):
    for name, more_ in (("alone", ()), ("worn", ("--body", "ball.obj"))):
        assert typed(capsys, "good.npz", "--picture", f"{name}.png", *more_)[0] == 0
    alone, worn = (matplotlib.image.imread(home / f"{name}.png")[..., :3] for name in ("alone", "worn"))
    grey = [np.ptp(picture, axis=2) < 0.05 for picture in (alone, worn)]
    skin = [(g & (p.mean(axis=2) < 0.9))[:, :900].sum() for g, p in zip(grey, (alone, worn), strict=True)]
    assert skin[1] > skin[0] + 1000
    write_mesh(home / "beside.npz", replace(CLEAN, vertices=CLEAN.vertices + [2, 0, 0]))
    typed(capsys, "beside.npz", "--body", "ball.obj", "--picture", "beside.png")
    assert matplotlib.image.imread(home / "beside.png")[..., :3][:, :450].min() < 0.9


def test_a_sequence_s_spread_is_said(home, capsys):
    sequence = tiny_sequence()
    save(replace(sequence, info={"ensemble": {"spread_cm": 6.2, "push_growth": 12.0}}), home / "known.h5")
    save(replace(sequence, info={}), home / "unknown.h5")
    assert (
        typed(capsys, "known.h5")[1][0] == "known.h5: spread 6.2 cm, chaotic: differences below the spread mean nothing"
    )
    assert typed(capsys, "unknown.h5")[1][0].startswith("unknown.h5: spread not measured")


def test_weld(home, capsys):
    apart = parted(CLEAN, 15, sewn=False)
    write_mesh(home / "apart.npz", moved(apart, np.arange(1891, 1952), apart.vertices[1891:] - [0, 0, 3e-4]))
    _, out, _ = typed(capsys, "apart.npz", "--fix", "a.npz")
    assert any(line.startswith("warning: pieces: 2 pieces") for line in out)
    code, out, _ = typed(capsys, "apart.npz", "--fix", "a.npz", "--weld", "0.001")
    assert code == 0 and "a.npz: good" in out


@pytest.mark.parametrize(("arguments", "says"), [
    (["good.npz", "--units", "cm"], "--units says how to repair; give --fix"),
    (["good.npz", "--make-uv"], "--make-uv says how to repair; give --fix"),
    (["good.npz", "--fix", "a.stl"], "wanted a name that ends in .obj or .npz"),
    (["good.npz", "--fix", "a.npz", "--units", "inches"], "--units is 'inches'; wanted m, cm, mm"),
    (["good.npz", "--fix", "a.npz", "--weld", "1"], "--weld is 1; wanted metres above 0 and below 0.1"),
    (["good.npz", "--body-units", "in"], "give --body FILE with them"),
    (["good.npz", "--body", "ball.obj", "--body-up", "w"], "--body-up is 'w'; wanted z, y, x"),
    (["good.npz", "--body", "base", "--body-units", "in"], "base is in metres, z up"),
    (["good.npz", "--body", "bsae"], "unknown body 'bsae': did you mean 'base'?"),
])  # fmt: skip
def test_wrong_calls(home, capsys, arguments, says):
    code, out, err = typed(capsys, *arguments)
    assert code == 2 and len(err) == 1 and says in err[0] and out == []


def test_a_sequence_s_garment_is_checked_too_but_only_warned_of(home, capsys):
    sequence = tiny_sequence(8)
    save(sequence, home / "a.h5")
    code, out, _ = typed(capsys, "a.h5")
    assert code == 0 and out[1:] == ["a.h5: good"]
    sequence.template.garment.faces[3] = sequence.template.garment.faces[3, ::-1]
    save(sequence, home / "b.h5")
    code, out, _ = typed(capsys, "b.h5")
    assert code == 0 and out[1].startswith("warning: garment winding: 1 flipped face") and len(out) == 3
    code, out, _ = typed(capsys, "b.h5", "--fix", "b.npz")
    assert code == 0 and out[0] == "fix: turned 1 face that ran against the neighbours" and "b.npz: good" in out


def red(path) -> np.ndarray:
    image = matplotlib.image.imread(path)[..., :3]
    return (image[..., 0] > 0.4) & (image[..., 1] < 0.25) & (image[..., 2] < 0.25)


def test_the_picture_has_what_was_found_in_red(home, capsys):
    assert typed(capsys, "good.npz", "--picture", "good.png")[0] == 0
    assert typed(capsys, "bad.npz", "--body", "ball.obj", "--picture", "bad.png")[0] == 1
    assert red(home / "good.png").sum() == 0
    marked = red(home / "bad.png")
    thirds = [part.sum() for part in np.array_split(marked, 3, axis=1)]
    assert marked.shape == (600, 1350) and min(thirds) > 200


def test_a_picture_of_nan_is_refused_in_one_line(home, capsys):
    write_mesh(home / "nan.npz", moved(CLEAN, 9, np.nan))
    code, _, err = typed(capsys, "nan.npz", "--picture", "a.png")
    assert code == 1 and len(err) == 1 and "can't be drawn" in err[0]
