"""Motions that the suite's scenes don't have, made of the bones of those that they have."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from garmentbench.motion.clip import Clip
from garmentbench.motion.clip_animation import RUN_UP
from garmentbench.motion.easing import smoothstep
from garmentbench.motion.gait import GAITS, Gait
from garmentbench.motion.legs import rest_leg
from garmentbench.motion.performing import perform
from garmentbench.motion.scores import SCORES
from garmentbench.motion.timing import WARM_UP, score_timing, timing
from garmentbench.motion.walk import walk
from garmentbench.scenes.bodies import BakedBody
from garmentbench.scenes.scene import FPS, Motion, Scene

PRESSED = -8.0  # [degrees] the upper arms off the hanging line: they and the elbows go into the trunk
PRESSING = 10  # frames in which they get there
MEDLEY = (*GAITS, *(name for name in SCORES if name != "still"))
PIECE = (120, 240)  # frames of a motion before the next one, at least and at most
BLEND = 20  # frames in which one becomes the other


def moved(baked: BakedBody, name: str, frames: int, gait: Gait | None = None) -> Clip:
    """A motion of the suite from frame 0 on, of a gait in its place if one is given."""
    motion, gait = Motion(name), GAITS.get(name) if gait is None else gait
    if gait is None:
        when = score_timing(motion, frames, FPS)
        bones = perform(baked, SCORES[name](baked, float(when.phase[-1])), when.phase, when.dressed)
    else:
        when = timing(gait, motion, frames, FPS)
        bones = walk(baked, gait, when.phase, when.dressed, when.phase[WARM_UP])
    whole = slice(WARM_UP, None)
    standing = np.zeros((frames, 2), bool)
    return Clip(bones.rotations[whole], bones.root[whole], standing, FPS, rest_leg(baked, "L").reach)


def pressed(baked: BakedBody, scene: Scene, frames: int, at: int) -> Clip:
    """A scene's walk whose arms are pressed into the torso from frame `at` on, as `animate_middle` takes it."""
    name, first = scene.motion.name, round(scene.motion.start * FPS) - RUN_UP
    gait, stop = GAITS[name], first + RUN_UP + frames
    free, held = (moved(baked, name, stop, g) for g in (gait, replace(gait, arm_space=PRESSED, arm_swing=0.0)))
    share = smoothstep((np.arange(stop) - first - RUN_UP - at) / PRESSING)
    return blended(free, held, share).frames(first, stop)


def medley(baked: BakedBody, frames: int) -> Clip:
    """All motions of the suite by turns, in an order that is drawn; no frame of any is shown twice."""
    chance, count = np.random.default_rng(0), RUN_UP + frames
    left = {name: moved(baked, name, _enough(count)) for name in MEDLEY}
    made, last = None, ""
    while made is None or len(made) < count:
        length = int(chance.integers(*PIECE, endpoint=True)) + BLEND
        open_to = [name for name, clip in left.items() if name != last and len(clip) >= length]
        last = open_to[chance.integers(len(open_to))]
        piece, left[last] = left[last].frames(0, length), left[last].frames(length, len(left[last]))
        made = piece.from_origin(0) if made is None else joined(made, piece)
    return made.frames(0, count)


def _enough(frames: int) -> int:
    """Frames of each motion that fill so many, whatever is drawn."""
    return 2 * (frames // len(MEDLEY) + PIECE[1] + BLEND)


def joined(one: Clip, other: Clip) -> Clip:
    """A clip and another one, which takes over where the first one is, and as it faces, in its last `BLEND` frames."""
    middle = len(one) - BLEND // 2
    x, y = one.rotations[middle, 0, :2, 0] / np.linalg.norm(one.rotations[middle, 0, :2, 0])
    turn = np.array([[x, -y, 0.0], [y, x, 0.0], [0.0, 0.0, 1.0]])
    placed = other.from_origin(BLEND // 2)
    root = placed.root @ turn.T + [*one.root[middle, :2], 0.0]
    placed = replace(placed, rotations=turn @ placed.rotations, root=root)
    over = len(one) - BLEND
    both = blended(one.frames(over, len(one)), placed.frames(0, BLEND), smoothstep(np.arange(BLEND) / (BLEND - 1)))
    parts = one.frames(0, over), both, placed.frames(BLEND, len(placed))
    return replace(
        one, **{name: np.concatenate([getattr(p, name) for p in parts]) for name in ("rotations", "root", "standing")}
    )


def blended(one: Clip, other: Clip, share: np.ndarray) -> Clip:
    """From one clip, where the share is 0, to another, where it is 1; shares of shape (T,), bones by the shortest
    turn."""
    between = np.swapaxes(one.rotations, -1, -2) @ other.rotations
    turns = Rotation.from_matrix(between.reshape(-1, 3, 3)).as_rotvec().reshape(between.shape[:-1])
    part = Rotation.from_rotvec((share[:, None, None] * turns).reshape(-1, 3)).as_matrix().reshape(between.shape)
    return replace(one, rotations=one.rotations @ part, root=one.root + share[:, None] * (other.root - one.root))
