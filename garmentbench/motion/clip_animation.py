"""A body in a recorded motion: from the A-pose into the first pose of the scene's clip, then the clip."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from garmentbench.errors import UserError
from garmentbench.motion.animation import Animation
from garmentbench.motion.arms import turn_out
from garmentbench.motion.clip import Clip, part, read_clip
from garmentbench.motion.easing import rolling_start, smoothstep
from garmentbench.motion.placing import place, played_frames
from garmentbench.motion.planting import plant
from garmentbench.scenes.bodies import BakedBody, load_body, pose_exact
from garmentbench.scenes.scene import Scene

WARM_UP = 60  # frames before frame 0
_POSED = 30  # frames from the start until the pose is the clip's
_MORPHED = 25  # frames from the start until the shape is the scene's
RUN_UP = (WARM_UP - _POSED) // 2  # frames of the clip that are played, ever faster, before frame 0
_DRESSED = "base"  # the shape that garments are made for, in which every warm-up begins


def animate_clip(scene: Scene, size: str, frames: int) -> Animation:
    """The scene's body in its clip for `frames` frames, after the warm-up.

    The warm-up begins in the rest pose of the base shape at the origin, which within a second turns into the clip's
    first pose and the scene's shape; then the clip starts. Frame 0 shows it half a second after its start.
    Raises `UserError` where the clip is too short, and as `load_clip`.
    """
    motion, last = scene.motion, clip_frames(scene, frames)[-1]
    assert motion.file is not None, "a motion of ours has no file"
    file = Path(motion.file)

    def loaded(baked: BakedBody) -> Clip:
        clip = load_clip(file, baked, scene.fps, motion.start, motion.stop, motion.arm_space)
        if last > len(clip) - 1:
            fit = int((len(clip) - 1) / motion.speed - RUN_UP) + 1
            raise UserError(
                f"scene {scene.name}: {scene.frames} frames asked for; {motion.file} has {max(fit, 0)} at "
                f"{scene.fps:g} a second after its first half second; lower frames or take a longer clip"
            )
        return clip

    return animate_middle(scene, size, frames, loaded)


def animate_middle(scene: Scene, size: str, frames: int, clip_of: Callable[[BakedBody], Clip]) -> Animation:
    """The scene's body in a clip that begins in the middle of a motion, after the warm-up that leads there.

    Args:
        scene, size, frames: As for `animate_clip`.
        clip_of: The motion on a body, from `RUN_UP` frames before frame 0 on, as long as `clip_frames` asks for.
    """
    when = clip_frames(scene, frames)
    baked = load_body(scene.body, size)
    positions = _vertices(clip_of(baked), baked, when, scene.fps)
    if scene.body != _DRESSED:
        base = load_body(_DRESSED, size)
        share = smoothstep(np.arange(_MORPHED) / _MORPHED)[:, None, None]
        start = _vertices(clip_of(base), base, when[:_MORPHED], scene.fps)
        positions[:_MORPHED] = start + share * (positions[:_MORPHED] - start)
    return Animation(baked.body, place(positions, scene.motion), WARM_UP)


def load_clip(
    path: Path,
    baked: BakedBody,
    fps: float,
    start: float = 0.0,
    stop: float | None = None,
    arm_space: float = 0.0,
    to_end: bool = False,
) -> Clip:
    """The clip of a file on a body, its feet planted.

    Args:
        path: A file of `save_clip`.
        baked: The body.
        fps: Frames a second that are wanted.
        start, stop: The part of the clip [s]; None: to its end.
        arm_space: Hanging arms are turned outward by this [degrees].
        to_end: A stop beyond its end is its end.

    Raises:
        UserError: No such file, not a clip's, damaged, or shorter than the part asked for.
    """
    clip = read_clip(path, baked)
    seconds = (len(clip) - 1) / clip.fps
    if seconds * fps < 1 - 1e-6:
        raise UserError(f"{path}: {seconds:.4g} s long; wanted two frames or more at {fps:g} a second")
    if clip.fps != fps:
        clip = clip.at(np.arange(int(seconds * fps + 1e-6) + 1) * clip.fps / fps, fps)
    first, last = part(path, (len(clip) - 1) / fps, fps, start, stop, to_end)
    return plant(turn_out(clip.frames(first, last + 1), arm_space, baked), baked)


def clip_frames(scene: Scene, frames: int) -> np.ndarray:
    """Which frame of the clip each frame shows, shape (WARM_UP + T,)."""
    start = RUN_UP * rolling_start((np.arange(WARM_UP) - WARM_UP) / RUN_UP + 1)
    played = RUN_UP + played_frames(np.arange(frames), scene.motion.freeze_after, scene.fps)
    return scene.motion.speed * np.concatenate([start, played])


def _vertices(clip: Clip, baked: BakedBody, when: np.ndarray, fps: float) -> np.ndarray:
    return pose_exact(baked, *_from_rest(clip.from_origin(0).at(when, fps), baked))


def _from_rest(clip: Clip, baked: BakedBody) -> tuple[np.ndarray, np.ndarray]:
    """Rotations and root of a clip whose first frames lead out of the rest pose, the lower foot on the floor
    meanwhile."""
    share = smoothstep(np.arange(len(clip)) / _POSED)
    first = share < 1
    rotations, root = clip.rotations.copy(), clip.root.copy()
    turns = Rotation.from_matrix(rotations[first].reshape(-1, 3, 3)).as_rotvec().reshape(-1, rotations.shape[1], 3)
    eased = Rotation.from_rotvec((share[first, None, None] * turns).reshape(-1, 3))
    rotations[first] = eased.as_matrix().reshape(-1, rotations.shape[1], 3, 3)
    root[first] = baked.joints[0] + share[first, None] * (root[first] - baked.joints[0])
    low = _lowest(baked, rotations[first], root[first])
    wanted = low[0] + share[first] * (_lowest(baked, clip.rotations[:1], clip.root[:1]) - low[0])
    root[first, 2] += wanted - low
    return rotations, root


def _lowest(baked: BakedBody, rotations: np.ndarray, root: np.ndarray) -> np.ndarray:
    """Height of the lowest vertex of the feet [m], shape (T,)."""
    feet = [i for i, name in enumerate(baked.joint_names) if name.startswith(("foot", "toes"))]
    soles = np.flatnonzero(baked.weights[:, feet].sum(axis=1) > 0.5)
    return pose_exact(baked, rotations, root, soles)[..., 2].min(axis=1)
