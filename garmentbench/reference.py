"""The reference sequence of a scene: simulated once, as an ensemble where it is for testing, checked, reused."""

import json
import sys
from dataclasses import dataclass, replace
from pathlib import Path

from garmentbench import sequence_file
from garmentbench.device import has_cuda, quiet_warp
from garmentbench.errors import UserError, unknown_name
from garmentbench.paths import GARMENTS, sequence_path
from garmentbench.scenes.bodies import body_file, body_names
from garmentbench.scenes.garments import garment_names, scene_garment
from garmentbench.scenes.presets import MESH_SIZES, MeshSize, Preset
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.wardrobe import load_scene, scene_file, wardrobe
from garmentbench.sequence import Sequence, Template
from garmentbench.sequence_file.layout import KIND, REMAKE, SCHEMA
from garmentbench.storage import hdf5, lock
from garmentbench.storage.fingerprint import content_hash, fingerprint
from garmentbench.storage.runs import require_work_allowed

_CODE = (
    "garmentbench.simulation.simulate",
    "garmentbench.metrics.interpenetration",
    "garmentbench.metrics.interpenetration_strict",
    "garmentbench.metrics.faces_inside",
    "garmentbench.metrics.self_intersection",
)
IDENTITY = "made_from"  # key of a sequence's info: hash of scene, mesh size, assets and code


@dataclass(frozen=True)
class SequenceFile:
    """A finished sequence, imported or recorded."""

    path: Path

    @property
    def name(self) -> str:
        """What tables call it: the file's name without its ending."""
        return self.path.stem


Source = Scene | SequenceFile


@dataclass(frozen=True)
class Reference:
    """A sequence that is there.

    Attributes:
        name: The scene's name; of a finished file its stem.
        path: The sequence file.
        identity: Hash of all that decides it: of scene, assets and code, or of the finished file's contents.
        reused: It was there already.
    """

    name: str
    path: Path
    identity: str
    reused: bool = False


def resolve_source(name: str) -> Source:
    """The scene of that name, or in that TOML file, or the sequence file (.h5) at that path; cheap.

    Raises `UserError` for an unknown scene, for one that names something unknown, and for a file that is no sequence.
    """
    if name.endswith(".h5"):
        sequence_file.content_hash(Path(name))
        return SequenceFile(Path(name))
    scene = load_scene(name)
    check_scene(scene, scene_file(name))
    return scene


def check_scene(scene: Scene, file: Path | None = None) -> None:
    """Raises `UserError` for a garment, body or motion that does not exist, or whose file is not as it must be.

    `file` is the scene's, which messages about names then begin with.
    """
    from garmentbench.motion import STICK, human_motions, stick_motions
    from garmentbench.motion.clip import read_clip
    from garmentbench.scenes.bodies import load_body

    where = "" if file is None else f"{file}: "
    if scene.mesh is not None:
        scene_garment(scene, MESH_SIZES["smoke"])
    elif scene.garment not in garment_names():
        raise unknown_name("garment", scene.garment, [*garment_names(), *wardrobe().garments], where)
    if scene.body not in (STICK, *body_names()):
        raise unknown_name("body", scene.body, [STICK, *body_names()], where)
    motions = stick_motions() if scene.body == STICK else human_motions()
    if scene.motion.file is not None:
        read_clip(Path(scene.motion.file), load_body(scene.body, "small"))
    elif scene.motion.name not in motions:
        raise unknown_name("motion", scene.motion.name, motions, where)


def runs_wanted(scene: Scene) -> int:
    """How many runs the reference of a scene has, if nothing else is asked for: what is tested on is an ensemble."""
    from garmentbench.simulation.ensemble import RUNS

    return RUNS if scene.split == "test" else 1


def make_reference(source: Source, preset: Preset, runs: int | None = None) -> Reference:
    """The reference of a scene, which is simulated unless it is there, made from the same by the same code; or a
    finished file as it is. Two processes that want the same make it once.

    Args:
        source: The scene, or the file.
        preset: Sizes of garment and body.
        runs: How many runs of a scene there must be at least; None: as many as `runs_wanted` says. One that has fewer
            is made anew.

    Raises `UserError` for a wrong scene, or when the file can't be read or written.
    """
    if isinstance(source, SequenceFile):
        return Reference(source.name, source.path, sequence_file.content_hash(source.path), reused=True)
    path = sequence_path(preset.mesh.name, source.name)
    identity = reference_identity(source, preset)
    with lock.take(path.with_suffix(".lock")):
        runs = runs_wanted(source) if runs is None else runs
        reused = _is_made_from(path, identity, runs)
        if not reused:
            require_work_allowed(source.name)
            sequence = _simulated(source, preset, runs)
            sequence_file.save(replace(sequence, info={**sequence.info, IDENTITY: identity}), path)
    return Reference(source.name, path, identity, reused)


def stored(scene: Scene, preset: Preset) -> bool:
    """Is a scene's reference there, made from the same by the same code, with as many runs as it is to have?"""
    path = sequence_path(preset.mesh.name, scene.name)
    return path.is_file() and _is_made_from(path, reference_identity(scene, preset), runs_wanted(scene))


def reference_identity(scene: Scene, preset: Preset) -> str:
    """Hash of all that decides a reference: the scene, those beneath it, their assets, the mesh size and the code."""
    beneath = None if scene.worn_over is None else reference_identity(scene.worn_over, preset)
    code = fingerprint(*_CODE, *_assets(scene, preset.mesh))
    mesh = None if scene.mesh is None else replace(scene.mesh, file="")  # where files lie does not matter
    scene = replace(scene, worn_over=None, motion=replace(scene.motion, file=None), mesh=mesh)
    return content_hash({"scene": scene, "beneath": beneath, "mesh": preset.mesh, "code": code})


def _assets(scene: Scene, mesh: MeshSize) -> list[Path]:
    """The files that a scene is made from.

    Its garment, its body, the body shape that the warm-up begins in, its clip.
    """
    from garmentbench.motion.human import DRESSED
    from garmentbench.motion.stick import STICK

    shapes = () if scene.body == STICK else sorted({scene.body, DRESSED})
    bodies = (body_file(shape, mesh.body_size) for shape in shapes if shape in body_names())
    garment = GARMENTS / f"{scene.garment}-{mesh.name}.npz" if scene.mesh is None else Path(scene.mesh.file)
    clip = [] if scene.motion.file is None else [Path(scene.motion.file)]
    return [p for p in (garment, *bodies, *clip) if p.is_file()]


def scene_template(scene: Scene, mesh: MeshSize) -> Template:
    """What does not move in a scene, without simulating it. Raises `UsageError` for an unknown garment or body."""
    from garmentbench.motion.stick import STICK, stick
    from garmentbench.scenes.bodies import load_body
    from garmentbench.scenes.inner_garment import as_body

    if scene.worn_over is not None:
        body = as_body(scene_garment(scene.worn_over, mesh))
    else:
        body = stick() if scene.body == STICK else load_body(scene.body, mesh.body_size).body
    return Template(scene_garment(scene, mesh), body, scene.fps)


def _is_made_from(path: Path, identity: str, runs: int) -> bool:
    """Is the file there, whole, made from that, and has it as many runs?"""
    if not path.is_file():
        return False
    try:
        with hdf5.opened(path, KIND, SCHEMA, REMAKE) as file:
            info = json.loads(hdf5.attribute(file, "info", str) or "{}")
    except UserError as e:
        print(f"{e}: made again now", file=sys.stderr)
        return False
    return info.get(IDENTITY) == identity and 1 + len(info.get("runs", ())) >= runs


def _simulated(scene: Scene, preset: Preset, runs: int) -> Sequence:
    """The reference with its own scores in its info."""
    from garmentbench.simulation.simulate import simulate

    quiet_warp()
    device = "cuda:0" if has_cuda() else "cpu"
    sequence = simulate(scene, preset, device, runs)
    return replace(sequence, info=sequence.info | {"scores": reference_scores(sequence)})


def reference_scores(sequence: Sequence) -> dict[str, float]:
    """A reference's own scores that are kept with it, under the metrics' names: those that take long to measure."""
    from garmentbench.metrics.faces_inside import FACES_INSIDE, SKIN_FRAMES
    from garmentbench.metrics.interpenetration_strict import PENETRATION
    from garmentbench.metrics.metric import Motion, scores
    from garmentbench.metrics.self_intersection import CROSSING_FACES_MAX, SELF_INTERSECTION

    return scores(Motion.of(sequence), *PENETRATION, FACES_INSIDE, SKIN_FRAMES, SELF_INTERSECTION, CROSSING_FACES_MAX)
