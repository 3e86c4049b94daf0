"""A walking human body: gait, timing and skinning put together."""

import numpy as np

from garmentbench.bodies import BakedBody, load_body, pose_exact
from garmentbench.motion.animation import Animation
from garmentbench.motion.gait import Gait, gait
from garmentbench.motion.placing import place
from garmentbench.motion.timing import WARM_UP, timing
from garmentbench.motion.walk import walk
from garmentbench.scene import Scene

DRESSED = "base"  # the shape that garments are made for, in which every warm-up begins


def animate_human(scene: Scene, size: str, frames: int) -> Animation:
    """The scene's body in its motion for `frames` frames, after the warm-up.

    The warm-up begins in the rest pose of the base shape, at the origin, and morphs to the scene's own shape.
    Raises `UsageError` for an unknown motion or body.
    """
    steps = gait(scene.motion.name)
    baked = load_body(scene.body, size)
    when = timing(steps, scene.motion, frames, scene.fps)
    positions = _vertices(baked, steps, when.phase, when.dressed, when.phase[WARM_UP])
    morphing = when.shape < 1
    if scene.body != DRESSED:
        share = when.shape[morphing, None, None]
        base = _vertices(load_body(DRESSED, size), steps, when.phase[morphing], when.dressed[morphing], when.phase[WARM_UP])
        positions[morphing] = base + share * (positions[morphing] - base)
    return Animation(baked.body, place(positions, scene.motion), WARM_UP)


def _vertices(baked: BakedBody, steps: Gait, phase: np.ndarray, dressed: np.ndarray, first: float) -> np.ndarray:
    walking = walk(baked, steps, phase, dressed, first)
    return pose_exact(baked, walking.rotations, walking.root)
