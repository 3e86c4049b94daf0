"""Making sequences: simulate a scene, measure how far its reference can be relied on, store both; or keep what is there."""

import json
import sys
from dataclasses import dataclass, replace
from pathlib import Path

from garmentbench import sequence_file
from garmentbench.device import has_cuda, quiet_warp
from garmentbench.errors import UserError
from garmentbench.paths import GARMENTS, sequence_path
from garmentbench.scenes.bodies import body_file, body_names
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import Scene, inner_scene, load_scene
from garmentbench.sequence import Needs, Sequence, Template
from garmentbench.sequence_file.layout import KIND, REMAKE, SCHEMA
from garmentbench.storage import hdf5, lock
from garmentbench.storage.fingerprint import content_hash, fingerprint

_CODE = (
    "garmentbench.simulation.simulate",
    "garmentbench.metrics.interpenetration",
    "garmentbench.metrics.interpenetration_strict",
    "garmentbench.metrics.self_intersection",
)
IDENTITY = "made_from"  # key of a sequence's info: hash of scene, preset, assets and code


def make_sequence(scene_name: str, preset: Preset) -> Path:
    """The path of a scene's reference sequence, which is simulated unless it is there, made from the same by the same
    code. Two processes that want the same make it once.

    Raises `UserError` for a wrong scene, or when the file can't be written.
    """
    scene = load_scene(scene_name)
    path = sequence_path(preset.name, scene.name)
    identity = sequence_identity(scene, preset)
    with lock.take(path.with_suffix(".lock")):
        if not _is_made_from(path, identity):
            sequence = _simulated(scene, preset)
            sequence_file.save(replace(sequence, info={**sequence.info, IDENTITY: identity}), path)
    return path


def sequence_identity(scene: Scene, preset: Preset) -> str:
    """Hash of all that decides a reference sequence: the scene, those beneath it, their assets and the code."""
    inner = inner_scene(scene)
    code = fingerprint(*_CODE, *_assets(scene, preset))
    beneath = None if inner is None else sequence_identity(inner, preset)
    scene = replace(scene, worn_over=None, motion=replace(scene.motion, file=None))  # where files lie does not matter
    return content_hash({"scene": scene, "beneath": beneath, "preset": preset, "code": code})


def _assets(scene: Scene, preset: Preset) -> list[Path]:
    """The files that a scene is made from: its garment, its body, the body shape that the warm-up begins in, its clip."""
    from garmentbench.motion.human import DRESSED
    from garmentbench.motion.stick import STICK

    shapes = () if scene.body == STICK else sorted({scene.body, DRESSED})
    bodies = (body_file(shape, preset.body_size) for shape in shapes if shape in body_names())
    clip = [] if scene.motion.file is None else [Path(scene.motion.file)]
    return [p for p in (GARMENTS / f"{scene.garment}-{preset.name}.npz", *bodies, *clip) if p.is_file()]


def scene_template(scene: Scene, preset: Preset) -> Template:
    """What does not move in a scene, without simulating it. Raises `UsageError` for an unknown garment or body."""
    from garmentbench.motion.stick import STICK, stick
    from garmentbench.scenes.bodies import load_body
    from garmentbench.scenes.garments import load_garment
    from garmentbench.scenes.inner_garment import as_body

    inner = inner_scene(scene)
    if inner is not None:
        body = as_body(load_garment(inner.garment, preset.name))
    else:
        body = stick() if scene.body == STICK else load_body(scene.body, preset.body_size).body
    return Template(load_garment(scene.garment, preset.name), body, scene.fps)


def scene_needs(scene: Scene, preset: Preset) -> Needs:
    """What a scene needs. Raises as `scene_template`."""
    return scene_template(scene, preset).needs


def _is_made_from(path: Path, identity: str) -> bool:
    """Is the file there, whole, and made from that?"""
    if not path.is_file():
        return False
    try:
        with hdf5.opened(path, KIND, SCHEMA, REMAKE) as file:
            info = json.loads(hdf5.attribute(file, "info", str) or "{}")
    except UserError as e:
        print(f"{e}: made again now", file=sys.stderr)
        return False
    return info.get(IDENTITY) == identity


def _simulated(scene: Scene, preset: Preset) -> Sequence:
    """The reference with its uncertainty and its own scores in its info."""
    from garmentbench.simulation.simulate import measure_uncertainty, simulate

    quiet_warp()
    device = "cuda:0" if has_cuda() else "cpu"
    sequence = simulate(scene, preset, device)
    uncertainty = measure_uncertainty(scene, preset, sequence, device=device)
    return replace(sequence, info=sequence.info | {"uncertainty": uncertainty, "scores": reference_scores(sequence)})


def reference_scores(sequence: Sequence) -> dict[str, float]:
    """A reference's own scores that are kept with it, under the metrics' names: those that take long to measure."""
    from garmentbench.metrics.interpenetration_strict import PENETRATION
    from garmentbench.metrics.metric import Motion, scores
    from garmentbench.metrics.self_intersection import CROSSING_FACES_MAX, SELF_INTERSECTION

    return scores(Motion.of(sequence), *PENETRATION, SELF_INTERSECTION, CROSSING_FACES_MAX)


@dataclass(frozen=True)
class Source:
    """A sequence that is there.

    Attributes:
        name: The scene's name; of a finished file its stem.
        path: The sequence file.
        identity: Hash of all that decides it: of scene, assets and code, or of the finished file's contents.
    """

    name: str
    path: Path
    identity: str


def is_file(name: str) -> bool:
    """Does it name a sequence file rather than a scene?"""
    return name.endswith(".h5")


def check_source(name: str) -> None:
    """Raises `UserError` for an unknown scene, or a file that is no sequence; cheap."""
    if is_file(name):
        sequence_file.content_hash(Path(name))
    else:
        load_scene(name)


def take_source(name: str, preset: Preset) -> Source:
    """The sequence of that name, simulated first where it is a scene's and not there. Raises as `make_sequence`."""
    if is_file(name):
        path = Path(name)
        return Source(path.stem, path, sequence_file.content_hash(path))
    scene = load_scene(name)
    return Source(scene.name, make_sequence(name, preset), sequence_identity(scene, preset))
