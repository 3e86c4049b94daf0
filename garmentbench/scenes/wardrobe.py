"""The scenes there are: every garment of the wardrobe in every motion on every body, and those that are files.

The user's own lie in the home folder: garments, bodies and motions in wardrobe.toml, scenes in scenes/*.toml.
"""

import json
import re
from dataclasses import asdict, dataclass, field, fields, replace
from functools import cache
from pathlib import Path

from garmentbench import paths
from garmentbench.errors import UserError, unknown_name
from garmentbench.scenes.bodies import body_names
from garmentbench.scenes.fabrics import resolved
from garmentbench.scenes.garments import garment_names
from garmentbench.scenes.material import Count, Material, Settings
from garmentbench.scenes.scene import BASE, FPS, Frames, MeshFile, Motion, Scene, Split
from garmentbench.storage.atomic import write_text
from garmentbench.storage.typed_toml import read_toml, typed


@dataclass(frozen=True)
class MotionEntry:
    """A motion of the grid, or a part of one.

    Attributes:
        split: Of its scenes.
        frames: How many frames its scenes have.
        motion: The motion that this is a part of; None for the one of the entry's name.
        start: The frame of that motion with which the part begins.
        kind: What kind of motion it is: a method that was trained on one of a kind has seen the kind. None for the
            motion's name.
    """

    split: Split
    frames: Frames
    motion: str | None = None
    start: Count = 0
    kind: str | None = None


@dataclass(frozen=True)
class BodyEntry:
    """A body of the grid beside the base body.

    Attributes:
        split: The split of all its scenes; None for the motions'.
        without: Motions that it is not in.
        frames: Frames of its scenes by motion, where these are not the motion's.
    """

    split: Split | None = None
    without: tuple[str, ...] = ()
    frames: dict[str, Frames] = field(default_factory=dict)


@dataclass(frozen=True)
class GarmentEntry:
    """A garment.

    Attributes:
        material: What it is made of.
        simulation: The solver's settings for it.
        worn_over: The garment beneath; None for the skin.
        frames: Frames of its scenes on the base body by motion, where these are not the motion's.
        mesh: Its file where it is none of the baked garments; the file's name alone will do.
    """

    material: Material = Material()
    simulation: Settings = Settings()
    worn_over: str | None = None
    frames: dict[str, Frames] = field(default_factory=dict)
    mesh: MeshFile | None = None

    def worn(self, scene: Scene) -> Scene:
        """A scene with this garment's mesh, material and settings."""
        return replace(scene, material=self.material, simulation=self.simulation, mesh=self.mesh)


@dataclass(frozen=True)
class TrainingSet:
    """Scenes that methods are trained on together: some motions on some bodies.

    Attributes:
        frames: How many frames of each motion, from the first on.
        bodies: On which bodies.
    """

    frames: dict[str, Frames]
    bodies: tuple[str, ...] = (BASE,)


@dataclass(frozen=True)
class Wardrobe:
    """Garments, bodies and motions, of which every combination is a scene, and named sets of them."""

    motions: dict[str, MotionEntry] = field(default_factory=dict)
    bodies: dict[str, BodyEntry] = field(default_factory=dict)
    garments: dict[str, GarmentEntry] = field(default_factory=dict)
    training_sets: dict[str, TrainingSet] = field(default_factory=dict)

    def scenes(self) -> dict[str, tuple[str, str, str]]:
        """Garment, motion and body of every scene, by its name."""
        combined = {}
        for body, entry in {BASE: BodyEntry(), **self.bodies}.items():
            for garment in self.garments:
                for motion in self.motions:
                    if motion not in entry.without:
                        combined[scene_name(garment, motion, body)] = (garment, motion, body)
        return combined

    def scene(self, garment: str, motion: str, body: str) -> Scene:
        """One of them."""
        plan, wearer, wears = self.motions[motion], self.bodies.get(body, BodyEntry()), self.garments[garment]
        lengths = wears.frames if body == BASE else wearer.frames
        frames, split = lengths.get(motion, plan.frames), wearer.split or plan.split
        moves = Motion(plan.motion or motion, start=plan.start / FPS)
        scene = Scene(scene_name(garment, motion, body), garment, body, moves, split, frames, FPS)
        return self.wearing(wears.worn(scene), motion)

    def wearing(self, scene: Scene, motion: str | None = None) -> Scene:
        """The scene with its garment over what the wardrobe says that it is worn over. motion: The grid's, if another
        than the scene's motion is called."""
        beneath = self.entry(scene.garment).worn_over
        if beneath is None:
            return scene
        name = scene_name(beneath, motion or scene.motion.name, scene.body)
        return replace(scene, worn_over=self.entry(beneath).worn(replace(scene, name=name, garment=beneath)))

    def entry(self, garment: str) -> GarmentEntry:
        """What the wardrobe says of a garment, which need not be in it."""
        return self.garments.get(garment, GarmentEntry())


def scene_name(garment: str, motion: str, body: str) -> str:
    """The name of a scene of the grid."""
    return "-".join((garment, motion) if body == BASE else (garment, motion, body))


def scene_names() -> list[str]:
    """Names of all scenes."""
    return sorted({*_files(), *wardrobe().scenes()})


def load_scene(name: str) -> Scene:
    """The scene of that name, or in a TOML file at that path. Raises `UserError` naming what is wrong and where."""
    return _load(name)


def _load(name: str, outer: str = "") -> Scene:
    """A scene. `outer`: the one that is worn over it, so that none is worn over itself."""
    path = scene_file(name)
    if path is not None and path.is_file():
        return _from_file(path, outer)
    combined = wardrobe().scenes()
    if name not in combined:
        raise unknown_name("scene", name, scene_names())
    return wardrobe().scene(*combined[name])


def wardrobe() -> Wardrobe:
    """The suite's garments, bodies and motions, and the user's own. Raises `UserError` where theirs is wrong."""
    suite, path = _suite(), paths.own_wardrobe()
    if not path.is_file():
        return suite
    own = read_wardrobe(path)
    for table, entries in vars(own).items():
        for name in entries:
            if name in getattr(suite, table) or (table == "garments" and name in garment_names()):
                raise UserError(f"{path}: {table}.{name} is the suite's name; call yours something else")
    for name, entry in own.motions.items():
        if (moves := entry.motion or name) not in (known := _motions()):
            raise UserError(f"{path}: motions: {unknown_name('motion', moves, known)}")
    for name in own.bodies:
        if name not in body_names():
            raise UserError(f"{path}: bodies: {unknown_name('body', name, body_names())}")
    whole = Wardrobe(*({**getattr(suite, table), **entries} for table, entries in vars(own).items()))
    for name, entry in own.garments.items():
        if entry.mesh is None:
            raise UserError(f"{path}: garments.{name}.mesh is missing; wanted the garment's file (.npz or .obj)")
        where, beneath = f"{path}: garments.{name}.worn_over", entry.worn_over
        if beneath is not None and beneath not in (known := {*whole.garments, *garment_names()}):
            raise UserError(f"{where}: {unknown_name('garment', beneath, known)}")
        if beneath is not None and (under := whole.entry(beneath).worn_over) is not None:
            raise UserError(f"{where} is '{beneath}', itself worn over '{under}'; wanted one that is worn on the skin")
    return whole


@cache
def _suite() -> Wardrobe:
    return read_wardrobe(paths.WARDROBE)


@cache
def _motions() -> set[str]:
    """The human's motions: every one is in some scene of the suite."""
    tables = [table for table in map(read_toml, paths.SCENES.glob("*.toml")) if table["body"] in body_names()]
    grid = (entry.motion or name for name, entry in _suite().motions.items())
    return {*grid, *(table["motion"] for table in tables if isinstance(table["motion"], str))}


def read_wardrobe(path: Path) -> Wardrobe:
    """A wardrobe's file. Raises `UserError` naming what is wrong and where."""
    table = read_toml(path)
    for name, entry in table["garments"].items() if isinstance(table.get("garments"), dict) else ():
        if not re.fullmatch(r"\w+", name):
            raise UserError(f"{path}: a garment is called '{name}'; wanted letters, digits and _")
        if isinstance(entry, dict) and "material" in entry:
            entry["material"] = resolved(entry["material"], f"{path}: garments.{name}.")
    read = typed(table, Wardrobe, path)
    garments = {name: replace(entry, mesh=_beside(path, entry.mesh)) for name, entry in read.garments.items()}
    return replace(read, garments=garments)


def scene_file(name: str) -> Path | None:
    """The file that a scene is read from, by its name or that file's path; None for one of the grid."""
    return Path(name) if name.endswith(".toml") else _files().get(name)


def save_scene(scene: Scene) -> Path:
    """Write a scene as a file of the user's own, which `load_scene` then finds by its name.

    Raises `UserError` where there is another scene of that name.
    """
    path = paths.own_scenes() / f"{scene.name}.toml"
    if scene.name in scene_names():
        if load_scene(scene.name) != scene:
            where = f"{path}: has been written before and differs" if path.is_file() else "the suite has it already"
            raise UserError(f"scene {scene.name}: {where}; simulate it by its name, or choose another name")
        return path
    lines = [f"{key} = {json.dumps(getattr(scene, key))}" for key in ("garment", "body", "split", "frames")]
    for key, value in (("motion", scene.motion), ("mesh", scene.mesh)):
        if value is not None:
            given = {f.name: getattr(value, f.name) for f in fields(value) if getattr(value, f.name) != f.default}
            lines.append(f"{key} = {{{', '.join(f'{k} = {json.dumps(v)}' for k, v in given.items())}}}")
    write_text(path, "\n".join(lines) + "\n")
    return path


def _beside(path: Path, mesh: MeshFile | None) -> MeshFile | None:
    """A mesh whose file is named relative to the file at `path`."""
    return None if mesh is None else replace(mesh, file=str(path.parent / mesh.file))


def _files() -> dict[str, Path]:
    """Files of scenes by name, the suite's and the user's. Raises `UserError` where both have a name."""
    suite, own = ({path.stem: path for path in folder.glob("*.toml")} for folder in (paths.SCENES, paths.own_scenes()))
    for name, path in own.items():
        if name in suite or name in _suite().scenes():
            raise UserError(f"{path}: '{name}' is a scene of the suite; rename the file")
    return suite | own


def _from_file(path: Path, outer: str) -> Scene:
    table = read_toml(path)
    over = table.pop("worn_over", None)
    if not isinstance(over, str | None):
        raise UserError(f"{path}: worn_over is {over!r}; wanted the name of a scene")
    if outer and over:
        raise UserError(f"scene {outer} is worn over {path.stem}, itself worn over {over}; wanted two layers")
    motion = table.get("motion")
    if isinstance(motion, dict) and "file" in motion and "name" not in motion:
        raise UserError(f'{path}: motion: name is missing; with a file it is name = "clip"')
    if isinstance(table.get("garment"), str):
        entry = wardrobe().entry(table["garment"])
        for key in ("material", "simulation"):
            changes = resolved(table.get(key, {}), f"{path}: ") if key == "material" else table.get(key, {})
            table[key] = asdict(getattr(entry, key)) | changes if isinstance(changes, dict) else changes
    scene = typed({**table, "name": path.stem}, Scene, path)
    mesh = _beside(path, scene.mesh) or wardrobe().entry(scene.garment).mesh
    scene = replace(scene, motion=_with_clip(scene.motion, path), mesh=mesh)
    if over is None:
        return wardrobe().wearing(scene)
    inner = _load(str(path.parent / over) if over.endswith(".toml") else over, scene.name)
    _check_layers(scene, inner)
    return replace(scene, worn_over=inner)


def _with_clip(motion: Motion, path: Path) -> Motion:
    """The motion, its recording's file relative to where the scene's is. Raises `UserError`."""
    if (motion.file is not None) != (motion.name == "clip"):
        raise UserError(f'{path}: motion "clip" and its file go together; wanted [motion] with name = "clip" and file')
    return motion if motion.file is None else replace(motion, file=str(path.parent / motion.file))


def _check_layers(outer: Scene, inner: Scene) -> None:
    """Raises `UserError` unless two scenes are of one body in one motion, long enough to wear one over the other."""
    where = f"scene {outer.name} is worn over {inner.name}"
    if inner.worn_over is not None:
        raise UserError(f"{where}, itself worn over {inner.worn_over.name}; wanted two layers")
    for part in ("body", "motion", "fps"):
        mine, its = getattr(outer, part), getattr(inner, part)
        if mine != its:
            raise UserError(f"{where}: {part} is {mine}, that of {inner.name} {its}; make them the same")
    if inner.frames < outer.frames:
        raise UserError(f"{where}: {outer.frames} frames over {inner.frames}; wanted at least as many beneath")
