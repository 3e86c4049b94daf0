"""USD: time-sampled points of polygon meshes, with their world transforms, UV (primvar st), unit, up axis and rate.

Needs `usd-core` (the extra `usd`). Damaged files may crash its library: `subprocess_reader` calls `read_usd` in a
process of its own.
"""

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from garmentbench.errors import UserError
from garmentbench.importing.meshes.choosing import choose
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal
from garmentbench.importing.meshes.polygons import PolygonFrames, from_polygons
from garmentbench.storage.atomic import written_whole

if TYPE_CHECKING:
    from pxr import Usd, UsdGeom, UsdSkel, Vt

_AGAIN = "export it again"
_UV_NAMES = ("st", "uv", "UVMap", "st0", "map1")


def read_usd(path: Path, prim: str, role: str) -> MeshSequence | None:
    """A mesh of a USD file, as `subprocess_reader.read_isolated`, which is the safe way to call it."""
    Usd, UsdGeom, Tf = _packages()
    try:
        stage = Usd.Stage.Open(str(path))
        baked = _bake(stage)
        meshes = {str(p.GetPath()): UsdGeom.Mesh(p) for p in stage.Traverse() if p.IsA(UsdGeom.Mesh)}
        unread = [f"{p.GetName()} ({p.GetTypeName()})" for p in stage.Traverse() if _has_other_shape(p)]
        if not meshes and unread:
            found = f"has no polygon mesh, wanted one; what it has is not read: {', '.join(unread[:8])}"
            raise refusal(path, found, "export the meshes with their faces")
        name = choose(path, list(meshes), prim, role)
        if name is None:
            return None
        return replace(_mesh(path, stage, meshes[name], baked, unread), beside=tuple(n for n in meshes if n != name))
    except Tf.ErrorException as e:
        raise refusal(path, f"damaged, or no USD file ({_reason(e)})", _AGAIN) from e


def write_usd(path: Path, meshes: list[MeshSequence]) -> None:
    """Meshes in metres, z up, with the frame rate of the first, a time code a frame from 1 on; .usdc or .usda.

    Each has its rest shape as primvar "rest". Raises `UserError` when it can't be written, or usd-core is missing.
    """
    Usd, UsdGeom, Tf = _packages()
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    stage.SetTimeCodesPerSecond(meshes[0].fps)
    stage.SetFramesPerSecond(meshes[0].fps)
    stage.SetStartTimeCode(1)
    stage.SetEndTimeCode(len(meshes[0].frames))
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/garmentbench").GetPrim())
    for mesh in meshes:
        _define(stage, mesh)
    beside = path.with_name(f"{path.stem}.partial{path.suffix}")  # the ending decides the format
    try:
        with written_whole(path) as partial:
            if not stage.GetRootLayer().Export(str(beside)):
                raise OSError("usd-core could not write it")
            os.replace(beside, partial)
    except Tf.ErrorException as e:
        raise UserError(f"{path}: can't be written ({_reason(e)}); free some space there or use another disk") from e
    finally:
        beside.unlink(missing_ok=True)


def _packages() -> tuple:
    try:
        from pxr import Tf, Usd, UsdGeom
    except ImportError as e:
        raise UserError("USD needs the package usd-core; pip install usd-core, or use PC2, OBJ or npz") from e
    return Usd, UsdGeom, Tf


def _reason(error: Exception) -> str:
    """The first of the messages in one of USD's exceptions, without the places in its own code."""
    return str(error).strip().splitlines()[0].split(" : '", 1)[-1].rstrip("'")[:120]


def _bake(stage: "Usd.Stage") -> set[str]:
    """Open instances, and turn skeletons' motion into points, on top of the stage; gives the paths of the meshes
    moved so.
    """
    from pxr import Usd, UsdGeom, UsdSkel

    stage.SetEditTarget(stage.GetSessionLayer())
    while closed := [p for p in stage.Traverse() if p.IsInstance()]:
        for prim in closed:
            prim.SetInstanceable(False)
    skinned = {}
    for prim in stage.Traverse():
        if prim.IsA(UsdGeom.Mesh) and UsdSkel.BindingAPI(prim).GetInheritedSkeleton():
            skinned[str(prim.GetPath())] = UsdGeom.Mesh(prim).GetPointsAttr().GetNumTimeSamples()
    if skinned:
        UsdSkel.BakeSkinning(Usd.PrimRange(stage.GetPseudoRoot()))
    return {
        p for p, before in skinned.items() if UsdGeom.Mesh.Get(stage, p).GetPointsAttr().GetNumTimeSamples() > before
    }


def _has_other_shape(prim: "Usd.Prim") -> bool:
    """A shape that is no mesh: curves, points, spheres, instances scattered by a PointInstancer."""
    from pxr import UsdGeom

    return (prim.IsA(UsdGeom.Gprim) and not prim.IsA(UsdGeom.Mesh)) or prim.IsA(UsdGeom.PointInstancer)


def _mesh(path: Path, stage: "Usd.Stage", mesh: "UsdGeom.Mesh", baked: set[str], unread: list[str]) -> MeshSequence:
    from pxr import UsdGeom, UsdSkel

    prim = mesh.GetPrim()
    skeleton = UsdSkel.BindingAPI(prim).GetInheritedSkeleton()
    if skeleton and str(prim.GetPath()) not in baked and _is_animated(skeleton):
        found = f"{prim.GetName()} is moved by the skeleton {skeleton.GetPrim().GetName()}, which could not be applied"
        raise refusal(path, found, "export it with baked positions, or put both under one SkelRoot")
    codes, filled = _filled(_time_codes(mesh))
    notes = [f"moved by its skeleton {skeleton.GetPrim().GetName()}: baked"] if str(prim.GetPath()) in baked else []
    notes += [filled] if filled else []
    notes += [f"not read of this file: {', '.join(unread[:8])}"] if unread else []
    matrix = np.array(mesh.ComputeLocalToWorldTransform(codes[0]))[:3, :3]
    mirrored = bool(np.linalg.det(matrix) < 0)
    notes += ["its transform mirrors it: the faces are turned with it"] if mirrored else []
    per_second = stage.GetTimeCodesPerSecond()
    if not 0 < per_second < 1e6:
        raise refusal(path, f"timeCodesPerSecond is {per_second:g}, wanted above 0", _AGAIN)
    counts = _constant(path, mesh.GetFaceVertexCountsAttr(), codes)
    indices = _constant(path, mesh.GetFaceVertexIndicesAttr(), codes)
    polygons = PolygonFrames(
        path,
        prim.GetName(),
        counts,
        indices,
        len(codes),
        lambda t: _world(mesh, codes[t], mesh.GetPointsAttr().Get(codes[t])),
        _corner_uv(mesh, codes[0], indices),
        (mesh.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded) != mirrored,
        _rest(mesh, codes[0]),
        tuple(notes),
    )
    times = np.array(codes) / per_second if len(codes) > 1 else None
    return from_polygons(
        polygons,
        times,
        unit=UsdGeom.GetStageMetersPerUnit(stage) if UsdGeom.StageHasAuthoredMetersPerUnit(stage) else None,
        up=str(UsdGeom.GetStageUpAxis(stage)).lower() if stage.HasAuthoredMetadata("upAxis") else None,
    )


def _time_codes(mesh: "UsdGeom.Mesh") -> list:
    """Time samples of the points, or of the transforms above them where these have more in the same span; the default
    time where nothing moves.
    """
    from pxr import Usd, UsdGeom

    own, above = sorted(mesh.GetPointsAttr().GetTimeSamples()), set()
    prim = mesh.GetPrim()
    while prim and not prim.IsPseudoRoot():
        above |= set(UsdGeom.Xformable(prim).GetTimeSamples()) if prim.IsA(UsdGeom.Xformable) else set()
        prim = prim.GetParent()
    if len(own) > 1:
        within = {code for code in above if own[0] <= code <= own[-1]}
        return sorted(within | set(own)) if len(within) > len(own) else own
    return sorted(above) or own or [Usd.TimeCode.Default()]


def _is_animated(skeleton: "UsdSkel.Skeleton") -> bool:
    from pxr import UsdSkel

    return bool(UsdSkel.BindingAPI(skeleton.GetPrim()).GetInheritedAnimationSource())


def _filled(codes: list) -> tuple[list, str]:
    """Evenly spaced time codes, and a note. USD interpolates between samples, so exporters leave out those in
    between.
    """
    if len(codes) < 3:
        return codes, ""
    steps = np.diff(codes)
    step = float(steps.min())
    counts = steps / step if step > 0 else steps
    if np.ptp(steps) <= 0.05 * step or np.abs(counts - counts.round()).max() > 0.05 or counts.sum() > 100_000:
        return codes, ""  # even, or so uneven that nothing can be filled in
    every = codes[0] + step * np.arange(round(float(counts.sum())) + 1)
    note = f"samples at {len(codes)} of {len(every)} times: interpolated in between, as USD does"
    return [float(c) for c in every], note


def _world(mesh: "UsdGeom.Mesh", code: "Usd.TimeCode | float", local: "Vt.Vec3fArray | None") -> np.ndarray:
    """World positions, shape (V, 3), of local ones."""
    points = np.zeros((0, 3), np.float32) if local is None else np.array(local, np.float32).reshape(-1, 3)
    matrix = np.array(mesh.ComputeLocalToWorldTransform(code))  # rows are images: x M
    if np.array_equal(matrix, np.eye(4)):
        return points
    return (points.astype(np.float64) @ matrix[:3, :3] + matrix[3, :3]).astype(np.float32)


def _constant(path: Path, attribute: "Usd.Attribute", codes: list) -> np.ndarray:
    values = [np.array(attribute.Get(code) or [], np.int64) for code in (attribute.GetTimeSamples() or codes[:1])]
    for k, value in enumerate(values):
        if not np.array_equal(value, values[0]):
            raise refusal(
                path,
                f"{attribute.GetName()} changes at its sample {k}, wanted one mesh in all frames",
                "export the mesh without remeshing",
            )
    return values[0]


def _corner_uv(mesh: "UsdGeom.Mesh", code: "Usd.TimeCode | float", indices: np.ndarray) -> np.ndarray | None:
    from pxr import Sdf, UsdGeom

    kinds = (Sdf.ValueTypeNames.TexCoord2fArray, Sdf.ValueTypeNames.Float2Array)
    found = {p.GetPrimvarName(): p for p in UsdGeom.PrimvarsAPI(mesh).GetPrimvars() if p.GetTypeName() in kinds}
    named = [found[n] for n in _UV_NAMES if n in found] or list(found.values())
    if not named:
        return None
    values = np.array(named[0].ComputeFlattened(code) or [], np.float32).reshape(-1, 2)
    if named[0].GetInterpolation() in (UsdGeom.Tokens.vertex, UsdGeom.Tokens.varying):
        return values[indices] if len(indices) and indices.min() >= 0 and indices.max() < len(values) else None
    return values if len(values) == len(indices) else None


def _rest(mesh: "UsdGeom.Mesh", code: "Usd.TimeCode | float") -> np.ndarray | None:
    from pxr import UsdGeom

    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("rest")
    return _world(mesh, code, primvar.Get()) if primvar.HasValue() else None


def _define(stage: "Usd.Stage", mesh: MeshSequence) -> None:
    from pxr import Sdf, UsdGeom, Vt

    prim = UsdGeom.Mesh.Define(stage, f"/garmentbench/{mesh.name}")
    prim.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    prim.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(mesh.faces), 3, np.int32)))
    prim.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(mesh.faces.ravel().astype(np.int32)))
    primvars, names = UsdGeom.PrimvarsAPI(prim), Sdf.ValueTypeNames
    primvars.CreatePrimvar("rest", names.Point3fArray, UsdGeom.Tokens.vertex).Set(_vec3(mesh.still))
    if mesh.corner_uv is not None:
        uv = Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(mesh.corner_uv.reshape(-1, 2), np.float32))
        primvars.CreatePrimvar("st", names.TexCoord2fArray, UsdGeom.Tokens.faceVarying).Set(uv)
    points, extent = prim.CreatePointsAttr(), prim.CreateExtentAttr()
    for t, frame in enumerate(mesh.frames, start=1):
        points.Set(_vec3(frame), t)
        extent.Set(_vec3(np.stack([frame.min(axis=0), frame.max(axis=0)])), t)


def _vec3(positions: np.ndarray) -> "Vt.Vec3fArray":
    from pxr import Vt

    return Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(positions, np.float32))
