"""Every input of ../shared/data/cases, by the command that its README names, does what is right there.

Figures are the README's, or worked out beside the code with bvhio.
"""

from pathlib import Path

import numpy as np
import pytest
from exchange_example import imported, typed

from garmentbench.importing.mesh_doctor.files import read_mesh
from garmentbench.importing.motions.bvh import read_bvh
from garmentbench.importing.motions.recording import world
from garmentbench.paths import PACKAGE
from garmentbench.scenes.bodies import load_body
from garmentbench.sequence import Sequence

CASES = PACKAGE.parents[1] / "shared" / "data" / "cases"
PELVIS = load_body("base", "small").joint_names.index("pelvis")
pytestmark = pytest.mark.skipif(not CASES.is_dir(), reason="the inputs in ../shared/data/cases are not there")


def test_every_folder_has_its_test():
    tested = {name for name in globals() if name.startswith("test_")}
    folders = {path.name[:2] for path in CASES.iterdir() if path.is_dir()}
    assert folders == {name[5:7] for name in tested if name[5:7].isdecimal()}


def clip(capsys, tmp_path: Path, file: Path, *more: object) -> tuple[dict[str, np.ndarray], str]:
    """The arrays that import-motion writes of a file, and what it says."""
    code, out, err = typed(capsys, "import-motion", file, "--out", tmp_path / "clip.npz", *more)
    assert code == 0 and err == []
    with np.load(tmp_path / "clip.npz") as arrays:
        return dict(arrays), out


def sequence(capsys, tmp_path: Path, *arguments: object) -> tuple[Sequence, str]:
    """The sequence that import writes, and what it says; `check` finds nothing wrong with it."""
    code, out, err = typed(capsys, "import", *arguments, "--out", tmp_path / "x.h5")
    assert code == 0 and err == [] and "warning" not in out
    code, checked, _ = typed(capsys, "check", tmp_path / "x.h5")
    assert code == 0 and checked.splitlines()[-1] == f"{tmp_path / 'x.h5'}: good"
    return imported(tmp_path / "x.h5"), out


def refused(capsys, *arguments: object) -> str:
    """The one line by which a command refuses."""
    code, _, err = typed(capsys, *arguments)
    assert code in (1, 2) and len(err) == 1
    return err[0]


def apart(found: Sequence) -> float:
    """The most that the middles of garment and body are apart in the horizontal, in any frame [m]."""
    middles = [(x.min(axis=1) + x.max(axis=1))[:, :2] / 2 for x in (found.garment, found.body)]
    return float(np.linalg.norm(middles[0] - middles[1], axis=1).max())


def test_01_hips_below_a_still_root(capsys, tmp_path):
    folder, base = CASES / "01-bvh-hips-below-root", CASES / "18-bvh-last-frame" / "b_base.bvh"
    jumps = [clip(capsys, tmp_path, folder / f"{name}.bvh")[0] for name in ("b_jump", "b_jumpwrap")]
    for jump in jumps:
        assert jump["root"][:, 2].max() - np.median(jump["root"][:, 2]) == pytest.approx(0.445, abs=0.005)
    wrapped, said = clip(capsys, tmp_path, folder / "b_wrap.bvh")
    assert "root: 'Hips', whose path is its own, below 'Armature'" in said
    plain = clip(capsys, tmp_path, base)[0]
    for name in ("rotations", "root", "standing"):
        np.testing.assert_allclose(wrapped[name], plain[name], atol=1e-6)
    # The README's 0.676 m are the length of the way over the ground in the first 99 frames, all that were read then.
    steps = np.linalg.norm(np.diff(wrapped["root"][:99, :2], axis=0), axis=1)
    assert steps.sum() == pytest.approx(0.676, abs=0.001)


@pytest.mark.parametrize("name", ["b_wrap", "b_jumpwrap", "b_jump"])
def test_01_joints_are_where_bvhio_has_them(name):
    bvhio = pytest.importorskip("bvhio", reason="pip install bvhio to compare with it")
    path = CASES / "01-bvh-hips-below-root" / f"{name}.bvh"
    recording = read_bvh(path)
    _, positions = world(recording)
    hierarchy = bvhio.readAsHierarchy(str(path))
    for frame in (0, 40, 99):
        hierarchy.loadPose(frame)
        theirs = {joint.Name: np.array(joint.PositionWorld) for joint, _, _ in hierarchy.layout()}
        ours = {n: p for n, p in zip(recording.names, positions[frame], strict=True) if n in theirs}
        assert len(ours) >= 31
        for joint, place in ours.items():
            np.testing.assert_allclose(place, theirs[joint], atol=1e-4, err_msg=joint)


def test_02_another_order_of_vertices(capsys, tmp_path):
    folder = CASES / "02-pc2-vertex-order"
    body = ("--body", folder / "body.pc2", "--body-template", folder / "body.obj", "--fps", 24)
    line = refused(
        capsys,
        "import",
        folder / "garment.pc2",
        "--template",
        folder / "garment_perm.obj",
        *body,
        "--out",
        tmp_path / "x.h5",
    )
    assert "garment_perm.obj has other proportions than frame 0" in line and "another order of vertices?" in line
    sequence(capsys, tmp_path, folder / "garment.pc2", "--template", folder / "garment.obj", *body)


@pytest.mark.parametrize("file", ["u_off.usdc", "garment_s5.pc2", "garment_t1.mdd"])
def test_03_caches_that_begin_at_different_frames(capsys, tmp_path, file):
    folder = CASES / "03-start-frame-ignored"
    ending = Path(file).suffix
    if ending == ".usdc":
        pytest.importorskip("pxr", reason="usd-core is an extra")
    more = () if ending == ".usdc" else ("--template", folder / "garment.obj", "--body", folder / f"body{ending}",
                                         "--body-template", folder / "body.obj")  # fmt: skip
    rate = ("--fps", 24) if ending == ".pc2" else ()
    found, said = sequence(capsys, tmp_path, folder / file, *more, *rate)
    assert (
        len(found) == 15
        and "frames: 15 that both have" in said
        and found.template.fps == (25 if ending == ".mdd" else 24)
    )
    assert apart(found) < 0.014 and found.scores["interpenetration_strict"] < 1


def test_04_a_garment_that_is_not_on_the_body(capsys, tmp_path):
    folder = CASES / "04-check-body-elsewhere"
    code, out, err = typed(capsys, "check", folder / "shifted.npz", "--body", "base")
    assert code == 1 and "error: body: not worn by 'base'" in out and "--shift=-2,0,0" in out and len(err) == 1
    tube, fixed = folder / "tube_yup_pelvis_origin.obj", tmp_path / "t.npz"
    code, out, _ = typed(capsys, "check", tube, "--body", "base", "--fix", fixed)
    assert code == 1 and "y up, +0.9 m" in out and "nothing is pushed" in out and "points inside" not in out
    np.testing.assert_allclose(read_mesh(fixed).vertices, read_mesh(tube).vertices, atol=1e-6)


def test_06_a_skinned_body(capsys, tmp_path):
    pytest.importorskip("pxr", reason="usd-core is an extra")
    found, said = sequence(capsys, tmp_path, CASES / "06-usd-skinned-body" / "u_skel.usdc")
    assert "body: moved by its skeleton skel: baked" in said
    middle = (found.body.min(axis=1) + found.body.max(axis=1)) / 2
    assert np.linalg.norm(middle[-1] - middle[0]) == pytest.approx(0.95, abs=0.05) and apart(found) < 0.05


def test_09_half_the_rate(capsys, tmp_path):
    pytest.importorskip("pxr", reason="usd-core is an extra")
    file = CASES / "09-half-rate-advice" / "u_half.usdc"
    found, said = sequence(capsys, tmp_path, file)
    assert (
        len(found) == 10 and found.template.fps == 12 and apart(found) < 0.014 and "frames: 10 that both have" in said
    )
    for more in (("--fps", 24), ("--fps", 24, "--frames", 10)):
        assert "leave --fps out" in refused(capsys, "import", file, *more, "--out", tmp_path / "x.h5")


def test_10_two_objects_in_one_file(capsys, tmp_path):
    two, body = (CASES / "10-obj-two-objects" / name for name in ("o_two.obj", "body.obj"))
    line = refused(capsys, "import", two, "--body", body, "--fps", 24, "--out", tmp_path / "x.h5")
    assert "holds 2 objects (shirt, body), wanted to know which is the garment" in line and "--mesh NAME" in line
    found, said = sequence(capsys, tmp_path, two, "--mesh", "shirt", "--body", body, "--fps", 24)
    assert "object 'shirt' read, left out: body" in said
    assert len(found.template.garment.rest) - len(found.template.garment.seams) == 112  # 119 with those split by UV


@pytest.mark.parametrize("name", ["am_obj", "am_split", "am_smplkeys"])
def test_12_amass_by_other_names_and_with_objects(capsys, tmp_path, name):
    arrays, said = clip(capsys, tmp_path, CASES / "12-amass-object-array" / f"{name}.npz")
    assert len(arrays["root"]) == 90 and "names: SMPL" in said


def test_13_inches(capsys, tmp_path):
    file = CASES / "13-inches" / "tube_in.obj"
    code, out, err = typed(capsys, "check", file, "--body", "base", "--fix", tmp_path / "x.npz")
    assert code == 1 and len(err) == 1 and "or in (0.78 m)" in out and "--units in" in out
    assert "scaled" not in out and "turned" not in out
    code, out, _ = typed(capsys, "check", file, "--fix", tmp_path / "y.npz", "--units", "in")
    assert code == 0 and "scaled from in to m, by 0.0254 (as --units says)" in out
    assert read_mesh(tmp_path / "y.npz").size == pytest.approx(0.78, abs=0.01)


@pytest.mark.parametrize(
    ("name", "note"), [("b_fewer", "100 rows where 'Frames:' says 90"), ("b_bom", "recording: 100")]
)
def test_14_more_rows_and_a_byte_order_mark(capsys, tmp_path, name, note):
    arrays, said = clip(capsys, tmp_path, CASES / "14-bvh-frame-count" / f"{name}.bvh")
    assert len(arrays["root"]) == 100 and note in said


@pytest.mark.parametrize("name", ["o_mixed", "o_slash", "o_bom", "o_col2", "o_indent_f"])
def test_16_legal_lines(capsys, tmp_path, name):
    folder = CASES / "16-obj-legal-lines"
    call = (folder / f"{name}.obj", "--body", folder / "body.obj", "--fps", 24)
    if name in ("o_mixed", "o_slash"):  # corners without UV, which methods need: said, and made if that is asked for
        line = refused(capsys, "import", *call, "--out", tmp_path / "x.h5")
        wanted = "for 96 of its 192 triangles" if name == "o_mixed" else "has no UV map"
        assert wanted in line and "--make-uv" in line
        pytest.importorskip("xatlas", reason="xatlas is an extra")
        call += ("--make-uv",)
    found, _ = sequence(capsys, tmp_path, *call)
    assert len(found.template.garment.faces) == 192
    plain = read_mesh(folder.parent / "02-pc2-vertex-order" / "garment.obj")
    assert read_mesh(folder / f"{name}.obj").size == pytest.approx(plain.size, abs=0.05)


def test_18_no_frame_is_lost_by_rounding(capsys, tmp_path):
    arrays, said = clip(capsys, tmp_path, CASES / "18-bvh-last-frame" / "b_base.bvh")
    assert len(arrays["root"]) == 100 and "recording: 100 frames at 30 a second" in said


def test_19_what_stop_cuts_off_decides_nothing(capsys, tmp_path):
    folder = CASES / "19-bvh-stop-keeps-fault"
    (dip, said), (cut, _) = (clip(capsys, tmp_path, folder / f"{n}.bvh", "--stop", 1.9) for n in ("b_dip", "b_dipcut"))
    assert "right in 100 %" in said and dip["standing"][:, 1].all()
    np.testing.assert_allclose(dip["root"], cut["root"], atol=1e-6)
    assert np.ptp(dip["root"][:, 2]) < 0.12  # no fall of 30 cm
