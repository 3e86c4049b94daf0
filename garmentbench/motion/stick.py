"""The paper's moving stick, round which a sheet of cloth winds (figures 9 and 10): a rigid object, no human.

The stick lies along x. In `stick-a`, `-b` and `-c` it rolls: the sheet is pinned along its front (towards -y), level
with the axis, and hangs down from there, so that it is tangent to the stick; turning back about -x winds it up. In
`stick-swing-a` and `-b` it only moves and turns about the vertical: what is laid over it hangs on by its weight and
friction alone.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from garmentbench.errors import unknown_name
from garmentbench.motion.animation import Animation
from garmentbench.motion.easing import smoothstep
from garmentbench.motion.placing import place, played_frames
from garmentbench.scenes.scene import Scene
from garmentbench.sequence import OBJECT, Body

STICK = "stick"  # a scene's `body`
RADIUS = 0.035  # [m]
LENGTH = 0.64  # [m], of the cylinder between the round ends
HEIGHT = 1.2  # [m], of the axis at rest
WARM_UP = 60  # frames
AROUND, ALONG = 12, 37  # vertices of the cylinder

# Sums of sines, (amplitude, frequency [Hz], phase [rad]) each. Sweeps x, y, z in metres; yaw, tilt in degrees about z,
# y; roll in turns about the stick's axis, 0 unwound and -1 one turn wound up. What is left out rests.
_MOTIONS = {
    "stick-a": {
        "x": [(0.10, 0.23, 0.0), (0.04, 0.61, 1.3)],
        "y": [(0.16, 0.31, 0.7), (0.05, 0.74, 2.1)],
        "z": [(0.08, 0.27, 1.9), (0.03, 0.83, 0.4)],
        "yaw": [(22.0, 0.19, 0.5), (8.0, 0.52, 2.7)],
        "tilt": [(10.0, 0.24, 1.1), (5.0, 0.57, 0.2)],
        "roll": [(0.55, 0.13, -1.3), (0.20, 0.37, 0.9)],
    },
    "stick-b": {
        "x": [(0.08, 0.29, 2.0), (0.05, 0.55, 0.3)],
        "y": [(0.14, 0.26, 2.9), (0.07, 0.67, 0.8)],
        "z": [(0.09, 0.33, 0.2), (0.03, 0.71, 2.4)],
        "yaw": [(18.0, 0.24, 2.2), (10.0, 0.46, 1.0)],
        "tilt": [(12.0, 0.21, 2.8), (4.0, 0.63, 1.7)],
        "roll": [(0.50, 0.16, 0.4), (0.24, 0.31, 2.6)],
    },
    "stick-c": {
        "x": [(0.09, 0.26, 1.2), (0.04, 0.58, 2.6)],
        "y": [(0.15, 0.28, 1.7), (0.06, 0.71, 0.1)],
        "z": [(0.08, 0.30, 2.7), (0.03, 0.77, 1.2)],
        "yaw": [(20.0, 0.21, 1.4), (9.0, 0.49, 0.3)],
        "tilt": [(11.0, 0.23, 2.0), (4.0, 0.60, 2.9)],
        "roll": [(0.53, 0.14, 2.2), (0.21, 0.34, 0.2)],
    },
    "stick-swing-a": {
        "x": [(0.13, 0.37, 0.6), (0.05, 0.71, 2.2)],
        "y": [(0.20, 0.43, 2.3), (0.06, 0.83, 0.4)],
        "z": [(0.07, 0.31, 1.5), (0.03, 0.67, 0.1)],
        "yaw": [(38.0, 0.29, 1.8), (12.0, 0.61, 0.9)],
    },
    "stick-swing-b": {
        "x": [(0.15, 0.33, 2.5), (0.04, 0.79, 0.7)],
        "y": [(0.18, 0.47, 0.9), (0.07, 0.73, 2.8)],
        "z": [(0.06, 0.39, 0.3), (0.03, 0.63, 2.0)],
        "yaw": [(34.0, 0.34, 0.2), (14.0, 0.53, 1.6)],
    },
}
_WOUND = -0.6  # turns about which the roll swings, where there is one


def stick_motions() -> list[str]:
    """Names of the stick's motions."""
    return sorted(_MOTIONS)


def stick() -> Body:
    """The stick at rest: a closed capsule along x, outward faces, about 480 vertices evenly spaced."""
    rings = [(-LENGTH / 2 - RADIUS * np.sin(a), RADIUS * np.cos(a)) for a in np.radians([60, 30])]
    rings += [(x, RADIUS) for x in np.linspace(-LENGTH / 2, LENGTH / 2, ALONG)]
    rings += [(-x, r) for x, r in rings[1::-1]]
    points = [(-LENGTH / 2 - RADIUS, 0.0, 0.0)]
    for ring, (x, radius) in enumerate(rings):
        angle = 2 * np.pi * (np.arange(AROUND) + ring % 2 / 2) / AROUND
        points += [(x, radius * np.cos(a), radius * np.sin(a)) for a in angle]
    points.append((LENGTH / 2 + RADIUS, 0.0, 0.0))
    rest = np.array(points) + [0, 0, HEIGHT]
    return Body(STICK, rest.astype(np.float32), _capsule_faces(len(rings)), kind=OBJECT)


def _capsule_faces(rings: int) -> np.ndarray:
    number = 1 + np.arange(rings * AROUND).reshape(rings, AROUND)
    first, last = np.zeros(AROUND, int), np.full(AROUND, 1 + rings * AROUND)
    faces = [(first, np.roll(number[0], -1), number[0]), (last, number[-1], np.roll(number[-1], -1))]
    for ring in range(rings - 1):
        # Each ring is half a step ahead of the one before or after it.
        low, high = number[ring], np.roll(number[ring + 1], -(ring % 2))
        low_next, high_next = np.roll(low, -1), np.roll(high, -1)
        faces += [(low, low_next, high), (low_next, high_next, high)]
    return np.concatenate([np.stack(corners, axis=1) for corners in faces]).astype(np.int32)


def animate_stick(scene: Scene, frames: int) -> Animation:
    """The stick in the scene's motion, one of `stick_motions()`. Raises `UsageError` for another name.

    The warm-up leads from the rest pose, at rest, into the motion; every movement is rigid.
    """
    if scene.motion.name not in _MOTIONS:
        raise unknown_name("motion of the stick", scene.motion.name, stick_motions())
    body = stick()
    centre, rotation = _pose(scene, frames)
    local = body.rest.astype(np.float64) - [0, 0, HEIGHT]
    positions = np.einsum("tij,vj->tvi", rotation, local) + centre[:, None] + [0, 0, HEIGHT]
    return Animation(body, place(positions, scene.motion), WARM_UP)


def _pose(scene: Scene, frames: int) -> tuple[np.ndarray, np.ndarray]:
    """Position of the stick's middle against rest [m], shape (T, 3), and its rotation, shape (T, 3, 3)."""
    frame = np.arange(-WARM_UP, frames)
    played = played_frames(frame, scene.motion.freeze_after, scene.fps)
    seconds = scene.motion.start + played * scene.motion.speed / scene.fps
    ease = smoothstep(1 + frame / WARM_UP)
    sway: dict[str, np.ndarray] = {name: np.zeros(len(frame)) for name in ("x", "y", "z", "yaw", "tilt", "roll")}
    for name, waves in _MOTIONS[scene.motion.name].items():
        sway[name] = np.sum([a * np.sin(2 * np.pi * f * seconds + phase) for a, f, phase in waves], axis=0)
    if "roll" in _MOTIONS[scene.motion.name]:
        sway["roll"] = 360 * (sway["roll"] + _WOUND)
    centre = ease[:, None] * np.stack([sway[axis] for axis in "xyz"], axis=1)
    angles = ease[:, None] * np.stack([sway["yaw"], sway["tilt"], sway["roll"]], axis=1)
    return centre, Rotation.from_euler("ZYX", angles, degrees=True).as_matrix()
