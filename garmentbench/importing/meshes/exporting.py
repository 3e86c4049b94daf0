"""Export: a sequence, or what a method made of it, as mesh files."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from garmentbench import sequence_file
from garmentbench.errors import UsageError, UserError
from garmentbench.importing.meshes import obj
from garmentbench.importing.meshes.arrays import write_npz
from garmentbench.importing.meshes.mesh_sequence import MeshSequence
from garmentbench.importing.meshes.ply import write_ply
from garmentbench.importing.meshes.point_caches import write_mdd, write_pc2
from garmentbench.paths import sequence_path
from garmentbench.progress import track
from garmentbench.reference import make_reference, resolve_source
from garmentbench.scenes.bodies import BakedBody
from garmentbench.scenes.presets import Preset
from garmentbench.sequence import Sequence

ROUNDING = {
    "obj": 0.5e-6,
    "pc2": 0.0,
    "mdd": 0.0,
    "npz": 0.0,
    "usd": 0.0,
}  # [m] what positions lose, plus float32's own


def select(
    source: str, preset: Preset, recorded: Path | None = None, frames: int | None = None
) -> tuple[Sequence, list[str]]:
    """The sequence to export, and notes for the user.

    Args:
        source: A scene's name, a sequence file (.h5), or the id (or its beginning) of an evaluation's run.
        preset: Size of the scene.
        recorded: The sequence that a run was evaluated on, where that was a file and no scene.
        frames: How many frames, from the first on.

    Raises:
        UserError: There is no such thing, or it is damaged.
    """
    if source.startswith("evaluate"):
        sequence, notes = _rolled_out(source, recorded)
    else:
        sequence, notes = sequence_file.load(make_reference(resolve_source(source), preset).path), []
    if frames is not None and not 1 <= frames <= len(sequence):
        raise UsageError(f"--frames is {frames}; there are {len(sequence)}")
    return sequence.frames(0, frames or len(sequence)), notes


def _rolled_out(name: str, recorded: Path | None) -> tuple[Sequence, list[str]]:
    """The sequence of an evaluation's run with the prediction in place of the reference, as far as that is finite."""
    from garmentbench.evaluation.rollout import RollOut
    from garmentbench.storage.runs import RunStore

    run = RunStore().get(name)
    if run.kind != "evaluate":
        raise UsageError(f"export: {run.id} is no evaluation; `garmentbench runs kind=evaluate` lists those")
    _ = run.results  # says so where it is not finished
    path = recorded or sequence_path(run.identity["preset"].partition("+")[0], run.identity["scene"])
    if not path.is_file():
        raise UserError(f"{run.id}: the sequence that it was evaluated on is not at {path}; name it with --sequence")
    if sequence_file.content_hash(path) != run.identity["data"]:
        raise UserError(f"{run.id}: was evaluated on another sequence than {path}; name the right one with --sequence")
    sequence, roll = sequence_file.load(path), RollOut.load(run.folder / "rollout.h5")
    good = np.asarray(np.isfinite(roll.garment).all(axis=(1, 2)))
    count = len(good) if good.all() else int(np.argmin(good))
    notes = (
        []
        if good.all()
        else [f"the roll-out {roll.status} at frame {count}: {count} frames of {len(good)} are written"]
    )
    return replace(sequence.frames(0, count), garment=roll.garment[:count]), notes


def export_body(baked: BakedBody, path: Path) -> None:
    """Write a body in its rest pose as OBJ or PLY, in metres, z up. Raises `UserError` where it can't be written."""
    body = baked.body
    if path.suffix.lower() == ".obj":
        obj.write_template(path, MeshSequence(body.name, body.rest[None], body.faces, baked.uv[body.faces]))
    elif path.suffix.lower() == ".ply":
        write_ply(path, body.rest, body.faces)
    else:
        raise UsageError(f"bodies export: {path}: wanted a file name that ends in .obj or .ply")


def export(sequence: Sequence, form: str, folder: Path) -> list[Path]:
    """Write a sequence's meshes, in metres, z up; positions are rounded by at most `ROUNDING[form]`.

    Returns:
        The files and folders that can be imported again.

    Raises:
        UserError: They can't be written, or a package is missing.
    """
    meshes = meshes_of(sequence)
    if form == "usd":
        from garmentbench.importing.meshes.usd import write_usd

        path = folder / "sequence.usdc"
        write_usd(path, list(meshes.values()))
        return [path]
    return [_WRITERS[form](folder, name, mesh) for name, mesh in meshes.items()]


def meshes_of(sequence: Sequence) -> dict[str, MeshSequence]:
    """Garment, and body where there is one."""
    cloth, body, fps = sequence.template.garment, sequence.template.body, sequence.template.fps
    meshes = {
        "garment": MeshSequence(
            "garment", sequence.garment, cloth.faces, cloth.uv[cloth.faces], cloth.rest, fps, 1.0, "z", pins=cloth.pins
        )
    }
    if body is not None:
        meshes["body"] = MeshSequence("body", sequence.body_positions, body.faces, None, body.rest, fps, 1.0, "z")
    return meshes


def _obj(folder: Path, name: str, mesh: MeshSequence) -> Path:
    with track(len(mesh.frames), f"writing {folder / name}") as step:
        obj.write_series(folder / name, mesh, step)
    obj.write_template(folder / f"{name}.obj", mesh)
    return folder / name


def _cache(write: Callable[[Path, MeshSequence], None], ending: str) -> Callable[[Path, str, MeshSequence], Path]:
    def write_both(folder: Path, name: str, mesh: MeshSequence) -> Path:
        write(folder / f"{name}.{ending}", mesh)
        obj.write_template(folder / f"{name}.obj", mesh)
        return folder / f"{name}.{ending}"

    return write_both


def _npz(folder: Path, name: str, mesh: MeshSequence) -> Path:
    write_npz(folder / f"{name}.npz", mesh)
    return folder / f"{name}.npz"


_WRITERS: dict[str, Callable[[Path, str, MeshSequence], Path]] = {
    "obj": _obj,
    "pc2": _cache(write_pc2, "pc2"),
    "mdd": _cache(write_mdd, "mdd"),
    "npz": _npz,
}
