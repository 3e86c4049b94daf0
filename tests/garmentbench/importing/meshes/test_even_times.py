"""Frames at uneven times, in every format that states times: interpolated with a word, or refused with what to do."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from exchange_example import MESHES

from garmentbench.errors import UserError
from garmentbench.importing.meshes.arrays import write_npz
from garmentbench.importing.meshes.mesh_sequence import MeshSequence
from garmentbench.importing.meshes.obj import write_template
from garmentbench.importing.meshes.point_caches import write_mdd
from garmentbench.importing.meshes.reading import read_meshes

CLOTH = MESHES["garment"]
UNEVEN = np.array([0.2, 0.24, 0.27, 0.33, 0.37, 0.45, 0.48, 0.52])  # [s]; median step 0.04
GAP = np.array([0.0, 0.04, 0.08, 0.5, 0.54, 0.58])
SPEED = np.array([1.0, 0.0, 0.5])  # [m/s]


def at(times: np.ndarray) -> np.ndarray:
    """A shirt that travels evenly."""
    return (CLOTH.still + times[:, None, None] * SPEED).astype(np.float32)


def mdd(folder: Path, times: np.ndarray) -> MeshSequence:
    mesh = MeshSequence(**vars(CLOTH) | {"frames": at(times)})
    write_mdd(folder / "a.mdd", mesh)
    write_template(folder / "a.obj", mesh)
    data = bytearray((folder / "a.mdd").read_bytes())
    data[8 : 8 + 4 * len(times)] = times.astype(">f4").tobytes()
    (folder / "a.mdd").write_bytes(data)
    return read_meshes(str(folder / "a.mdd"), folder / "a.obj")


def npz(folder: Path, times: np.ndarray) -> MeshSequence:
    np.savez(folder / "a.npz", positions=at(times), faces=CLOTH.faces, times=times)
    return read_meshes(str(folder / "a.npz"))


def hdf5(folder: Path, times: np.ndarray) -> MeshSequence:
    with h5py.File(folder / "a.h5", "w") as file:
        file["positions"], file["faces"], file["times"] = at(times), CLOTH.faces, times
    return read_meshes(str(folder / "a.h5"))


def usd(folder: Path, times: np.ndarray) -> MeshSequence:
    pytest.importorskip("pxr", reason="usd-core is an extra")
    from pxr import Usd, UsdGeom, Vt

    stage = Usd.Stage.CreateNew(str(folder / "a.usdc"))
    stage.SetTimeCodesPerSecond(1000)
    prim = UsdGeom.Mesh.Define(stage, "/shirt")
    prim.CreateFaceVertexCountsAttr([3] * len(CLOTH.faces))
    prim.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(CLOTH.faces.ravel()))
    points = prim.CreatePointsAttr()
    for time, frame in zip(times, at(times), strict=True):
        points.Set(Vt.Vec3fArray.FromNumpy(frame), 1000 * time)
    stage.GetRootLayer().Save()
    return read_meshes(str(folder / "a.usdc"))


def alembic(folder: Path, times: np.ndarray) -> MeshSequence:
    pytest.importorskip("alembic3d", reason="alembic3d is an extra")
    write_alembic(folder / "a.abc", times)
    return read_meshes(str(folder / "a.abc"))


def write_alembic(path: Path, times: np.ndarray, moves: np.ndarray | None = None, inherits: bool = True) -> None:
    """Points sampled at some times; above them a transform that moves along y by the time at other times."""
    import imath
    from alembic3d import Abc, AbcCoreAbstract, AbcGeom

    def filled(kind, values):
        array = kind(len(values))
        np.asarray(memoryview(array))[:] = values
        return array

    def sampling(archive, times):
        vector = AbcCoreAbstract.TimeVector()
        vector.extend([float(t) for t in times])
        once = AbcCoreAbstract.TimeSamplingType(len(times), 1000.0)  # one cycle, longer than the motion
        return archive.addTimeSampling(AbcCoreAbstract.TimeSampling(once, vector))

    top = Abc.OArchive(str(path)).getTop()
    archive, parent = top.getArchive(), top
    if moves is not None:
        lifted = AbcGeom.OXform(top, "lifted", sampling(archive, moves))
        sample = AbcGeom.XformSample()
        sample.setTranslation(imath.V3d(0, 0, 7))
        lifted.getSchema().set(sample)
        parent = AbcGeom.OXform(lifted, "moved", sampling(archive, moves))
        for t in moves:
            sample = AbcGeom.XformSample()
            sample.setTranslation(imath.V3d(0, float(t), 0))
            sample.setInheritsXforms(inherits)
            parent.getSchema().set(sample)
    schema = AbcGeom.OPolyMesh(parent, "shirt", sampling(archive, times)).getSchema()
    for frame in at(times):
        counts = filled(imath.IntArray, np.full(len(CLOTH.faces), 3))
        faces = filled(imath.IntArray, CLOTH.faces[:, ::-1].ravel())
        schema.set(AbcGeom.OPolyMeshSchemaSample(filled(imath.V3fArray, frame), faces, counts))


FORMATS = [mdd, npz, hdf5, usd, alembic]


@pytest.mark.parametrize("write", FORMATS)
def test_little_unevenness_is_interpolated_and_said(tmp_path, write):
    mesh = write(tmp_path, UNEVEN)
    even = 0.2 + np.arange(9) / 25
    assert mesh.fps == 25
    np.testing.assert_allclose(mesh.times, even, atol=1e-6)
    np.testing.assert_allclose(mesh.frames, at(even), atol=2e-6)
    said = [note for note in mesh.notes if "uneven" in note or "samples at" in note]
    assert said == ["times are uneven, 0.03 to 0.08 s apart: interpolated at 25 frames a second"]


@pytest.mark.parametrize("write", [mdd, npz, hdf5, alembic])
def test_a_gap_is_refused_with_what_to_do(tmp_path, write):
    with pytest.raises(UserError) as error:
        write(tmp_path, GAP)
    line = str(error.value)
    assert "\n" not in line and f"{tmp_path / 'a.'}" in line
    assert "frames 2 and 3 are at 0.08 s and 0.5 s" in line and "export at a constant frame rate, or cut it" in line


@pytest.mark.parametrize("write", FORMATS)
@pytest.mark.parametrize("off", [0.0, 0.0004])
def test_even_and_rounded_times_stay_as_they_are(tmp_path, write, off):
    times = np.arange(6) / 25
    times[1:-1:2] += off
    mesh = write(tmp_path, times)
    assert mesh.fps == pytest.approx(25, rel=1e-3) and mesh.notes == ()
    np.testing.assert_array_equal(mesh.frames, at(times))


@pytest.mark.parametrize("write", [npz, hdf5])
def test_times_that_don_t_increase_and_a_rate_that_contradicts_them(tmp_path, write):
    for times in ([0.0, 0.1, 0.1], [0.0, 0.2, 0.1]):
        with pytest.raises(UserError, match="frames 1 and 2 are at .* wanted times that increase; export"):
            write(tmp_path, np.array(times))
    write_npz(tmp_path / "b.npz", CLOTH)
    with np.load(tmp_path / "b.npz") as arrays:
        np.savez(tmp_path / "b.npz", **arrays, times=np.arange(len(CLOTH.frames)) / 30)
    with pytest.raises(
        UserError, match="b.npz: fps is 25, its times are 30 a second; write only the one that is right"
    ):
        read_meshes(str(tmp_path / "b.npz"))


@pytest.mark.parametrize("inherits", [True, False])
def test_alembic_points_and_transforms_of_different_times(tmp_path, inherits):
    """A transform is interpolated where the points have samples, or the points where the transform has more."""
    pytest.importorskip("alembic3d", reason="alembic3d is an extra")
    few, many, far = np.arange(5) / 25, np.arange(17) / 100, np.array([-1.0, 3.0])
    lifted = np.array([0, 0, 7.0 * inherits])
    for points, moves, times in ((few, many, many), (many, few, many), (few, far, few)):
        write_alembic(tmp_path / "a.abc", points, moves, inherits)
        mesh = read_meshes(str(tmp_path / "a.abc"))
        np.testing.assert_allclose(mesh.times, times, atol=1e-6)
        moved = times[:, None, None] * np.array([0.0, 1.0, 0.0])
        np.testing.assert_allclose(mesh.frames, at(times) + moved + lifted, atol=1e-5)
