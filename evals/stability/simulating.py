"""The simulators on a course: the reference solver, whose frames are kept, and XPBD with a budget of substeps."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from garmentbench.evals.stability.course import Course
from garmentbench.evals.stability.moving import animated
from garmentbench.motion.placing import place
from garmentbench.scenes.garments import scene_garment
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import FPS
from garmentbench.sequence import Template
from garmentbench.simulation.drive import Simulated, drive

FIRST_TRY = 4  # frames
BLOWN_UP = 10.0  # 99th percentile of the edges' strain that no cloth comes back from
SUBSTEPS = 16  # of XPBD a frame at 30 a second; with 10 a laptop T-shirt is strained by half


@dataclass(frozen=True)
class Begun:
    """A course from one of its starts, before anything is simulated.

    Attributes:
        template: What doesn't move.
        bodies: Of each frame after the warm-up [m], shape (T, B, 3), float32.
    """

    template: Template
    bodies: Float[np.ndarray, "frames body 3"]

    @classmethod
    def of(cls, course: Course, start: int, preset: Preset) -> "Begun":
        """A course from a start."""
        shown = animated(course, start, preset)
        garment = scene_garment(course.scene(start), preset.mesh)
        return cls(Template(garment, shown.body, course.fps), shown.positions[shown.warm_up :].astype(np.float32))


def simulated(
    course: Course,
    start: int,
    preset: Preset,
    device: str,
    xpbd: bool = False,
    step: int = 1,
    tick: Callable[[], None] = lambda: None,
) -> Float[np.ndarray, "frames vertices 3"]:
    """The garment after the warm-up [m], shape (T, V, 3), float32, which may be anything once it has blown up.

    Args:
        course, start, preset: What is simulated.
        device: Warp device.
        xpbd: By XPBD; else by the reference solver.
        step: Times the length of the time step.
        tick: Called after each frame.
    """
    scene, shown = course.scene(start), animated(course, start, preset)
    garment = scene_garment(scene, preset.mesh)

    def run(frames: int) -> Simulated:
        return drive(
            garment,
            place(garment.rest, scene.motion),
            shown.body,
            shown.positions[:frames],
            course.fps,
            scene.material,
            replace(scene.simulation, step_margin=step * scene.simulation.step_margin),
            device,
            budget=max(1, round(SUBSTEPS * FPS / course.fps / step)) if xpbd else None,
            push=course.pushed(start),
            step=tick,
        )

    count = len(shown.positions)
    made = run(count) if step == 1 else _while_whole(run, count)
    garments = np.full((count, *garment.rest.shape), np.nan, np.float32)
    with np.errstate(over="ignore"):  # it may be beyond float32
        garments[: len(made.positions)] = made.positions
    return garments[course.warm_up :]


def _while_whole(run: Callable[[int], Simulated], count: int) -> Simulated:
    """A run of that many frames, or of few after it has blown up: then everything touches everything, and a frame takes
    a hundred times as long. It is tried in lengths that double."""
    frames, made = min(FIRST_TRY, count), run(min(FIRST_TRY, count))
    while frames < count and np.nan_to_num(made.strain[-1, 1], nan=np.inf) < BLOWN_UP:
        frames = min(2 * frames, count)
        made = run(frames)
    return made
