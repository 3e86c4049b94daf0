"""A scene: what is worn by whom in which motion, and how the reference is simulated."""

from dataclasses import dataclass
from typing import Annotated, Literal

from msgspec import Meta

from garmentbench.scenes.material import Material, Settings

BASE = "base"  # the body that garments are made for; a scene's name is silent about it
FPS = 30.0  # frames a second, where a scene says nothing else
Split = Literal["train", "validation", "test"]
Frames = Annotated[int, Meta(ge=4)]


@dataclass(frozen=True)
class Motion:
    """How the body moves.

    Attributes:
        name: A motion preset, e.g. "armspace-90", "catwalk", or "stick-a" for the stick.
        speed: Playback speed (1: as recorded).
        freeze_after: The frame from which the body stands still; None: never.
        translate: The whole scene is moved by this [m].
        turn: ... after a turn about the vertical axis [degrees].
        file: Of the motion "clip": the clip's file (.npz, made by `garmentbench import-motion`); in the scene's file
            relative to it.
        start: Where in the motion frame 0 is [s]; the warm-up then leads into its middle.
        stop: Where the clip ends [s]; None: where its file does.
        arm_space: The clip's hanging arms turned outward by this [degrees].
    """

    name: str
    speed: Annotated[float, Meta(gt=0, le=100)] = 1.0
    freeze_after: Annotated[int, Meta(ge=0)] | None = None
    translate: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turn: float = 0.0
    file: str | None = None
    start: Annotated[float, Meta(ge=0)] = 0.0
    stop: float | None = None
    arm_space: float = 0.0


@dataclass(frozen=True)
class MeshFile:
    """The mesh of a garment of the user's own, in metres, z up, as worn by the base body in its rest pose.

    Attributes:
        file: An .npz file by `garmentbench check --fix`, or an OBJ file; in a TOML file relative to that.
        pins: What the body holds fast, e.g. a waistband: "top 3 cm", the name of a group of faces in an OBJ file, or
            numbers of vertices; None for those that an .npz names.
        seams: "weld" sews borders together where they touch at rest; "file" takes only the file's own seams; pairs of
            vertices are sewn beside these. Cuts of the UV map are sewn always.
    """

    file: str
    pins: str | tuple[int, ...] | None = None
    seams: Literal["weld", "file"] | tuple[tuple[int, int], ...] = "weld"


@dataclass(frozen=True)
class Scene:
    """A scene, resolved: nothing in it has to be looked up but the meshes of garment and body.

    Attributes:
        name: Its name: `<garment>-<motion>`, and `-<body>` where that is not the base body; of a scene file the file's.
        garment: A baked garment, e.g. "tshirt" or "sheet", or what the one of `mesh` is called.
        body: "base", "slim", "heavy", or "stick" (an object, no human).
        motion: How it moves.
        split: "train", "validation" (settings are chosen on it, and it is never reported as a test) or "test".
        frames: Length [frames], before a preset's limit.
        fps: Frames a second.
        material: What the garment is made of.
        simulation: The solver's settings.
        worn_over: The scene of the garment beneath, which is simulated first and then touched like the body; None where
            the skin is beneath.
        mesh: The garment's file where it is none of the baked ones.
    """

    name: str
    garment: str
    body: str
    motion: Motion
    split: Split
    frames: Frames
    fps: Annotated[float, Meta(ge=1, le=1000)] = FPS
    material: Material = Material()
    simulation: Settings = Settings()
    worn_over: "Scene | None" = None
    mesh: MeshFile | None = None
