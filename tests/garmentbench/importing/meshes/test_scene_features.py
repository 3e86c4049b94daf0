"""What USD and Alembic keep elsewhere: skeletons, instances, mirroring transforms, sparse samples, subdivision
meshes.
"""

import numpy as np
import pytest
from exchange_example import MESHES

from garmentbench.errors import UserError
from garmentbench.importing.meshes.reading import read_both, read_meshes

CLOTH, BODY = MESHES["garment"], MESHES["body"]


def stage(path):
    pytest.importorskip("pxr", reason="usd-core is an extra")
    from pxr import Usd, UsdGeom

    made = Usd.Stage.CreateNew(str(path))
    made.SetTimeCodesPerSecond(25)
    UsdGeom.SetStageUpAxis(made, "Z")
    UsdGeom.SetStageMetersPerUnit(made, 1.0)
    return made


def put(made, path, mesh, codes=None, frames=None):
    from pxr import UsdGeom, Vt

    prim = UsdGeom.Mesh.Define(made, path)
    prim.CreateFaceVertexCountsAttr([3] * len(mesh.faces))
    prim.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(mesh.faces.ravel().astype(np.int32)))
    points = prim.CreatePointsAttr()
    frames = mesh.frames[:1] if frames is None else frames
    for k, frame in enumerate(frames):
        value = Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(frame, np.float32))
        points.Set(value, codes[k]) if codes is not None else points.Set(value)
    return prim


def skinned(path, root: str = "SkelRoot"):
    """A body of one bone that travels 10 cm a frame along x, beside a sampled shirt."""
    from pxr import Gf, Usd, UsdGeom, UsdSkel, Vt

    made = stage(path)
    made.DefinePrim("/w", root)
    skeleton = UsdSkel.Skeleton.Define(made, "/w/bones")
    skeleton.CreateJointsAttr(["hips"])
    skeleton.CreateBindTransformsAttr([Gf.Matrix4d(1)])
    skeleton.CreateRestTransformsAttr([Gf.Matrix4d(1)])
    motion = UsdSkel.Animation.Define(made, "/w/motion")
    motion.CreateJointsAttr(["hips"])
    motion.CreateRotationsAttr([Gf.Quatf(1)])
    motion.CreateScalesAttr(Vt.Vec3hArray([Gf.Vec3h(1)]))
    move = motion.CreateTranslationsAttr()
    for t in range(6):
        move.Set(Vt.Vec3fArray([Gf.Vec3f(0.1 * t, 0, 0)]), t)
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets(["/w/motion"])
    body = put(made, "/w/avatar", BODY)
    binding = UsdSkel.BindingAPI.Apply(body.GetPrim())
    binding.CreateSkeletonRel().SetTargets(["/w/bones"])
    count = len(BODY.still)
    binding.CreateJointIndicesPrimvar(False, 1).Set([0] * count)
    binding.CreateJointWeightsPrimvar(False, 1).Set([1.0] * count)
    put(made, "/w/shirt", CLOTH, range(6), CLOTH.frames[:1] + np.arange(6)[:, None, None] * np.float32([0.1, 0, 0]))
    made.GetRootLayer().Save()
    assert Usd and UsdGeom
    return path


def test_a_skinned_body_is_baked(tmp_path):
    pytest.importorskip("pxr")
    cloth, body = read_both((str(skinned(tmp_path / "a.usdc")), None, "shirt"), ("", None, "avatar"))
    expected = BODY.frames[:1] + np.arange(6)[:, None, None] * np.float32([0.1, 0, 0])
    np.testing.assert_allclose(body.frames, expected, atol=1e-5)
    assert body.notes[0] == "moved by its skeleton bones: baked" and len(cloth.frames) == 6


def test_a_skinned_body_that_can_t_be_baked_is_refused(tmp_path):
    """Without a SkelRoot above it USD does not pose it."""
    pytest.importorskip("pxr")
    path = skinned(tmp_path / "a.usdc", root="Xform")
    try:
        mesh = read_meshes(str(path), prim="avatar")
    except UserError as e:
        assert "moved by the skeleton bones, which could not be applied" in str(e)
    else:
        assert np.ptp(mesh.frames[:, 0, 0]) == pytest.approx(0.5)


def test_bodies_inside_instances_are_read(tmp_path):
    made = stage(tmp_path / "a.usda")
    from pxr import Gf, UsdGeom

    put(made, "/proto/body", BODY, range(6), BODY.frames)
    made.GetPrimAtPath("/proto").SetSpecifier(__import__("pxr").Sdf.SpecifierClass)
    place = UsdGeom.Xform.Define(made, "/w/someone")
    place.AddTranslateOp().Set(Gf.Vec3d(1, 2, 0))
    place.GetPrim().GetReferences().AddInternalReference("/proto")
    place.GetPrim().SetInstanceable(True)
    put(made, "/w/shirt", CLOTH, range(6), CLOTH.frames)
    made.GetRootLayer().Save()
    _, body = read_both((str(tmp_path / "a.usda"), None, ""), ("", None, ""))
    assert body is not None
    np.testing.assert_allclose(body.frames, BODY.frames + np.float32([1, 2, 0]), atol=1e-6)


def test_what_is_no_mesh_is_named(tmp_path):
    made = stage(tmp_path / "a.usda")
    from pxr import UsdGeom

    UsdGeom.BasisCurves.Define(made, "/w/hair")
    UsdGeom.Sphere.Define(made, "/w/head")
    made.GetRootLayer().Save()
    with pytest.raises(UserError, match=r"what it has is not read: hair \(BasisCurves\), head \(Sphere\)"):
        read_meshes(str(tmp_path / "a.usda"))
    put(made, "/w/shirt", CLOTH, range(6), CLOTH.frames)
    made.GetRootLayer().Save()
    notes = read_meshes(str(tmp_path / "a.usda")).notes
    assert "not read of this file: hair (BasisCurves), head (Sphere)" in notes


def test_a_mirroring_transform_turns_the_faces_with_it(tmp_path):
    made = stage(tmp_path / "a.usda")
    from pxr import Gf, UsdGeom

    UsdGeom.Xform.Define(made, "/w").AddScaleOp().Set(Gf.Vec3f(-1, 1, 1))
    put(made, "/w/shirt", CLOTH, range(6), CLOTH.frames)
    made.GetRootLayer().Save()
    mesh = read_meshes(str(tmp_path / "a.usda"))
    np.testing.assert_allclose(mesh.frames, CLOTH.frames * np.float32([-1, 1, 1]), atol=1e-6)
    assert volume(mesh.frames[0], mesh.faces) == pytest.approx(volume(CLOTH.frames[0], CLOTH.faces), rel=1e-4)
    assert "its transform mirrors it: the faces are turned with it" in mesh.notes


def volume(x: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = (x[faces[:, k]].astype(float) - x.mean(axis=0) for k in range(3))
    return float(np.sum(a * np.cross(b, c)))


def test_sparse_samples_are_interpolated_as_usd_does(tmp_path):
    """Two samples left out of a straight motion."""
    made = stage(tmp_path / "a.usda")
    straight = CLOTH.frames[:1] + np.arange(6)[:, None, None] * np.float32([0.1, 0, 0])
    put(made, "/w/shirt", CLOTH, [0, 1, 4, 5], straight[[0, 1, 4, 5]])
    made.GetRootLayer().Save()
    mesh = read_meshes(str(tmp_path / "a.usda"))
    np.testing.assert_allclose(mesh.frames, straight, atol=1e-6)
    assert mesh.fps == 25 and mesh.notes[0].startswith("samples at 4 of 6 times")


def alembic(path, schema: str, scale: float = 1.0):
    pytest.importorskip("alembic3d", reason="alembic3d is an extra")
    import imath
    from alembic3d import Abc, AbcCoreAbstract, AbcGeom

    def filled(kind, values):
        array = kind(len(values))
        np.asarray(memoryview(array))[:] = values
        return array

    top = Abc.OArchive(str(path)).getTop()
    rate = top.getArchive().addTimeSampling(AbcCoreAbstract.TimeSampling(1 / 25, 0.0))
    parent = AbcGeom.OXform(top, "world", rate)
    sample = AbcGeom.XformSample()
    sample.setScale(imath.V3d(scale, 1, 1))
    parent.getSchema().set(sample)
    mesh = getattr(AbcGeom, f"O{schema}")(parent, "shirt", rate).getSchema()
    for frame in CLOTH.frames:
        arguments = (filled(imath.V3fArray, frame), filled(imath.IntArray, CLOTH.faces[:, ::-1].ravel()),
                     filled(imath.IntArray, np.full(len(CLOTH.faces), 3)))  # fmt: skip
        mesh.set(getattr(AbcGeom, f"O{schema}SchemaSample")(*arguments))
    return path


@pytest.mark.parametrize("schema", ["PolyMesh", "SubD"])
@pytest.mark.parametrize("scale", [1.0, -1.0])
def test_alembic_meshes_of_both_kinds_and_mirrored(tmp_path, schema, scale):
    mesh = read_meshes(str(alembic(tmp_path / "a.abc", schema, scale)))
    np.testing.assert_allclose(mesh.frames, CLOTH.frames * np.float32([scale, 1, 1]), atol=1e-6)
    assert volume(mesh.frames[0], mesh.faces) == pytest.approx(volume(CLOTH.frames[0], CLOTH.faces), rel=1e-4)
    assert (mesh.notes == ()) == (scale > 0)
