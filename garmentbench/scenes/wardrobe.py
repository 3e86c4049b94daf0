"""The scenes there are: every garment of the wardrobe in every motion on every body, and those that are files."""

from dataclasses import asdict, dataclass, field, replace
from functools import cache
from pathlib import Path

from garmentbench.errors import UserError, unknown_name
from garmentbench.paths import SCENES, WARDROBE
from garmentbench.scenes.material import Material, Settings
from garmentbench.scenes.scene import BASE, Frames, Motion, Scene, Split
from garmentbench.storage.typed_toml import read_toml, typed


@dataclass(frozen=True)
class MotionEntry:
    """A motion of the grid: its split, and how many frames its scenes have."""

    split: Split
    frames: Frames


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
    """

    material: Material = Material()
    simulation: Settings = Settings()
    worn_over: str | None = None
    frames: dict[str, Frames] = field(default_factory=dict)


@dataclass(frozen=True)
class Wardrobe:
    """Garments, bodies and motions, of which every combination is a scene."""

    motions: dict[str, MotionEntry] = field(default_factory=dict)
    bodies: dict[str, BodyEntry] = field(default_factory=dict)
    garments: dict[str, GarmentEntry] = field(default_factory=dict)

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
        frames = lengths.get(motion, plan.frames)
        return self.wearing(
            Scene(scene_name(garment, motion, body), garment, body, Motion(motion), wearer.split or plan.split, frames,
                  material=wears.material, simulation=wears.simulation)
        )  # fmt: skip

    def wearing(self, scene: Scene) -> Scene:
        """The scene with its garment over what the wardrobe says that it is worn over."""
        beneath = self.entry(scene.garment).worn_over
        if beneath is None:
            return scene
        wears = self.entry(beneath)
        name = scene_name(beneath, scene.motion.name, scene.body)
        inner = replace(scene, name=name, garment=beneath, material=wears.material, simulation=wears.simulation)
        return replace(scene, worn_over=inner)

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
    path = Path(name) if name.endswith(".toml") else _files().get(name)
    if path is not None and path.is_file():
        return _from_file(path, outer)
    combined = wardrobe().scenes()
    if name not in combined:
        raise unknown_name("scene", name, scene_names())
    return wardrobe().scene(*combined[name])


@cache
def wardrobe() -> Wardrobe:
    """The suite's garments, bodies and motions."""
    return read_wardrobe(WARDROBE)


def read_wardrobe(path: Path) -> Wardrobe:
    """A wardrobe's file. Raises `UserError` naming what is wrong and where."""
    return typed(read_toml(path), Wardrobe, path)


def _files() -> dict[str, Path]:
    """Files of scenes by name."""
    return {path.stem: path for path in SCENES.glob("*.toml")}


def _from_file(path: Path, outer: str) -> Scene:
    table = read_toml(path)
    over = table.pop("worn_over", None)
    if not isinstance(over, str | None):
        raise UserError(f"{path}: worn_over is {over!r}; wanted the name of a scene")
    if outer and over:
        raise UserError(f"scene {outer} is worn over {path.stem}, itself worn over {over}; wanted two layers")
    if isinstance(table.get("motion"), str):
        table["motion"] = {"name": table["motion"]}
    if isinstance(table.get("garment"), str):
        entry = wardrobe().entry(table["garment"])
        for key in ("material", "simulation"):
            changes = table.get(key, {})
            table[key] = asdict(getattr(entry, key)) | changes if isinstance(changes, dict) else changes
    scene = typed({**table, "name": path.stem}, Scene, path)
    scene = replace(scene, motion=_with_clip(scene.motion, path))
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
