"""A body in a recorded motion: from the A-pose into the first pose of the scene's clip, then the clip."""

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
_RUN_UP = (WARM_UP - _POSED) / 2  # frames of the clip that are played, ever faster, before frame 0
_DRESSED = "base"  # the shape that garments are made for, in which every warm-up begins


def animate_clip(scene: Scene, size: str, frames: int) -> Animation:
    """The scene's body in its clip for `frames` frames, after the warm-up.

    The warm-up begins in the rest pose of the base shape at the origin, which within a second turns into the clip's
    first pose and the scene's shape; then the clip starts. Frame 0 shows it half a second after its start.
    Raises `UserError` where the clip is too short, and as `load_clip`.
    """
    when = _clip_frames(scene, frames)
    baked = load_body(scene.body, size)
    positions = _vertices(scene, baked, when)
    if scene.body != _DRESSED:
        share = smoothstep(np.arange(_MORPHED) / _MORPHED)[:, None, None]
        base = _vertices(scene, load_body(_DRESSED, size), when[:_MORPHED])
        positions[:_MORPHED] = base + share * (positions[:_MORPHED] - base)
    return Animation(baked.body, place(positions, scene.motion), WARM_UP)


def load_clip(
    path: Path, baked: BakedBody, fps: float, start: float = 0.0, stop: float | None = None, arm_space: float = 0.0
) -> Clip:
    """The clip of a file on a body, its feet planted.

    Args:
        path: A file of `save_clip`.
        baked: The body.
        fps: Frames a second that are wanted.
        start, stop: The part of the clip [s]; None: to its end.
        arm_space: Hanging arms are turned outward by this [degrees].

    Raises:
        UserError: No such file, not a clip's, damaged, or shorter than the part asked for.
    """
    clip = read_clip(path, baked)
    seconds = (len(clip) - 1) / clip.fps
    if seconds * fps < 1 - 1e-6:
        raise UserError(f"{path}: {seconds:.4g} s long; wanted two frames or more at {fps:g} a second")
    if clip.fps != fps:
        clip = clip.at(np.arange(int(seconds * fps + 1e-6) + 1) * clip.fps / fps, fps)
    first, last = part(path, (len(clip) - 1) / fps, fps, start, stop)
    return plant(turn_out(clip.frames(first, last + 1), arm_space, baked), baked)


def _clip_frames(scene: Scene, frames: int) -> np.ndarray:
    """Which frame of the clip each frame shows, shape (WARM_UP + T,)."""
    start = _RUN_UP * rolling_start((np.arange(WARM_UP) - WARM_UP) / _RUN_UP + 1)
    played = _RUN_UP + played_frames(np.arange(frames), scene.motion.freeze_after, scene.fps)
    return scene.motion.speed * np.concatenate([start, played])


def _vertices(scene: Scene, baked: BakedBody, when: np.ndarray) -> np.ndarray:
    motion = scene.motion
    assert motion.file is not None, "a motion of ours has no file"
    clip = load_clip(Path(motion.file), baked, scene.fps, motion.start, motion.stop, motion.arm_space)
    if when[-1] > len(clip) - 1:
        fit = int((len(clip) - 1) / scene.motion.speed - _RUN_UP) + 1
        raise UserError(
            f"scene {scene.name}: {scene.frames} frames asked for; {scene.motion.file} has {max(fit, 0)} at "
            f"{scene.fps:g} a second after its first half second; lower frames or take a longer clip"
        )
    return pose_exact(baked, *_from_rest(clip.from_origin(0).at(when, scene.fps), baked))


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
