"""A moving human body: motion, timing and skinning put together."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from garmentbench.errors import UsageError, unknown_name
from garmentbench.motion.animation import Animation
from garmentbench.motion.clip import Clip
from garmentbench.motion.clip_animation import RUN_UP, animate_middle, clip_frames
from garmentbench.motion.gait import GAITS
from garmentbench.motion.legs import rest_leg
from garmentbench.motion.performing import perform
from garmentbench.motion.placing import place
from garmentbench.motion.scores import SCORES
from garmentbench.motion.timing import WARM_UP, Timing, score_timing, timing
from garmentbench.motion.walk import Walk, walk
from garmentbench.scenes.bodies import BakedBody, load_body, pose_exact
from garmentbench.scenes.scene import Scene

DRESSED = "base"  # the shape that garments are made for, in which every warm-up begins

Moves = Callable[[BakedBody, slice], Walk]  # a body's bones in the frames of a slice of the animation, warm-up first


def human_motions() -> list[str]:
    """Names of the motions."""
    return [*GAITS, *SCORES]


def animate_human(scene: Scene, size: str, frames: int) -> Animation:
    """The scene's body in its motion for `frames` frames, after the warm-up.

    The warm-up begins in the rest pose of the base shape, at the origin, and morphs to the scene's own shape.
    Where the scene begins in the middle of a motion, its frame 0 is that frame of the motion, over the origin.
    Raises `UsageError` for an unknown motion or body.
    """
    if scene.motion.start > 0:
        return _animate_late(scene, size, frames)
    moves, when = _moves(scene, frames)
    baked = load_body(scene.body, size)
    positions = _vertices(baked, moves, slice(None))
    morphing = slice(int(np.sum(when.shape < 1)))
    if scene.body != DRESSED:
        share = when.shape[morphing, None, None]
        base = _vertices(load_body(DRESSED, size), moves, morphing)
        positions[morphing] = base + share * (positions[morphing] - base)
    return Animation(baked.body, place(positions, scene.motion), WARM_UP)


def _animate_late(scene: Scene, size: str, frames: int) -> Animation:
    """The part of a motion that begins at the scene's start: what the same scene from 0 on shows there."""
    first = round(scene.motion.start * scene.fps)
    if first < RUN_UP:
        raise UsageError(
            f"scene {scene.name}: motion.start is {scene.motion.start:g} s; wanted 0, or {RUN_UP / scene.fps:g} s at "
            "least, which pass in the warm-up"
        )
    length = int(np.ceil(clip_frames(scene, frames)[-1])) + 1
    whole = replace(scene, motion=replace(scene.motion, start=0.0, speed=1.0, freeze_after=None))
    moves, _ = _moves(whole, first - RUN_UP + length)
    part = slice(WARM_UP + first - RUN_UP, WARM_UP + first - RUN_UP + length)

    def clip_of(baked: BakedBody) -> Clip:
        moving = moves(baked, part)
        return Clip(moving.rotations, moving.root, np.zeros((length, 2), bool), scene.fps, rest_leg(baked, "L").reach)

    return animate_middle(scene, size, frames, clip_of)


def _moves(scene: Scene, frames: int) -> tuple[Moves, Timing]:
    """How the bones move, and when."""
    name = scene.motion.name
    if name in SCORES:
        when = score_timing(scene.motion, frames, scene.fps)

        def performed(baked: BakedBody, part: slice) -> Walk:
            return perform(baked, SCORES[name](baked, float(when.phase[-1])), when.phase[part], when.dressed[part])

        return performed, when
    if name not in GAITS:
        raise unknown_name("motion", name, human_motions())
    steps = GAITS[name]
    when = timing(steps, scene.motion, frames, scene.fps)
    return lambda baked, part: walk(baked, steps, when.phase[part], when.dressed[part], when.phase[WARM_UP]), when


def _vertices(baked: BakedBody, moves: Moves, part: slice) -> np.ndarray:
    moving = moves(baked, part)
    return pose_exact(baked, moving.rotations, moving.root)
