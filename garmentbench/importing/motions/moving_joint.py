"""Where the motion of a recording is: hips that hang below a still root have a path of their own."""

from dataclasses import replace

import numpy as np

from garmentbench.importing.motions.recording import Recording, world

_MOVING = 0.01  # of the skeleton's size: a joint's position channels that vary by more are a path, not a bone
_ALMOST_ALL = 0.8  # of the joints: what hangs from the joint that carries the motion


def from_moving_joint(recording: Recording, paths: dict[int, np.ndarray], notes: list[str]) -> Recording:
    """The recording with the joint as its root that carries the motion: the last one with a path of its own from which
    almost the whole skeleton hangs."""
    size = np.ptp(world(recording.rest_pose())[1][0], axis=0).max()
    moving = [i for i, path in paths.items() if i and np.ptp(path, axis=0).max() > _MOVING * size]
    below = {i: _below(recording.parents, i) for i in moving}
    above = {i: _above(recording.parents, i) for i in moving}
    carriers = [i for i in moving if len(below[i]) >= _ALMOST_ALL * (len(recording.names) - len(above[i]))]
    root = carriers[-1] if carriers else 0
    others = [i for i in moving if i not in carriers]
    if others:
        names = ", ".join(f"'{recording.names[i]}'" for i in others[:5]) + (" ..." if len(others) > 5 else "")
        notes.append(f"position channels of {names} change a bone's length: their median is taken")
    if root == 0:
        return replace(recording, notes=tuple(notes))
    turn, place = np.tile(np.eye(3), (len(recording), 1, 1)), np.zeros((len(recording), 3))
    for i in reversed(above[root]):
        place = place + (turn @ paths.get(i, np.tile(recording.offsets[i], (len(recording), 1)))[..., None])[..., 0]
        turn = turn @ recording.rotations[:, i]
    place = place + (turn @ paths[root][..., None])[..., 0]
    axes = turn[0].T  # a turn of all that is above is a choice of axes, which are found out later
    rotations = recording.rotations.copy()
    rotations[:, root] = axes @ turn @ recording.rotations[:, root]
    kept = below[root]
    lost = [recording.names[i] for i in range(len(recording.names)) if i not in kept and i not in above[root]]
    notes.append(
        f"root: '{recording.names[root]}', whose path is its own, below '{recording.names[above[root][0]]}'"
        + (f"; left out beside it: {', '.join(lost[:5])}" if lost else "")
    )
    number = {old: new for new, old in enumerate(kept)}
    return Recording(
        tuple(recording.names[i] for i in kept),
        np.array([number.get(int(recording.parents[i]), -1) for i in kept]),
        recording.offsets[kept],
        rotations[:, kept],
        place @ axes.T,
        recording.fps,
        tuple(notes),
    )


def _above(parents: np.ndarray, joint: int) -> list[int]:
    """The joints above one, its parent first."""
    out = []
    while (joint := int(parents[joint])) >= 0:
        out.append(joint)
    return out


def _below(parents: np.ndarray, joint: int) -> list[int]:
    """A joint and all that hang from it, parents first."""
    out = [joint]
    for i in range(joint + 1, len(parents)):
        if parents[i] in out:
            out.append(i)
    return out
