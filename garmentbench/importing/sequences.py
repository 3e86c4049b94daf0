"""Import: mesh sequences of a garment and a body become a `Sequence`, with notes on everything that was assumed."""

import hashlib
from dataclasses import dataclass, replace
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import Any

import numpy as np

from garmentbench import sequence_file
from garmentbench.errors import UsageError, UserError
from garmentbench.importing.mesh_doctor.bringing_on import unit_question
from garmentbench.importing.mesh_doctor.orientation import faces_inward
from garmentbench.importing.meshes.conventions import Conventions, Given, find_conventions, unit_name
from garmentbench.importing.meshes.frame_check import check_frames, check_rest
from garmentbench.importing.meshes.mesh_sequence import MeshSequence, refusal, without_spare
from garmentbench.importing.meshes.pairing import moves_alike, paired
from garmentbench.importing.meshes.placing import outward, placed_frames, placed_rest
from garmentbench.importing.meshes.reading import HDF5, Place, read_both
from garmentbench.importing.meshes.uv_map import seam_pairs, vertex_uv
from garmentbench.importing.text import counted
from garmentbench.importing.wearing import worn
from garmentbench.reference import IDENTITY
from garmentbench.sequence import GARMENT, HUMAN, Body, Garment, Sequence, Template
from garmentbench.sequence_file.array_checks import LARGEST, SMALLEST

_HIGHEST, _LOWEST = 3.0, 0.5  # of a human body [m], by the units that a file states
_APART = 0.3  # [m] between the bounding boxes of garment and body in frame 0


@dataclass(frozen=True)
class Wanted:
    """How a recording is to be imported.

    Attributes:
        scene: What it is called in tables.
        given: Units, up axis and frame rate, as far as the user says them.
        split: "train" or "test".
        garment, body: Names; by default the meshes' own.
        kind: The body is a "human", an "object", or the "garment" beneath.
        frames: How many frames, from the first on; None for all.
        same_start: Garment and body begin at the same moment, whatever their times say.
        other_template: Templates are meant to differ from the frames, as a flat pattern does.
        make_uv: Make a new UV map with xatlas.
    """

    scene: str
    given: Given = Given()
    split: str = "train"
    garment: str = ""
    body: str = ""
    kind: str = HUMAN
    frames: int | None = None
    make_uv: bool = False
    same_start: bool = False
    other_template: bool = False


def import_files(garment: Place, body: Place, wanted: Wanted, out: Path) -> list[str]:
    """Read files, write the sequence, and return notes for the user. An empty body file's name means no body.

    A sequence file of our own is taken as it is: only its frames, split and names change. Raises `UserError` as
    `read_meshes`, `import_meshes` and `sequence_file.save`.
    """
    own = _own_sequence(garment[0])
    if own is not None:
        sequence, notes = _renamed(own, body, wanted)
    else:
        sequence, notes = import_meshes(*read_both(garment, body), wanted)
    if sequence.template.needs.interpenetration and "interpenetration" not in sequence.scores:
        sequence, lines = worn(sequence)
        notes += lines
    sequence_file.save(sequence, out)
    return notes


def _own_sequence(source: str) -> Sequence | None:
    """The sequence of a sequence file; None for what is none."""
    path = Path(source)
    if path.suffix.lower() not in HDF5 or not path.is_file() or path.stat().st_size == 0:
        return None
    with path.open("rb") as file, mmap(file.fileno(), 0, access=ACCESS_READ) as content:
        ours = content.find(b"garmentbench sequence") >= 0  # HDF5 of unknown origin is not opened in this process
    return sequence_file.load(path) if ours else None


def _renamed(sequence: Sequence, body: Place, wanted: Wanted) -> tuple[Sequence, list[str]]:
    template, given = sequence.template, wanted.given
    if body[0] or wanted.make_uv or given != Given():
        raise UsageError(
            "import: a garmentbench sequence says all of itself; only --frames, --split and names go with it"
        )
    count = _asked(wanted.frames, len(sequence))
    garment = replace(template.garment, name=wanted.garment or template.garment.name)
    worn = None if template.body is None else replace(template.body, name=wanted.body or template.body.name)
    info = sequence.info | {"scene": wanted.scene, "split": wanted.split}
    info.pop(IDENTITY, None)  # it is no longer what a scene was simulated into
    renamed = replace(sequence.frames(0, count), template=replace(template, garment=garment, body=worn), info=info)
    return renamed, [
        f"a garmentbench sequence, taken as it is: {count} frames, {template.fps:g} a second, metres, z up"
    ]


def import_meshes(garment: MeshSequence, body: MeshSequence | None, wanted: Wanted) -> tuple[Sequence, list[str]]:
    """The sequence, and notes on what was assumed and done (units, axes, rate, UV, cuts).

    Raises `UserError`, one line with advice, for what is unclear, doesn't fit together, or is not finite.
    """
    garment, body = without_spare(garment), None if body is None else without_spare(body)
    odd: list[str] = []
    skin = wanted.kind == HUMAN
    if not wanted.other_template:
        odd = check_rest(garment) + ([] if body is None else check_rest(body, skin))
    if body is not None and garment.frames.shape == body.frames.shape and _same(garment.still, body.still):
        do = "name the garment's file, or which of the meshes it is (--mesh, --body-mesh)"
        raise refusal(garment.where, "garment and body are the same mesh, wanted one worn by the other", do)
    pair = paired(garment, body, wanted.given.fps, wanted.same_start)
    garment, body = pair.garment, pair.body
    found = find_conventions(garment, body, replace(wanted.given, fps=pair.fps), wanted.kind == HUMAN)
    count = _frame_count(garment, body, wanted.frames)
    mesh = vertex_uv(garment, wanted.make_uv)
    notes = [
        *found.assumed,
        *odd,
        *pair.notes,
        *_left_out(garment, body),
        *_reading_notes(garment),
        *(f"garment: {note}" for note in mesh.notes),
    ]
    frames = placed_frames(garment, mesh.origin, found.unit[0], found.up[0], count)
    check_frames(garment, count)
    rest, turned = placed_rest(garment, mesh.origin, found.unit[0], found.up[0], frames[0])
    seams = seam_pairs(mesh.origin, mesh.faces, rest, frames)
    pins = np.flatnonzero(np.isin(mesh.origin, garment.pins)).astype(np.int32)
    cloth = Garment(wanted.garment or garment.name, rest, mesh.faces, mesh.uv, seams, pins)
    notes += [
        f"seams: {counted(len(seams), 'pair')} of vertices at the same point of cloth",
        *([turned] if turned else []),
    ]
    template, moving = None, None
    if body is not None:
        template, moving, lines, flipped = _body(body, found, wanted, count)
        check_frames(body, count, skin)
        cloth, template, hand = _handed(cloth, template, frames, moving, flipped)
        notes += lines + hand + _far(frames[0], moving[0])
    else:
        notes.append("handedness: right-handed axes assumed; there is no body whose faces would tell")
    _refuse_odd_size(garment, frames[0], found.unit[0])
    info: dict[str, Any] = {"scene": wanted.scene, "split": wanted.split, "motion": "imported"}
    info["imported"] = _provenance(garment, body, found, list(notes))
    return Sequence(Template(cloth, template, found.fps), frames, moving, info), notes


def _refuse_odd_size(garment: MeshSequence, first: np.ndarray, unit: float) -> None:
    """Raises `UserError` where a garment's first frame [m] has a size that no garment has."""
    size = float(np.linalg.norm(np.ptp(first, axis=0)))
    if SMALLEST <= size <= LARGEST:
        return
    what = f"the garment measures {size:.3g} m across when its unit is {unit_name(unit)}"
    likely = unit_question(size / unit)
    do = f"give --units{f', for {likely}' if likely else ''}; with --body-units where the body's is another"
    raise refusal(garment.where, f"{what}, wanted {SMALLEST:g} to {LARGEST:g} m", do)


def _body(
    body: MeshSequence, found: Conventions, wanted: Wanted, count: int
) -> tuple[Body, np.ndarray, list[str], bool]:
    """The body, how it moves, notes, and whether its faces pointed inwards."""
    unit, up = found.unit[1], found.up[1]
    moving = placed_frames(body, slice(None), unit, up, count)
    rest, turned = placed_rest(body, slice(None), unit, up, moving[0])
    height = float(np.ptp(rest, axis=0).max())
    if wanted.kind == HUMAN and wanted.given.units is None and not _LOWEST <= height <= _HIGHEST:
        what = (
            f"the body measures {height:.3g} m when its unit is {unit_name(unit)}, wanted {_LOWEST:g} to {_HIGHEST:g} m"
        )
        raise refusal(body.where, what, "give --units, or --kind object if it is no human")
    faces, flipped = (body.faces, False) if wanted.kind == GARMENT else outward(body.faces, rest)
    notes = [
        *_reading_notes(body),
        *([turned] if turned else []),
    ]
    if len(body.frames) == 1 and count > 1:
        notes.append("the body has one frame: it stands still")
    return Body(wanted.body or body.name, rest, faces, kind=wanted.kind), moving, notes, flipped


def _handed(
    cloth: Garment, body: Body, frames: np.ndarray, moving: np.ndarray, flipped: bool
) -> tuple[Garment, Body, list[str]]:
    """Garment and body with their faces outwards, and notes. Where those of both pointed inwards the meshes are taken
    for mirror images, as of left-handed axes or of y and z swapped, and positions are mirrored, in place.

    Args:
        cloth, body: As they were placed, the body's faces turned outwards already.
        frames, moving: Positions of garment and body, shape (T, V, 3).
        flipped: Did the body's faces point inwards?
    """
    inward = faces_inward(replace(cloth, rest=frames[0]), replace(body, rest=moving[0]))
    if flipped and inward:
        for positions in (cloth.rest, body.rest, frames, moving):
            positions[..., 1] *= -1
        cause = "left-handed axes, or y and z swapped"
        note = f"handedness: the faces of both meshes pointed inwards, as of a mirror image ({cause})"
        return cloth, replace(body, faces=body.faces[:, ::-1].copy()), [f"{note}: mirrored"]
    notes = ["faces of the body pointed inwards: turned"] if flipped else []
    if inward:
        cloth = replace(cloth, faces=cloth.faces[:, ::-1].copy())
        notes.append("faces of the garment pointed inwards: turned")
    told = "one mesh's faces point" if notes else "faces point"
    notes.append(
        f"handedness: right-handed axes assumed: {told} outwards, a mirror image with turned faces looks the same"
    )
    return cloth, body, notes


def _frame_count(garment: MeshSequence, body: MeshSequence | None, asked: int | None) -> int:
    """How many frames are taken; a body of one frame stands still."""
    ours, theirs = len(garment.frames), 1 if body is None else len(body.frames)
    count = _asked(asked, ours)
    timed = garment.times is not None or (body is not None and body.times is not None)
    if body is None or theirs in (1, ours) or (asked is not None and asked <= theirs and not timed):
        return count
    together = not timed and moves_alike(garment.frames, body.frames)
    cut = f", or give --frames {min(ours, theirs)} where both begin at the same time" if together else ""
    raise UserError(f"the garment has {ours} frames, the body {theirs}; export the same frames of both{cut}")


def _asked(asked: int | None, there: int) -> int:
    if asked is not None and not 1 <= asked <= there:
        raise UsageError(f"--frames is {asked}; the garment has {there}")
    return asked or there


def _same(one: np.ndarray, other: np.ndarray) -> bool:
    """Are these the same positions, but for what text rounds?"""
    return bool(np.abs(one - other).max() < 1e-5 * np.ptp(one, axis=0).max())


def _left_out(garment: MeshSequence, body: MeshSequence | None) -> list[str]:
    """A line on meshes of the files that are neither garment nor body."""
    if body is None or garment.files[:1] != body.files[:1]:
        lists = [(mesh.files[0], mesh.beside) for mesh in (garment, body) if mesh is not None and mesh.beside]
    else:
        lists = [(garment.files[0], tuple(n for n in garment.beside if n in body.beside))] if garment.files else []
    return [
        f"meshes of {file} that are not read: {', '.join(names[:8])}{' ...' if len(names) > 8 else ''}"
        for file, names in lists
        if names
    ]


def _reading_notes(mesh: MeshSequence) -> list[str]:
    notes = [f"{mesh.name}: {note}" for note in mesh.notes]
    return notes + ([f"{mesh.name}: its first frame is its rest shape"] if mesh.rest is None else [])


def _far(garment: np.ndarray, body: np.ndarray) -> list[str]:
    gap = np.maximum(garment.min(axis=0) - body.max(axis=0), body.min(axis=0) - garment.max(axis=0)).max()
    return [f"warning: the garment is {gap:.2g} m away from the body in frame 0: same origin?"] if gap > _APART else []


def _provenance(garment: MeshSequence, body: MeshSequence | None, found: Conventions, notes: list[str]) -> dict:
    """Plain JSON: what was read (names and SHA-256 only, no folders of this machine), and what was assumed."""
    meshes = {"garment": garment} | ({} if body is None else {"body": body})
    return {
        "files": {
            name: {"first": mesh.files[0].name, "count": len(mesh.files), "sha256": hash_of(mesh.files)}
            for name, mesh in meshes.items()
            if mesh.files
        },
        "units": [unit_name(u) for u in found.unit],
        "up": list(found.up),
        "said": notes,
    }


def hash_of(files: tuple[Path, ...]) -> str:
    """SHA-256 of files' bytes, one after another."""
    digest = hashlib.sha256()
    for file in files:
        with file.open("rb") as f:
            while block := f.read(1 << 20):
                digest.update(block)
    return digest.hexdigest()
