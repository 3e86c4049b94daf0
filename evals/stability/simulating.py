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
from garmentbench.simulation.drive import drive

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
    run = drive(
        garment,
        place(garment.rest, scene.motion),
        shown.body,
        shown.positions,
        course.fps,
        scene.material,
        replace(scene.simulation, step_margin=step * scene.simulation.step_margin),
        device,
        budget=max(1, round(SUBSTEPS * FPS / course.fps / step)) if xpbd else None,
        push=course.pushed(start, shown.warm_up),
        step=tick,
    )
    with np.errstate(over="ignore"):  # it may be beyond float32
        return run.positions[shown.warm_up :].astype(np.float32)
