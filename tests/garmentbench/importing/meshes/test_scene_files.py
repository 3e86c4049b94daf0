"""USD written by usd-core, Alembic written by alembic3d: transforms, rates, UV, several meshes.

And what damages them.
"""

from dataclasses import replace

import numpy as np
import pytest
from exchange_example import MESHES, SEQUENCE

from garmentbench.errors import UserError
from garmentbench.importing.meshes.choosing import choose
from garmentbench.importing.meshes.reading import read_both, read_meshes
from garmentbench.importing.sequences import _left_out

CLOTH, BODY = MESHES["garment"], MESHES["body"]
SHIFT = np.array([1.0, 2.0, 3.0])


def usd(path, unit=0.01, up="Y", changing=False, uv="faceVarying", more=()):
    """A stage as a DCC tool writes it: a moving parent, quads, a clockwise mesh, a rate of 25."""
    pxr = pytest.importorskip("pxr", reason="usd-core is an extra")
    from pxr import Gf, Sdf, Usd, UsdGeom, Vt

    assert pxr
    stage = Usd.Stage.CreateNew(str(path))
    if unit:
        UsdGeom.SetStageMetersPerUnit(stage, unit)
        UsdGeom.SetStageUpAxis(stage, up)
    stage.SetTimeCodesPerSecond(50)
    above = UsdGeom.Xform.Define(stage, "/world")
    move = above.AddTranslateOp()
    for name, mesh in (("tunic", CLOTH), ("avatar", BODY), *((other, BODY) for other in more)):
        prim = UsdGeom.Mesh.Define(stage, f"/world/{name}")
        faces = mesh.faces[:, ::-1]
        prim.CreateOrientationAttr(UsdGeom.Tokens.leftHanded)
        prim.CreateFaceVertexCountsAttr([3] * len(faces))
        indices = prim.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(faces.ravel().astype(np.int32)))
        if changing:
            indices.Set(Vt.IntArray.FromNumpy(faces.ravel().astype(np.int32)), 0)
            indices.Set(Vt.IntArray.FromNumpy(np.roll(faces, 1).ravel().astype(np.int32)), 4)
        points = prim.CreatePointsAttr()
        for t, frame in enumerate(mesh.frames):
            points.Set(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(frame)), 2 * t)
            move.Set(Gf.Vec3d(*(SHIFT * t)), 2 * t)
        if mesh is CLOTH:
            values = mesh.corner_uv[:, ::-1].reshape(-1, 2)
            if uv == "vertex":
                values = np.zeros((len(mesh.still), 2), np.float32)
                values[mesh.faces.ravel()] = mesh.corner_uv.reshape(-1, 2)
            primvar = UsdGeom.PrimvarsAPI(prim).CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, uv)
            primvar.Set(Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(values)))
    stage.GetRootLayer().Save()
    return path


def moved(frames):
    return frames + SHIFT * np.arange(len(frames))[:, None, None]


@pytest.mark.parametrize(("name", "uv"), [("a.usda", "faceVarying"), ("a.usdc", "vertex")])
def test_usd_of_usd_core(tmp_path, name, uv):
    cloth, body = read_both((str(usd(tmp_path / name, uv=uv)), None, "tunic"), ("", None, ""))
    np.testing.assert_allclose(cloth.frames, moved(CLOTH.frames), atol=2e-6)
    np.testing.assert_allclose(body.frames, moved(BODY.frames), atol=2e-6)
    assert {tuple(np.roll(f, -f.argmin())) for f in cloth.faces} == {
        tuple(np.roll(f, -f.argmin())) for f in CLOTH.faces
    }
    by_corner = {(v, *uv) for v, uv in zip(cloth.faces.ravel(), cloth.corner_uv.reshape(-1, 2).tolist(), strict=True)}
    assert by_corner == {
        (v, *uv) for v, uv in zip(CLOTH.faces.ravel(), CLOTH.corner_uv.reshape(-1, 2).tolist(), strict=True)
    }
    assert (cloth.fps, cloth.unit, cloth.up, cloth.name, body.name) == (25.0, 0.01, "y", "tunic", "avatar")


def test_usd_that_says_no_unit(tmp_path):
    mesh = read_meshes(str(usd(tmp_path / "a.usdc", unit=None)), prim="/world/avatar")
    assert (mesh.unit, mesh.up, mesh.corner_uv) == (None, None, None)


def test_usd_whose_faces_change(tmp_path):
    with pytest.raises(UserError, match="faceVertexIndices changes at its sample 1, wanted one mesh in all frames"):
        read_meshes(str(usd(tmp_path / "a.usdc", changing=True)), prim="tunic")


def test_which_mesh_is_meant(tmp_path):
    names = ["/world/tunic", "/world/avatar", "/world/inner/shirt"]
    assert choose(tmp_path, names, "", "garment") == "/world/inner/shirt"
    assert choose(tmp_path, names, "", "body") == choose(tmp_path, names, "", "body if named so") == "/world/avatar"
    assert choose(tmp_path, names, "world/tunic", "garment") == "/world/tunic"
    assert choose(tmp_path, ["/a/thing"], "", "garment") == "/a/thing"
    assert choose(tmp_path, ["/a/body"], "", "body if named so") is None  # the only mesh is the garment
    for prim, says in (("unic", "0 meshes are called 'unic'"), ("", r"holds 2 meshes \(/a/x, /a/y\)")):
        with pytest.raises(UserError, match=says + ".*--mesh"):
            choose(tmp_path, ["/a/x", "/a/y"], prim, "garment")
    with pytest.raises(UserError, match="has no polygon mesh"):
        choose(tmp_path, [], "", "garment")


def alembic(path, more=()):
    """An archive with a moving parent and a rate of 25, listed clockwise as Alembic's meshes are."""
    pytest.importorskip("alembic3d", reason="alembic3d is an extra")
    import imath
    from alembic3d import Abc, AbcCoreAbstract, AbcGeom

    top = Abc.OArchive(str(path)).getTop()
    rate = top.getArchive().addTimeSampling(AbcCoreAbstract.TimeSampling(1 / 25, 0.0))
    parent = AbcGeom.OXform(top, "world", rate)
    for t in range(len(SEQUENCE)):
        sample = AbcGeom.XformSample()
        sample.setTranslation(imath.V3d(*(SHIFT * t)))
        parent.getSchema().set(sample)
    faces, uv = CLOTH.faces[:, ::-1].ravel(), CLOTH.corner_uv[:, ::-1].reshape(-1, 2)
    by_corner = AbcGeom.OV2fGeomParamSample(filled(imath.V2fArray, uv), AbcGeom.GeometryScope.kFacevaryingScope)
    schemas = [AbcGeom.OPolyMesh(parent, name, rate).getSchema() for name in ("shirt", *more)]
    for schema, frame in ((schema, frame) for schema in schemas for frame in SEQUENCE.garment):
        counts = filled(imath.IntArray, np.full(len(CLOTH.faces), 3))
        schema.set(
            AbcGeom.OPolyMeshSchemaSample(
                filled(imath.V3fArray, frame), filled(imath.IntArray, faces), counts, by_corner
            )
        )
    return path


def filled(kind, values):
    array = kind(len(values))
    np.asarray(memoryview(array))[:] = values
    return array


def test_alembic_of_alembic3d(tmp_path):
    mesh = read_meshes(str(alembic(tmp_path / "a.abc")))
    np.testing.assert_allclose(mesh.frames, moved(CLOTH.frames), atol=2e-6)
    np.testing.assert_array_equal(mesh.faces, CLOTH.faces)
    np.testing.assert_allclose(mesh.corner_uv, CLOTH.corner_uv, atol=1e-6)
    assert (mesh.fps, mesh.unit, mesh.up, mesh.name) == (25.0, None, None, "shirt")


@pytest.mark.parametrize("write", [usd, alembic])
def test_meshes_that_are_neither_garment_nor_body_are_named(tmp_path, write):
    """From one file with a body in it, and beside a body of its own file."""
    more = ("chair", "lamp") if write is usd else ("avatar", "chair", "lamp")
    file, name = str(write(tmp_path / ("a.usdc" if write is usd else "a.abc"), more=more)), "tunic"
    cloth, body = read_both((file, None, name if write is usd else "shirt"), ("", None, ""))
    assert body is not None and len(cloth.beside) == len(body.beside) == 3
    line = f"meshes of {file} that are not read: /world/chair, /world/lamp"
    assert _left_out(cloth, body) == [line]
    assert _left_out(cloth, replace(BODY, files=(tmp_path / "b.obj",))) == [line.replace(": ", ": /world/avatar, ")]
    assert _left_out(CLOTH, BODY) == []


@pytest.mark.parametrize("write", [usd, alembic])
def test_damaged_scene_files_end_in_one_line(tmp_path, write):
    """Few cases, since each is a process of its own."""
    path = tmp_path / ("a.abc" if write is alembic else "a.usdc")
    whole = write(path).read_bytes()
    flipped = bytearray(whole)
    flipped[len(whole) // 2 : len(whole) // 2 + 64] = b"\xff" * 64
    for broken in (b"", whole[: len(whole) // 2], whole[:-1], b"\xff" * 16 + whole[16:], bytes(flipped)):
        path.write_bytes(broken)
        try:
            read_meshes(str(path), prim="" if write is alembic else "tunic")
        except UserError as e:
            assert str(e).startswith(str(path)) and "\n" not in str(e)
        else:
            assert broken in (whole[:-1], bytes(flipped))  # the rest can't be read at all


def test_a_reader_that_dies_or_hangs_is_one_line(tmp_path, monkeypatch):
    from garmentbench.importing.meshes import subprocess_reader as apart

    (tmp_path / "a.usdc").write_bytes(b"PXR-USDC")
    monkeypatch.setattr(apart.sys, "executable", "/bin/false")
    with pytest.raises(UserError, match="damaged: its library gave up .exit code 1"):
        read_meshes(str(tmp_path / "a.usdc"))
    (tmp_path / "sleeper").write_text("#!/bin/sh\nexec sleep 60\n")
    (tmp_path / "sleeper").chmod(0o755)
    monkeypatch.setattr(apart.sys, "executable", str(tmp_path / "sleeper"))
    monkeypatch.setattr(apart, "_SECONDS", 0.2)
    with pytest.raises(UserError, match="its library did not finish in 0 s: it is damaged"):
        read_meshes(str(tmp_path / "a.usdc"))
