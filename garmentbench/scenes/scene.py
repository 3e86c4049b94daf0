"""Scenes: what is worn by whom in which motion, and how the reference is simulated. One TOML file a scene."""

import tomllib
from dataclasses import dataclass, field, fields
from pathlib import Path

from garmentbench.errors import UserError, unknown_name
from garmentbench.paths import SCENES


@dataclass(frozen=True)
class Motion:
    """How the body moves.

    Attributes:
        name: A motion preset, e.g. "armspace-90", "catwalk", or "stick-a" for the stick.
        speed: Played so many times faster (1: as it is).
        freeze_after: The body stands still after so many frames; None: never.
        translate: The whole scene is moved by this [m].
        turn: ... after a turn about the vertical axis [degrees].
        file: Of the motion "clip": the clip's file (.npz, made by `garmentbench import-motion`); in the scene's file
            relative to it.
        start, stop: Only this part of the clip [s]; None: to its end.
        arm_space: The clip's hanging arms turned outward by this [degrees].
    """

    name: str
    speed: float = 1.0
    freeze_after: int | None = None
    translate: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turn: float = 0.0
    file: str | None = None
    start: float = 0.0
    stop: float | None = None
    arm_space: float = 0.0


@dataclass(frozen=True)
class Scene:
    """A scene.

    Attributes:
        name: The file's name.
        garment: A baked garment, e.g. "tshirt" or "sheet".
        body: "base", "slim", "heavy", or "stick" (an object, no human).
        motion: How it moves.
        split: "train" or "test".
        frames: Length [frames], before a preset's limit.
        fps: Frames a second.
        material: Departures from the default material, by the names of `simulation.Material`.
        simulation: Departures from the default solver settings, by the names of `simulation.Settings`;
            also `start_noise` [m], the size of a random push of the garment at the start.
        worn_over: The scene of the garment beneath, which is simulated first and then touched like the body; None where
            the skin is beneath.
    """

    name: str
    garment: str
    body: str
    motion: Motion
    split: str
    frames: int
    fps: float = 30.0
    material: dict[str, float] = field(default_factory=dict)
    simulation: dict[str, float | bool] = field(default_factory=dict)
    worn_over: str | None = None


def scene_names() -> list[str]:
    """Names of all scenes."""
    return sorted(p.stem for p in SCENES.glob("*.toml"))


def load_scene(name: str) -> Scene:
    """Read a scene by its name, or by the path of a TOML file. Raises `UserError` naming what is wrong and where."""
    scene = _read(name)
    if scene.worn_over is not None:
        _check_layers(scene, _read(scene.worn_over))
    return scene


def inner_scene(scene: Scene) -> Scene | None:
    """The scene of the garment that this one is worn over; None where it is worn on the skin."""
    return None if scene.worn_over is None else load_scene(scene.worn_over)


def _check_layers(outer: Scene, inner: Scene) -> None:
    """Raises `UserError` unless two scenes are of one body in one motion, long enough to wear one over the other."""
    where = f"scene {outer.name} is worn over {inner.name}"
    if inner.worn_over is not None:
        raise UserError(f"{where}, itself worn over {inner.worn_over}; wanted two layers, the inner one on the skin")
    for part in ("body", "motion", "fps"):
        mine, its = getattr(outer, part), getattr(inner, part)
        if mine != its:
            raise UserError(f"{where}: {part} is {mine}, that of {inner.name} {its}; make them the same")
    if inner.frames < outer.frames:
        raise UserError(f"{where}: {outer.frames} frames over {inner.frames}; wanted at least as many beneath")


def _read(name: str) -> Scene:
    path = Path(name) if name.endswith(".toml") else SCENES / f"{name}.toml"
    if not path.is_file():
        raise unknown_name("scene", name, scene_names())
    try:
        table = tomllib.loads(path.read_text())
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as e:
        raise UserError(f"{path}: not a TOML file ({e}); see the files beside it for examples") from e
    return _scene(path, table)


def _check_clip(path: Path, motion: dict) -> None:
    """Raises `UserError` for what is wrong in a [motion] table about a recorded clip."""
    if ("file" in motion) != (motion.get("name") == "clip"):
        raise UserError(f'{path}: motion "clip" and its file go together; wanted [motion] with name = "clip" and file')
    number = (int | float, "a number [s]")
    for key, (kind, wanted) in {
        "file": (str, "the path of a clip"),
        "start": number,
        "stop": number,
        "arm_space": (int | float, "degrees"),
    }.items():
        if key in motion and not isinstance(motion[key], kind):
            raise UserError(f"{path}: {key} is {motion[key]!r}; wanted {wanted}")


def _scene(path: Path, table: dict) -> Scene:
    motion = table.pop("motion", None)
    if isinstance(motion, str):
        motion = {"name": motion}
    if not isinstance(motion, dict):
        raise UserError(f'{path}: motion is missing; wanted motion = "armspace-90" or a [motion] table with a name')
    for key, kind, known in [(k, "key", Scene) for k in table] + [(k, "key of [motion]", Motion) for k in motion]:
        names = [f.name for f in fields(known) if f.name not in ("name", "motion")] + (
            ["name"] if known is Motion else []
        )
        if key not in names:
            raise UserError(f"{path}: {unknown_name(kind, key, names)}")
    if not isinstance(table.get("worn_over"), str | None):
        raise UserError(f"{path}: worn_over is {table['worn_over']!r}; wanted the name of a scene")
    if str(table.get("worn_over")).endswith(".toml"):
        table["worn_over"] = str(path.parent / table["worn_over"])
    if "translate" in motion:
        motion["translate"] = tuple(motion["translate"])
    _check_clip(path, motion)
    if "file" in motion:
        motion["file"] = str(path.parent / motion["file"])
    try:
        scene = Scene(name=path.stem, motion=Motion(**motion), **table)
    except TypeError as e:
        missing = str(e).split(": ")[-1]
        raise UserError(f"{path}: missing {missing}; wanted garment, body, motion, split and frames") from e
    if scene.split not in ("train", "test"):
        raise UserError(f'{path}: split is \'{scene.split}\'; wanted "train" or "test"')
    if not isinstance(scene.frames, int) or scene.frames < 4:
        raise UserError(f"{path}: frames is {scene.frames!r}; wanted a whole number of at least 4")
    return scene
