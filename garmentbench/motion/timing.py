"""Which phase of a walk, or time of a score, a frame shows: the start, the speed and the standstill."""

from dataclasses import dataclass

import numpy as np

from garmentbench.motion.easing import smoothstep
from garmentbench.motion.foot import HEEL_OFF
from garmentbench.motion.gait import Gait
from garmentbench.motion.placing import played_frames
from garmentbench.motion.variation import hurry
from garmentbench.scenes.scene import Motion

WARM_UP = 60  # frames before frame 0
START = HEEL_OFF - 0.54  # just before the right heel, as the first, comes off the ground
_STEPPING = 8  # frames from the start in which only the pose changes
_DRESSED = 26  # frames from the start until the pose is the walk's
_MORPHED = 25  # frames from the start until the shape is the scene's
_LEAD = 1.5  # seconds of a score that are over by frame 0, at least
_LIKED = 1.6  # final speed of the phase over its mean in the warm-up; monotone from 0 to 2.5


@dataclass(frozen=True)
class Timing:
    """When what happens, one value a frame, shape (WARM_UP + T,).

    Attributes:
        phase: Phase of the walk, a whole number at frame 0; or seconds of the score.
        dressed: From 0 (the rest pose) to 1 (fully walking).
        shape: From 0 (the base shape, which garments are made for) to 1 (the scene's own).
    """

    phase: np.ndarray
    dressed: np.ndarray
    shape: np.ndarray


def timing(gait: Gait, motion: Motion, frames: int, fps: float) -> Timing:
    """The timing of `frames` frames and their warm-up."""
    rate = motion.speed / (gait.period * fps)  # cycles a frame
    stepping = WARM_UP - _STEPPING
    start = _start((np.arange(WARM_UP) - _STEPPING) / stepping, rate * stepping)
    played = rate * played_frames(np.arange(frames), motion.freeze_after, fps)
    phase = round(start[-1] + rate) + played + gait.variation * hurry(played)
    return Timing(
        phase=np.concatenate([start, phase]),
        dressed=smoothstep(np.arange(WARM_UP + frames) / _DRESSED),
        shape=smoothstep(np.arange(WARM_UP + frames) / _MORPHED),
    )


def score_timing(motion: Motion, frames: int, fps: float) -> Timing:
    """The timing of a score for `frames` frames and their warm-up, in which its first 1.5 s, or more, pass."""
    rate = motion.speed / fps  # seconds of the score a frame
    stepping = WARM_UP - _STEPPING
    u = np.maximum((np.arange(WARM_UP) - _STEPPING) / stepping, 0.0)
    over = max(_LEAD, rate * stepping / _LIKED)
    seconds = over + rate * played_frames(np.arange(frames), motion.freeze_after, fps)
    return Timing(
        phase=np.concatenate([_to_speed(u, 0.0, over, rate * stepping), seconds]),
        dressed=smoothstep(np.arange(WARM_UP + frames) / _DRESSED),
        shape=smoothstep(np.arange(WARM_UP + frames) / _MORPHED),
    )


def _start(u: np.ndarray, rate: float) -> np.ndarray:
    """Phase from a standstill at START until u = 0 to a whole number at `rate` at u = 1; C2."""
    u = np.maximum(u, 0.0)
    cycles = max(1, round(rate / _LIKED + START)) - START
    return _to_speed(u, START, cycles, rate)


def _to_speed(u: np.ndarray, start: float, way: float, rate: float) -> np.ndarray:
    """From `start`, at rest, at u = 0 to `way` further, at `rate`, at u = 1; C2."""
    return start + way * smoothstep(u) + rate * u**3 * (u * (7 - 3 * u) - 4)
