"""Wavefront OBJ: single meshes (templates) and sequences, one file a frame."""

import glob
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from garmentbench.importing.meshes.choosing import choose_part
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, checked_faces, refusal
from garmentbench.importing.meshes.obj_text import ObjMesh, ObjText
from garmentbench.importing.meshes.polygons import triangulate, what_was_cut
from garmentbench.scenes.roles import are_two_things
from garmentbench.storage.atomic import written_whole

Step = Callable[[], None]


def read_template(path: Path, prim: str = "", role: str = "garment", points: int | None = None) -> MeshSequence:
    """One OBJ file, as a sequence of one frame.

    Args:
        path: The file.
        prim: Which of its objects, where it has several: a name, some with commas between, or "all".
        role: "garment" or "body": what is looked for.
        points: The mesh has so many vertices, which may tell the object; None: not known.

    Raises:
        UserError: One line, for what can't be used, or where it is not clear which object is meant.
    """
    mesh = ObjText(path).mesh()
    kept, notes = _chosen(path, mesh, prim, role, points)
    return _sequence(path.stem, (path,), _part(mesh, kept), notes=notes)


def series(source: str) -> list[Path]:
    """The files of a sequence in natural order: of a folder, a glob pattern, or one file.

    Raises `UserError` where there is none, where they are of several series, and where a frame is missing.
    """
    path = Path(source)
    found = [*path.glob("*.obj"), *path.glob("*.OBJ")] if path.is_dir() else [Path(p) for p in glob.glob(source)]
    files = sorted({p for p in ([path] if path.is_file() else found) if p.is_file()}, key=_natural)
    if not files:
        do = "name their folder, or a pattern such as 'out/shirt_*.obj'"
        raise refusal(source, "no OBJ file there, wanted one a frame", do)
    if len(files) > 1:
        _refuse_mixed(source, files)
    return files


def read_series(
    files: list[Path],
    template: Path | None = None,
    step: Step = lambda: None,
    prim: str = "",
    role: str = "garment",
) -> MeshSequence:
    """A sequence of OBJ files.

    Args:
        files: One a frame, as `series` gives them.
        template: Gives faces, UV and rest positions; by default the first frame does.
        step: Called once a frame.
        prim, role: Which object, as of `read_template`.

    Raises:
        UserError: A file can't be read, or has other vertices or faces than the template.
    """
    mesh = ObjText(template or files[0]).mesh()
    kept, notes = _chosen(template or files[0], mesh, prim, role, None)
    part = _part(mesh, kept)
    vertices = slice(None) if kept is None else np.unique(mesh.corners[np.repeat(kept, mesh.counts)])
    frames = np.empty((len(files), *part.positions.shape), np.float32)
    same_text = None  # of the faces, in files known to have the right ones
    for t, file in enumerate(files):
        text = ObjText(file)
        faces = text.text("f")
        if faces != same_text or text.count("v") != len(mesh.positions):
            _refuse_other(file, text.mesh(), template or files[0], mesh)
            same_text = faces
        frames[t] = text.positions()[vertices]
        step()
    name = files[0].parent.name if len(files) > 1 else files[0].stem
    read = replace(_sequence(name, tuple(files), part, frames, notes), times=_numbers(files), counted=True)
    if template is None:
        return read
    return MeshSequence(**vars(read) | {"rest": part.positions, "files": (*files, template)})


def write_series(folder: Path, mesh: MeshSequence, step: Step = lambda: None) -> list[Path]:
    """One OBJ file a frame, 0001.obj and so on, positions to 6 decimals.

    Raises `UserError` when they can't be written.
    """
    digits = max(4, len(str(len(mesh.frames))))
    paths = [folder / f"{t + 1:0{digits}d}.obj" for t in range(len(mesh.frames))]
    rest_of_it = _uv_and_faces(mesh)
    for path, positions in zip(paths, mesh.frames, strict=True):
        _write(path, positions, rest_of_it)
        step()
    return paths


def write_template(path: Path, mesh: MeshSequence) -> None:
    """The rest shape as one OBJ file. Raises `UserError` when it can't be written."""
    _write(path, mesh.still, _uv_and_faces(mesh))


def _chosen(
    path: Path, mesh: ObjMesh, prim: str, role: str, points: int | None
) -> tuple[np.ndarray | None, tuple[str, ...]]:
    """Which polygons are meant, shape (P,), None for all of them; and notes on what is left out, or taken as one."""
    names, of = mesh.objects, mesh.object_of
    if len(names) < 2 and len(mesh.groups) > 1 and (prim or are_two_things(mesh.groups)):
        names, of = mesh.groups, mesh.group_of
    if len(names) < 2 and not prim:
        several = f"groups taken as one mesh: {_listed(mesh.groups)}"
        return None, (several,) if len(mesh.groups) > 1 else ()
    if prim == "all" or (not prim and points == len(mesh.positions)):
        return None, (f"objects taken as one mesh: {_listed(names)}",) if len(names) > 1 else ()
    fits = [k for k in range(len(names)) if len(np.unique(mesh.corners[np.repeat(of == k, mesh.counts)])) == points]
    if not prim and len(fits) == 1:
        chosen = fits
    else:
        chosen = [names.index(choose_part(path, list(names), word, role)) for word in prim.split(",")]
    left = [name for k, name in enumerate(names) if k not in chosen]
    notes = (f"object '{', '.join(names[k] for k in chosen)}' read, left out: {_listed(left)}",) if left else ()
    return np.isin(of, chosen), notes


def _listed(names: Sequence[str]) -> str:
    return ", ".join(name or "(without a name)" for name in names[:8]) + (" ..." if len(names) > 8 else "")


def _part(mesh: ObjMesh, kept: np.ndarray | None) -> ObjMesh:
    """Only some polygons, and the vertices that they use, in their order."""
    if kept is None or kept.all():
        return mesh
    corner = np.repeat(kept, mesh.counts)
    used, corners = np.unique(mesh.corners[corner], return_inverse=True)
    uv = None if mesh.corner_uv is None else mesh.corner_uv[corner]
    return replace(
        mesh, positions=mesh.positions[used], counts=mesh.counts[kept], corners=corners.ravel(), corner_uv=uv
    )


def _sequence(
    name: str,
    files: tuple[Path, ...],
    mesh: ObjMesh,
    frames: np.ndarray | None = None,
    notes: tuple[str, ...] = (),
) -> MeshSequence:
    try:
        cut = triangulate(mesh.counts, mesh.corners, mesh.positions)
    except ValueError as e:
        raise refusal(files[0], str(e), "cut the mesh into triangles or quads where it was made") from e
    faces = checked_faces(files[0], mesh.corners[cut], len(mesh.positions))
    uv = None if mesh.corner_uv is None else mesh.corner_uv[cut]
    frames = mesh.positions[None] if frames is None else frames
    return MeshSequence(name, frames, faces, uv, notes=(*notes, *what_was_cut(mesh.counts)), files=files)


def _refuse_other(file: Path, found: ObjMesh, first: Path, wanted: ObjMesh) -> None:
    do = "export all frames from the same mesh, without remeshing or modifiers that change it"
    if len(found.positions) != len(wanted.positions):
        raise refusal(file, f"has {len(found.positions)} vertices, {first.name} has {len(wanted.positions)}", do)
    if not np.array_equal(found.counts, wanted.counts) or not np.array_equal(found.corners, wanted.corners):
        raise refusal(file, f"has other faces than {first.name}, wanted one mesh in all frames", do)


def _natural(path: Path) -> list[tuple[int, int, str]]:
    """frame2 before frame10."""
    return [(1, int(w), "") if w.isdecimal() else (0, 0, w) for w in re.split(r"(\d+)", str(path)) if w]


def _refuse_mixed(source: str, files: list[Path]) -> None:
    numbers = _numbers(files)
    if numbers is None:
        names = list(dict.fromkeys(re.sub(r"\d+$", "", p.stem) for p in files))
        what = f"files of different names ({', '.join(names[:3])} ...), wanted one numbered series"
        raise refusal(source, what, f"name one by a pattern, e.g. '{files[0].parent / names[-1]}*.obj'")
    steps = np.diff(numbers)
    gap = np.flatnonzero(steps != np.median(steps))
    if len(gap):
        before, after = files[gap[0]].name, files[gap[0] + 1].name
        raise refusal(
            source, f"{before} is followed by {after}: a frame is missing or too many", "export all frames again"
        )


def _numbers(files: list[Path]) -> np.ndarray | None:
    """The frames' numbers in the files' names, shape (T,): the one by which alone they differ; None of a
    single file, and of names that differ otherwise.
    """
    parts = [re.split(r"(\d+)", p.stem) for p in files]
    if len(files) < 2 or len({len(words) for words in parts}) > 1:
        return None
    differ = [k for k, words in enumerate(zip(*parts, strict=True)) if len(set(words)) > 1]
    return np.array([float(words[differ[0]]) for words in parts]) if len(differ) == 1 and differ[0] % 2 else None


def _uv_and_faces(mesh: MeshSequence) -> bytes:
    """vt and f lines; each corner has a vt of its own where corners of a vertex differ, else each vertex has."""
    faces = mesh.faces.astype(np.int64) + 1
    if mesh.corner_uv is None:
        return _rows(b"f %d %d %d\n", faces)
    flat = mesh.corner_uv.reshape(-1, 2)
    uv = np.zeros((len(mesh.still), 2), np.float32)
    uv[mesh.faces.ravel()] = flat
    named = faces
    if not np.array_equal(uv[mesh.faces.ravel()], flat):
        uv, named = flat, np.arange(1, len(flat) + 1).reshape(-1, 3)
    corners = np.stack([faces, named], axis=-1).reshape(-1, 6)
    return _rows(b"vt %.9g %.9g\n", uv) + _rows(b"f %d/%d %d/%d %d/%d\n", corners)


def _rows(form: bytes, table: np.ndarray) -> bytes:
    return form * len(table) % tuple(table.ravel().tolist())


def _write(path: Path, positions: np.ndarray, uv_and_faces: bytes) -> None:
    with written_whole(path) as partial:
        partial.write_bytes(b"# metres, z up\n" + _rows(b"v %.6f %.6f %.6f\n", positions) + uv_and_faces)
