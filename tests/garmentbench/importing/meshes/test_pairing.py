"""Garment and body are paired by their times, in every format that has times, and belong to their templates."""

import struct
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from exchange_example import MESHES, imported, typed

from garmentbench.errors import UserError
from garmentbench.importing.meshes.arrays import write_npz
from garmentbench.importing.meshes.frame_check import check_frames
from garmentbench.importing.meshes.mesh_sequence import MeshSequence
from garmentbench.importing.meshes.obj import write_series, write_template
from garmentbench.importing.meshes.pairing import paired
from garmentbench.importing.meshes.point_caches import write_mdd, write_pc2
from garmentbench.importing.meshes.reading import read_both
from garmentbench.motion.gait import GAITS
from garmentbench.motion.walk import walk
from garmentbench.scenes.bodies import load_body, pose

T, STEP = 8, np.float32([0.02, 0.0, 0.0])  # everything moves by 2 cm a frame of 25 a second


def moving(name: str, start: float = 0.0, every: float = 1.0) -> MeshSequence:
    """Garment or body, its frames from `start` on [frames], one in `every`."""
    mesh = MESHES[name]
    at = start + every * np.arange(T)
    frames = mesh.frames[:1] + at[:, None, None].astype(np.float32) * STEP
    return replace(mesh, frames=frames, fps=25.0 / every)


def pc2(folder: Path, name: str, start: float, every: float) -> list:
    write_pc2(folder / f"{name}.pc2", moving(name, start, every))
    data = bytearray((folder / f"{name}.pc2").read_bytes())
    data[20:28] = struct.pack("<ff", start, every)
    (folder / f"{name}.pc2").write_bytes(data)
    write_template(folder / f"{name}.obj", moving(name))
    return [folder / f"{name}.pc2", folder / f"{name}.obj"]


def mdd(folder: Path, name: str, start: float, every: float) -> list:
    write_mdd(folder / f"{name}.mdd", moving(name, start, every))
    data = bytearray((folder / f"{name}.mdd").read_bytes())
    times = (start + every * np.arange(T)) / 25
    data[8 : 8 + 4 * T] = times.astype(">f4").tobytes()
    (folder / f"{name}.mdd").write_bytes(data)
    write_template(folder / f"{name}.obj", moving(name))
    return [folder / f"{name}.mdd", folder / f"{name}.obj"]


def obj(folder: Path, name: str, start: float, every: float) -> list:
    written = write_series(folder / "first", moving(name, start, every))
    (folder / name).mkdir()
    for k, path in enumerate(written):
        path.rename(folder / name / f"{name}_{round(100 + start + every * k):04d}.obj")
    write_template(folder / f"{name}.obj", moving(name))
    return [folder / name, folder / f"{name}.obj"]


def npz(folder: Path, name: str, start: float, every: float) -> list:
    write_npz(folder / f"{name}.npz", moving(name, start, every))
    with np.load(folder / f"{name}.npz") as arrays:
        np.savez(folder / f"{name}.npz", **{**arrays, "times": (start + every * np.arange(T)) / 25})
    return [folder / f"{name}.npz", None]


def usd(folder: Path, name: str, start: float, every: float) -> list:
    pytest.importorskip("pxr")
    from pxr import Usd, UsdGeom, Vt

    mesh = moving(name, start, every)
    stage = Usd.Stage.CreateNew(str(folder / f"{name}.usdc"))
    stage.SetTimeCodesPerSecond(25)
    prim = UsdGeom.Mesh.Define(stage, f"/{name}")
    prim.CreateFaceVertexCountsAttr([3] * len(mesh.faces))
    prim.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(mesh.faces.ravel().astype(np.int32)))
    points = prim.CreatePointsAttr()
    for k, frame in enumerate(mesh.frames):
        points.Set(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(frame)), 1 + start + every * k)
    stage.GetRootLayer().Save()
    write_template(folder / f"{name}.obj", mesh)
    return [folder / f"{name}.usdc", folder / f"{name}.obj"]


def alembic(folder: Path, name: str, start: float, every: float) -> list:
    pytest.importorskip("alembic3d")
    import imath
    from alembic3d import Abc, AbcCoreAbstract, AbcGeom

    def filled(kind, values):
        array = kind(len(values))
        np.asarray(memoryview(array))[:] = values
        return array

    mesh = moving(name, start, every)
    top = Abc.OArchive(str(folder / f"{name}.abc")).getTop()
    rate = top.getArchive().addTimeSampling(AbcCoreAbstract.TimeSampling(every / 25, (1 + start) / 25))
    schema = AbcGeom.OPolyMesh(top, name, rate).getSchema()
    faces = filled(imath.IntArray, mesh.faces[:, ::-1].ravel())
    for frame in mesh.frames:
        counts = filled(imath.IntArray, np.full(len(mesh.faces), 3))
        schema.set(AbcGeom.OPolyMeshSchemaSample(filled(imath.V3fArray, frame), faces, counts))
    write_template(folder / f"{name}.obj", mesh)
    return [folder / f"{name}.abc", folder / f"{name}.obj"]


FORMATS = [pc2, mdd, obj, npz, usd, alembic]


def run(tmp_path, capsys, write, garment=(0.0, 1.0), body=(0.0, 1.0), *more, write_body=None):
    (cloth, cut), (skin, shape) = write(tmp_path, "garment", *garment), (write_body or write)(tmp_path, "body", *body)
    templates = ["--template", cut] * (cut is not None) + ["--body-template", shape] * (shape is not None)
    common = ["--kind", "object", "--units", "m", "--up", "z", "--out", tmp_path / "x.h5"]
    return typed(capsys, "import", cloth, "--body", skin, *templates, *common, *more)


def fps_of(write) -> tuple:
    return () if write in (mdd, npz, usd, alembic) else ("--fps", "25")


def together(path: Path) -> int:
    """The number of frames, garment and body all at the same place of their motion."""
    sequence = imported(path)
    moved = [(x - x[0]).mean(axis=1)[:, 0] for x in (sequence.garment, sequence.body)]
    np.testing.assert_allclose(moved[0], moved[1], atol=1e-5)
    gap = sequence.garment[0, :, 0].mean() - sequence.body[0, :, 0].mean()
    rest = MESHES["garment"].frames[0, :, 0].mean() - MESHES["body"].frames[0, :, 0].mean()
    assert gap == pytest.approx(rest, abs=2e-3)  # vertices that the UV map's cuts double shift the mean a little
    return len(sequence)


@pytest.mark.parametrize("write", FORMATS)
def test_another_start_leaves_the_frames_that_both_have(tmp_path, capsys, write):
    code, out, err = run(tmp_path, capsys, write, (3.0, 1.0), (0.0, 1.0), *fps_of(write))
    assert code == 0 and err == [] and "frames: 5 that both have" in out
    assert together(tmp_path / "x.h5") == 5 and imported(tmp_path / "x.h5").template.fps == 25


@pytest.mark.parametrize("write", FORMATS)
def test_another_rate_leaves_the_frames_that_both_have(tmp_path, capsys, write):
    code, out, err = run(tmp_path, capsys, write, (0.0, 2.0), (0.0, 1.0), *fps_of(write))
    assert code == 0 and err == [] and "frames: 4 that both have" in out
    assert together(tmp_path / "x.h5") == 4 and imported(tmp_path / "x.h5").template.fps == 12.5


@pytest.mark.parametrize("write", FORMATS)
def test_no_common_frame_is_refused_and_a_same_start_is_an_option(tmp_path, capsys, write):
    code, _, err = run(tmp_path, capsys, write, (40.0, 1.0), (0.0, 1.0), *fps_of(write))
    assert code == 1 and len(err) == 1 and "no frame in common" in err[0] and "--same-start" in err[0]
    (tmp_path / "again").mkdir()
    code, out, _ = run(tmp_path / "again", capsys, write, (40.0, 1.0), (0.0, 1.0), "--same-start", *fps_of(write))
    assert code == 0 and "frames: 8 that both have" in out and len(imported(tmp_path / "again" / "x.h5")) == 8


@pytest.mark.parametrize("write", [mdd, npz, usd, alembic])
def test_rates_that_dont_fit_and_a_given_rate_that_contradicts(tmp_path, capsys, write):
    code, _, err = run(tmp_path, capsys, write, (0.0, 1.25), (0.0, 1.0))
    assert code == 1 and len(err) == 1 and "the rates don't fit together" in err[0] and "--frames" not in err[0]
    (tmp_path / "again").mkdir()
    code, _, err = run(tmp_path / "again", capsys, write, (0.0, 2.0), (0.0, 1.0), "--fps", "25")
    assert code == 1 and "leave --fps out" in err[0]


def test_equal_rates_that_are_wrong_are_mended_by_fps(tmp_path, capsys):
    code, out, _ = run(tmp_path, capsys, mdd, (3.0, 1.0), (0.0, 1.0), "--fps", "50")
    assert code == 0 and together(tmp_path / "x.h5") == 5 and imported(tmp_path / "x.h5").template.fps == 50


def test_numbers_beside_times_may_count_from_one(tmp_path, capsys):
    code, out, _ = run(tmp_path, capsys, pc2, (0.0, 1.0), (0.0, 1.0), write_body=usd)
    assert code == 0 and "taken to begin together" in out and together(tmp_path / "x.h5") == 8
    (tmp_path / "again").mkdir()
    code, out, _ = run(tmp_path / "again", capsys, pc2, (4.0, 1.0), (0.0, 1.0), write_body=mdd)
    assert code == 0 and "taken as times at 25 a second" in out and together(tmp_path / "again" / "x.h5") == 4


@pytest.mark.parametrize(("write", "write_body", "more"), [(pc2, obj, ("--fps", "25")), (mdd, usd, ()), (mdd, npz, ())])
def test_formats_that_count_from_one_and_from_zero_begin_together(tmp_path, capsys, write, write_body, more):
    """As many frames, one apart: PC2's 0 is OBJ's 1, and MDD's 0 s USD's time code 1. In one format it is meant."""
    first = {usd: 0.0, obj: -99.0, npz: 1.0}[write_body]  # these write time code 1 and file 100 for frame 0
    call = (tmp_path, capsys, write, (0.0, 1.0), (first, 1.0), *more)
    code, out, err = run(*call, write_body=write_body)
    assert code == 0 and err == [] and "count from 0 or 1; taken to begin together" in out
    assert len(imported(tmp_path / "x.h5")) == T
    (tmp_path / "again").mkdir()
    code, out, _ = run(tmp_path / "again", capsys, mdd, (0.0, 1.0), (1.0, 1.0))
    assert code == 0 and "frames: 7 that both have" in out and together(tmp_path / "again" / "x.h5") == 7


@pytest.mark.parametrize("write", FORMATS)
def test_a_single_common_frame_is_no_motion(tmp_path, capsys, write):
    code, _, err = run(tmp_path, capsys, write, (7.0, 1.0), (0.0, 1.0), *fps_of(write))
    assert code == 1 and len(err) == 1 and "only one frame in common" in err[0]


def test_two_meanings_of_a_sampling_are_asked_about(tmp_path, capsys):
    """24 is every 24th frame, or frames a second; 1 beside it doesn't tell."""
    code, _, err = run(tmp_path, capsys, pc2, (0.0, 24.0), (0.0, 1.0), "--fps", "24")
    assert (
        code == 1 and len(err) == 1 and "its sampling is 24" in err[0] and "frames a second, or every so many" in err[0]
    )
    (tmp_path / "again").mkdir()
    code, out, _ = run(tmp_path / "again", capsys, pc2, (0.0, 24.0), (0.0, 24.0))
    assert code == 0 and "fps: 24 (as the file says)" in out and out.count("its sampling of 24 is taken as frames") == 2


def test_a_body_that_stands_still_has_no_time():
    still = replace(MESHES["body"], frames=MESHES["body"].frames[:1], times=np.array([100.0]))
    cloth = replace(moving("garment"), times=np.arange(T) / 25)
    assert paired(cloth, still, None).garment is cloth


def test_without_times_counts_must_agree_and_the_advice_is_only_then(tmp_path, capsys):
    for name, count in (("garment", T), ("body", 5)):
        mesh = moving(name)
        write_npz(tmp_path / f"{name}.npz", replace(mesh, frames=mesh.frames[:count]))
    files = (tmp_path / "garment.npz", "--body", tmp_path / "body.npz", "--kind", "object", "--out", tmp_path / "x.h5")
    code, _, err = typed(capsys, "import", *files)
    assert code == 1 and "--frames 5 where both begin at the same time" in err[0]


def test_hdf5_texts_and_numbers_as_attributes(tmp_path):
    mesh = moving("garment")
    for kind in (h5py.string_dtype(), "S1"):
        with h5py.File(tmp_path / "a.h5", "w") as file:
            file["positions"], file["faces"], file["uv"] = mesh.frames, mesh.faces, mesh.corner_uv
            file.attrs["fps"], file.attrs["metres_per_unit"] = 25.0, 1.0
            file.attrs.create("up", "z", dtype=kind)
        read, _ = read_both((str(tmp_path / "a.h5"), None, ""), ("", None, ""))
        assert (read.fps, read.unit, read.up) == (25.0, 1.0, "z")
    with h5py.File(tmp_path / "b.h5", "w") as file:
        file["positions"], file["faces"] = mesh.frames, mesh.faces
        file.create_dataset("up", data="y", dtype=h5py.string_dtype())
    assert read_both((str(tmp_path / "b.h5"), None, ""), ("", None, ""))[0].up == "y"


# Templates and frames


def template_of(mesh: MeshSequence, rest: np.ndarray) -> MeshSequence:
    return replace(mesh, rest=rest, files=(Path("cache.pc2"), Path("template.obj")))


@pytest.mark.parametrize("name", ["garment", "body"])
def test_a_template_that_is_not_the_frames_is_named_with_its_likely_cause(name):
    mesh = moving(name)
    order = np.random.default_rng(0).permutation(len(mesh.still))
    check_frames(template_of(mesh, mesh.still))
    with pytest.raises(
        UserError, match="cache.pc2: template.obj has other proportions .*another order of vertices.*--other-template"
    ):
        check_frames(template_of(mesh, mesh.still[order]))
    with pytest.raises(UserError, match="template.obj is 100 times as large as frame 0: another unit"):
        check_frames(template_of(mesh, 100 * mesh.still))
    with pytest.raises(UserError, match="mirror image of frame 0"):
        check_frames(template_of(mesh, mesh.still * np.float32([-1, 1, 1])))
    check_frames(template_of(mesh, mesh.still[:, [1, 2, 0]]))  # a turn is placed later
    check_frames(template_of(mesh, mesh.still[order]), other_template=True)
    frames = mesh.frames.copy()
    frames[5] = frames[5][order]
    with pytest.raises(UserError, match="frame 5 has other proportions than frame 0"):
        check_frames(replace(mesh, frames=frames))


def test_a_mirror_image_is_known_in_any_pose_by_which_way_edges_bend():
    """A body in a walk against its rest pose, arms up to the sides; fine wrinkles and flat patterns tell nothing."""
    baked = load_body("base", "small")
    steps = walk(baked, GAITS["armspace-75"], np.linspace(0, 1, 5), np.ones(5))
    frames = pose(baked, steps.rotations, steps.root)
    body = MeshSequence("body", frames, baked.body.faces, rest=baked.body.rest, files=(Path("a.pc2"), Path("a.obj")))
    for t in range(5):
        check_frames(replace(body, frames=frames[t:]))
        with pytest.raises(UserError, match="a.pc2: a.obj is the mirror image of frame 0; export both with the same"):
            check_frames(replace(body, frames=frames[t:] * np.float32([1, -1, 1])))
        with pytest.raises(UserError, match="mirror image"):
            check_frames(replace(body, rest=baked.body.rest[:, [0, 2, 1]], frames=frames[t:]))
    cloth = moving("garment")
    noise = np.random.default_rng(0).normal(0, 0.002, cloth.frames.shape).astype(np.float32)
    check_frames(replace(cloth, frames=cloth.frames + noise, rest=cloth.still))
    check_frames(replace(cloth, rest=cloth.still * np.float32([1, 1, 0])), other_template=True)


@pytest.mark.parametrize("write", [pc2, mdd, usd, alembic])
def test_the_check_is_made_in_every_format_and_can_be_waived(tmp_path, capsys, write):
    mesh = moving("garment")
    other = mesh.still[np.random.default_rng(0).permutation(len(mesh.still))]

    def spoilt(folder, name, *rest):
        files = write(folder, name, *rest)
        if name == "garment":
            write_template(files[1], replace(mesh, rest=other))
        return files

    code, _, err = run(tmp_path, capsys, spoilt, (0.0, 1.0), (0.0, 1.0), *fps_of(write))
    assert code == 1 and "another order of vertices" in err[0]
    (tmp_path / "again").mkdir()
    more = ("--other-template", *fps_of(write))
    assert run(tmp_path / "again", capsys, spoilt, (0.0, 1.0), (0.0, 1.0), *more)[0] == 0
