"""How the body moves on a course: the walk, and what happens to it."""

from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from garmentbench.evals.stability.bones import medley, pressed
from garmentbench.evals.stability.course import EVENT, Course
from garmentbench.motion.animation import Animation
from garmentbench.motion.clip_animation import animate_middle
from garmentbench.motion.human import animate_human
from garmentbench.scenes.bodies import load_body
from garmentbench.scenes.presets import Preset
from garmentbench.scenes.scene import BASE, FPS, Scene

AWAY = (1.0, 0.0, 0.0)  # [m] a teleport


def animated(course: Course, start: int, preset: Preset) -> Animation:
    """The body of a course from a start, warm-up first, at the course's own frame rate."""
    scene, frames = course.scene(start), course.frames(preset)
    shown = _shown(course, scene, preset.mesh.body_size, course.at_30(frames))
    if course.fps != FPS:
        shown = resampled(shown, course, frames)
    return replace(shown, positions=happened(course, shown.positions, shown.warm_up))


def _shown(course: Course, scene: Scene, size: str, frames: int) -> Animation:
    """The walk or the medley at 30 frames a second."""
    if course.event == "medley":
        return animate_middle(scene, size, frames, lambda baked: medley(baked, frames))
    if course.event == "pressed":
        return animate_middle(scene, size, frames, lambda baked: pressed(baked, scene, frames, EVENT))
    shown = animate_human(scene, size, frames)
    if course.beyond == 1:
        return shown
    base = animate_human(replace(scene, body=BASE), size, frames).positions
    rest = load_body(BASE, size).body.rest
    body = replace(shown.body, rest=rest + np.float32(course.beyond) * (shown.body.rest - rest))
    return Animation(body, base + course.beyond * (shown.positions - base), shown.warm_up)


def resampled(shown: Animation, course: Course, frames: int) -> Animation:
    """The same motion at the course's frame rate: a cubic spline through each vertex's places at 30 frames a second.

    Args:
        shown: At 30 frames a second.
        course: Says how many frames a second.
        frames: So many after the warm-up.
    """
    at = np.arange(course.warm_up + frames) * FPS / course.fps
    known = np.arange(len(shown.positions))
    positions = CubicSpline(known, shown.positions)(np.minimum(at, known[-1]))
    return replace(shown, positions=positions, warm_up=course.warm_up)


def happened(course: Course, positions: np.ndarray, warm_up: int) -> np.ndarray:
    """Positions [m], shape (T, B, 3), after what happens at the course's event.

    "stop": the body stands still from one frame to the next. "dropped": one frame shows what the one before it did.
    "teleport": from one frame to the next all of it is a metre away.
    """
    at, positions = warm_up + round(EVENT * course.fps / FPS), positions.copy()
    if course.event == "stop":
        positions[at:] = positions[at]
    elif course.event == "dropped":
        positions[at] = positions[at - 1]
    elif course.event == "teleport":
        positions[at:] += AWAY
    return positions
