"""Garment and body as moving meshes in every format that has times, from any frame on and at any rate."""

import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from exchange_example import MESHES, typed

from garmentbench.importing.meshes.arrays import write_npz
from garmentbench.importing.meshes.mesh_sequence import MeshSequence
from garmentbench.importing.meshes.obj import write_series, write_template
from garmentbench.importing.meshes.point_caches import write_mdd, write_pc2

T, STEP = 8, np.float32([0.02, 0.0, 0.0])  # everything moves by 2 cm a frame of 25 a second


def moving(name: str, start: float = 0.0, every: float = 1.0) -> MeshSequence:
    """Garment or body, its frames from `start` on [frames], one in `every`."""
    mesh = MESHES[name]
    at = start + every * np.arange(T)
    frames = mesh.frames[:1] + at[:, None, None].astype(np.float32) * STEP
    return replace(mesh, frames=frames, fps=25.0 / every)


def pc2(folder: Path, name: str, mesh: MeshSequence, start: float, every: float) -> list:
    write_pc2(folder / f"{name}.pc2", mesh)
    data = bytearray((folder / f"{name}.pc2").read_bytes())
    data[20:28] = struct.pack("<ff", start, every)
    (folder / f"{name}.pc2").write_bytes(data)
    write_template(folder / f"{name}.obj", mesh)
    return [folder / f"{name}.pc2", folder / f"{name}.obj"]


def mdd(folder: Path, name: str, mesh: MeshSequence, start: float, every: float) -> list:
    write_mdd(folder / f"{name}.mdd", mesh)
    data, count = bytearray((folder / f"{name}.mdd").read_bytes()), len(mesh.frames)
    times = (start + every * np.arange(count)) / 25
    data[8 : 8 + 4 * count] = times.astype(">f4").tobytes()
    (folder / f"{name}.mdd").write_bytes(data)
    write_template(folder / f"{name}.obj", mesh)
    return [folder / f"{name}.mdd", folder / f"{name}.obj"]


def obj(folder: Path, name: str, mesh: MeshSequence, start: float, every: float) -> list:
    written = write_series(folder / "first", mesh)
    (folder / name).mkdir()
    for k, path in enumerate(written):
        path.rename(folder / name / f"{name}_{round(100 + start + every * k):04d}.obj")
    write_template(folder / f"{name}.obj", mesh)
    return [folder / name, folder / f"{name}.obj"]


def npz(folder: Path, name: str, mesh: MeshSequence, start: float, every: float) -> list:
    write_npz(folder / f"{name}.npz", mesh)
    with np.load(folder / f"{name}.npz") as arrays:
        times = (start + every * np.arange(len(mesh.frames))) / 25
        np.savez(folder / f"{name}.npz", **{**arrays, "times": times})
    return [folder / f"{name}.npz", None]


def hdf5(folder: Path, name: str, mesh: MeshSequence, start: float, every: float) -> list:
    import h5py

    npz(folder, name, mesh, start, every)
    with np.load(folder / f"{name}.npz") as arrays, h5py.File(folder / f"{name}.h5", "w") as file:
        for key, array in arrays.items():
            if key != "up" and array.size:
                file[key] = array
        file.attrs["up"] = "z"
    return [folder / f"{name}.h5", None]


def usd(folder: Path, name: str, mesh: MeshSequence, start: float, every: float) -> list:
    pytest.importorskip("pxr")
    from pxr import Usd, UsdGeom, Vt

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


def alembic(folder: Path, name: str, mesh: MeshSequence, start: float, every: float) -> list:
    pytest.importorskip("alembic3d")
    import imath
    from alembic3d import Abc, AbcCoreAbstract, AbcGeom

    def filled(kind, values):
        array = kind(len(values))
        np.asarray(memoryview(array))[:] = values
        return array

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
STATE_RATE = (mdd, npz, hdf5, usd, alembic)


def run(tmp_path, capsys, write, garment=(0.0, 1.0), body=(0.0, 1.0), *more, write_body=None, spoil=lambda mesh: mesh):
    """Exit code, output and complaints of `import`; starts and steps of both are in frames, the garment is spoilt."""
    mesh = spoil(moving("garment", *garment))
    (cloth, cut), (skin, shape) = (
        write(tmp_path, "garment", mesh, *garment),
        (write_body or write)(tmp_path, "body", moving("body", *body), *body),
    )
    templates = ["--template", cut] * (cut is not None) + ["--body-template", shape] * (shape is not None)
    common = ["--kind", "object", "--units", "m", "--up", "z", "--out", tmp_path / "x.h5"]
    return typed(capsys, "import", cloth, "--body", skin, *templates, *common, *more)
