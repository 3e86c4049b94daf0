"""Reading a mesh sequence of any format, found by the name's ending."""

from pathlib import Path

from garmentbench.errors import UsageError
from garmentbench.importing.meshes.arrays import read_npz
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal
from garmentbench.importing.meshes.obj import read_series, read_template, series
from garmentbench.importing.meshes.point_caches import point_count, read_mdd, read_pc2
from garmentbench.progress import track

CACHES = {".pc2": read_pc2, ".mdd": read_mdd}
HDF5 = (".h5", ".hdf5")
SCENES = (".usd", ".usda", ".usdc", ".usdz", ".abc")  # hold several meshes
Place = tuple[str, Path | None, str]  # a file, its template, and which of its meshes, as `read_meshes` takes them
KNOWN = ("a folder or pattern of .obj files", *CACHES, ".npz", *HDF5, *SCENES)


def read_both(garment: Place, body: Place) -> tuple[MeshSequence, MeshSequence | None]:
    """Garment and body. A USD or Alembic file in which one mesh is named as a body gives both by itself.

    Raises `UserError` as `read_meshes`.
    """
    source, _, _ = garment
    cloth = read_meshes(*garment)
    if body[0] or body[2]:
        return cloth, read_meshes(body[0] or source, *body[1:], role="body")
    if Path(source).suffix.lower() in SCENES:
        from garmentbench.importing.meshes.subprocess_reader import read_isolated

        return cloth, read_isolated(Path(source), "", "body if named so")
    return cloth, None


def read_meshes(source: str, template: Path | None = None, prim: str = "", role: str = "garment") -> MeshSequence:
    """A mesh sequence.

    Args:
        source: A file, a folder of OBJ files, or a pattern of such ("out/shirt_*.obj").
        template: OBJ file with faces, UV and rest shape; needed for .pc2 and .mdd.
        prim: Which mesh of a USD or Alembic file, by its path or the end of it; which object of an OBJ file or
            template.
        role: "garment" or "body": which mesh is taken of a file that holds several, where `prim` does not say.

    Raises:
        UserError: One line: what is wrong with which file, and what to do.
    """
    path = Path(source)
    ending = path.suffix.lower()
    if prim and ending not in (*SCENES, *CACHES, ".obj") and not path.is_dir():
        raise UsageError(f"{source}: '{prim}' can't be looked up in it; only USD, Alembic and OBJ hold several meshes")
    if ending in CACHES:
        if template is None:
            do = "give an OBJ file of the same mesh (--template)"
            raise refusal(source, "holds positions only, wanted faces and UV too", do)
        return CACHES[ending](path, read_template(template, prim, role, point_count(path)))
    if ending == ".obj" or path.is_dir():
        files = series(source)
        with track(len(files), f"reading {source}") as step:
            return read_series(files, template, step, prim, role)
    mesh = _read_one(path, ending, prim, role)
    return mesh if template is None else _with_rest(mesh, read_template(template, points=mesh.frames.shape[1]))


def _read_one(path: Path, ending: str, prim: str, role: str) -> MeshSequence:
    if ending == ".npz":
        return read_npz(path)
    if ending in (*HDF5, *SCENES):
        from garmentbench.importing.meshes.subprocess_reader import read_isolated

        found = read_isolated(path, prim, role)
        assert found is not None, "only 'body if named so' may find none"
        return found
    raise UsageError(f"{path}: what is '{ending}'? Read here are {', '.join(KNOWN)}")


def _with_rest(mesh: MeshSequence, template: MeshSequence) -> MeshSequence:
    """The mesh with a template's rest shape, and its UV where it has none itself."""
    if template.faces.shape != mesh.faces.shape or (template.faces != mesh.faces).any():
        raise refusal(template.files[0], f"has other faces than {mesh.files[0].name}", "export both from the same mesh")
    uv = template.corner_uv if mesh.corner_uv is None else mesh.corner_uv
    return MeshSequence(
        **vars(mesh) | {"rest": template.still, "corner_uv": uv, "files": (*mesh.files, *template.files)}
    )
