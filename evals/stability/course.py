"""What is simulated on a rung: the T-shirt's test walk with one thing changed, from one of several starts.

Starts come in pairs. A pair begins at the same moment of the step, pushed two ways by a little at frame 0; pairs begin
a fifth of a step cycle after one another. So starts are trials that differ, and the two of a pair tell whether what
they differ by grows.
"""

import math
from dataclasses import dataclass, replace
from typing import Literal

from garmentbench.motion.timing import WARM_UP
from garmentbench.scenes.fabrics import resolved
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import FPS, Scene
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.simulation.ensemble import Push

UNSTRESSED = "tshirt-armspace-90"
PAIRS = 5  # moments of the step that starts begin at
FIRST = 1.0  # second of the walk at which the first pair begins
CYCLE = 1.09  # seconds of a step cycle
JITTER = 1e-4  # [m] the push of a start where the rung is not itself a push
EVENT = 20  # the frame at which something happens, at 30 a second
Event = Literal["stop", "dropped", "teleport", "pressed", "medley"]
Precision = Literal["float32", "bfloat16", "float64"]


@dataclass(frozen=True, kw_only=True)
class Course:
    """A course.

    Attributes:
        material: Factors by which quantities of the cloth are changed.
        friction: Coulomb's coefficient against the body, or None for the cloth's own.
        fabric: The cloth is this one, or None for the T-shirt's own.
        body: Who wears it.
        beyond: How far along the way from the base body to that one its shape is; above 1 it is beyond it.
        speed: Of the walk.
        freeze: The body comes to rest, in 0.3 s, from `EVENT` on.
        event: What else happens to the body: see `moving`.
        turn, translate: The whole scene is turned by this [degrees] and moved by this [m].
        push: Every vertex is pushed by this at frame 0 [m].
        fps: Frames a second.
        seconds: Length after the warm-up.
    """

    material: tuple[tuple[str, float], ...] = ()
    friction: float | None = None
    fabric: str | None = None
    body: str = "base"
    beyond: float = 1.0
    speed: float = 1.0
    freeze: bool = False
    event: Event | None = None
    turn: float = 0.0
    translate: tuple[float, float, float] = (0.0, 0.0, 0.0)
    push: float = JITTER
    fps: float = FPS
    seconds: float = 2.0

    def frames(self, preset: Preset) -> int:
        """Frames after the warm-up."""
        return preset.mesh.limited(round(self.seconds * self.fps))

    @property
    def warm_up(self) -> int:
        """Frames before frame 0."""
        return round(WARM_UP * self.fps / FPS)

    def steps(self, preset: Preset) -> int:
        """Frames that a simulator has to make."""
        return self.warm_up + self.frames(preset) - 1

    @property
    def rest_from(self) -> int | None:
        """The frame from which the body comes to rest, or None."""
        return round(EVENT * self.fps / FPS) if self.freeze or self.event == "stop" else None

    def scene(self, start: int) -> Scene:
        """The scene at 30 frames a second, its cloth and its solver's settings those of the course."""
        plain = load_scene(UNSTRESSED)
        motion = replace(
            plain.motion,
            start=FIRST + CYCLE / PAIRS * (start // 2 % PAIRS),
            speed=self.speed,
            freeze_after=EVENT if self.freeze else None,
            turn=self.turn,
            translate=self.translate,
        )
        cloth = plain.material if self.fabric is None else replace(plain.material, **_fabric(self.fabric))
        cloth = replace(cloth, **{name: factor * getattr(cloth, name) for name, factor in self.material})
        cloth = cloth if self.friction is None else replace(cloth, friction=self.friction)
        queries = max(1, round(plain.simulation.queries * FPS / self.fps))  # as many a second
        settings = replace(plain.simulation, queries=queries)
        return replace(plain, body=self.body, motion=motion, material=cloth, simulation=settings)

    def pushed(self, start: int) -> Push:
        """The push of a start."""
        return Push(self.warm_up, self.push, start)

    def at_30(self, frames: int) -> int:
        """How many frames at 30 a second show what so many of its own do."""
        return math.ceil((frames - 1) * FPS / self.fps) + 1


@dataclass(frozen=True, kw_only=True)
class Rung:
    """A rung.

    Attributes:
        name: In results.csv.
        title: For people.
        group: Rungs of a kind.
        course: What is climbed.
        step: Times the length of the simulators' time step; methods know none.
        precision: What networks compute in; other lines don't climb the rung. None for what they do anyway.
        starts: At most so many.
        unmoved: It should end as the unstressed course does.
    """

    name: str
    title: str
    group: str
    course: Course
    step: int = 1
    precision: Precision | None = None
    starts: int = 10
    unmoved: bool = False


def _fabric(name: str) -> dict[str, float]:
    return resolved({"fabric": name}, "")
