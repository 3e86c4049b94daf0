"""What was found in a motion and made of it, in lines and a picture that a person checks before relying on them."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from garmentbench.importing.motions.load import ImportedClip
from garmentbench.importing.motions.names import NameMap
from garmentbench.importing.motions.recording import Recording, world
from garmentbench.importing.motions.retarget import standing_height
from garmentbench.importing.motions.skeleton import Upright
from garmentbench.importing.text import counted
from garmentbench.motion.clip import Clip
from garmentbench.scenes.bodies import BakedBody, pose, pose_exact
from garmentbench.storage.atomic import written_whole

_INSIDE = 0.02  # how deep a vertex must be to count: skin touches skin [m]
_LOOKED_AT = 60  # frames
_FASTEST = 15.0  # of a joint [m/s]: a thrown fist has 12
_MOST_ARM_SPACE = 25.0  # [degrees] beyond which it is no longer the same motion
_HARDLY = 15.0  # [%] of the frames that a foot stands in a motion of somebody on his feet; runners have 30
_RATES = 12.0, 500.0  # frames a second of recordings: 15 of video at the least, 480 of the fastest cameras
_UNEVEN = 0.05  # a difference between the feet that is worth a line [m]


def findings(imported: ImportedClip, baked: BakedBody) -> Iterator[str]:
    """The lines: the skeleton, its names, its feet before and after planting, arms inside the torso."""
    clip, stop = imported.clip, imported.choices.stop
    end = imported.choices.start + (len(clip) - 1) / clip.fps
    if stop is not None and stop > end + 1.5 / clip.fps:
        yield f"stop: {stop:g} s is beyond the recording's end: taken to its end, {end:.2f} s"
    if imported.recording is not None and imported.upright is not None and imported.names is not None:
        yield from _skeleton(imported, imported.recording, imported.upright, imported.names)
    if len(clip) > 1 and not (np.ptp(clip.rotations, axis=0).max() > 1e-3 or np.ptp(clip.root, axis=0).max() > 1e-3):
        yield "warning: nothing moves in it: one pose, held; was the motion exported with it?"
    share = 100 * clip.standing.mean(axis=0)
    yield (
        f"result: {len(clip)} frames at {clip.fps:g} a second on body {baked.body.name}; "
        f"left foot on the ground in {share[0]:.0f} %, right in {share[1]:.0f} %"
    )
    for side, percent in zip(("left", "right"), share, strict=True):
        if percent < _HARDLY:
            how = f"hardly stands (in {percent:.0f} % of the frames)" if percent else "never stands"
            yield (
                f"warning: the {side} foot {how}: right only for somebody who jumps or hops throughout; else "
                "the recording floats, sinks, jitters or stays in place (look at --picture), or its rate is wrong "
                "(--recording-fps)"
            )
    slide, heights = foot_slide_cm(clip, baked), foot_heights_cm(clip, baked)
    if slide is not None and heights is not None:
        before = None if imported.unplanted is None else foot_slide_cm(imported.unplanted, baked)
        low, high = (round(height, 2) + 0.0 for height in heights)  # no -0.00
        yield (
            f"feet: slide {slide:.2f} cm a frame at most while they stand"
            + ("" if before is None else f" (before planting {before:.2f})")
            + f"; their lowest point is then at {low:.2f} to {high:.2f} cm"
        )
    yield arms_line(100 * arms_inside(clip, baked), imported.choices.arm_space)


def arms_line(inside: float, arm_space: float) -> str:
    """How often arms are inside the torso [%], with the advice that was not yet followed."""
    line = f"arms: fore-arm or hand more than 2 cm inside the rest of the body in {inside:.0f} % of the frames"
    if inside == 0:
        return line
    if not arm_space:
        return f"{line}; --arm-space 10 turns hanging arms outward"
    if arm_space < _MOST_ARM_SPACE:
        return f"{line}, with --arm-space {arm_space:g}; more than that turns them farther out"
    return (
        f"{line}, with --arm-space {arm_space:g}: not because they hang too near; cut those frames off, or accept them"
    )


def _skeleton(imported: ImportedClip, recording: Recording, upright: Upright, names: NameMap) -> Iterator[str]:
    length = f"{len(recording)} frames at {recording.fps:.4g} a second, {recording.seconds:.2f} s"
    yield f"recording: {length}, {len(recording.names)} joints"
    yield from recording.notes
    if not _RATES[0] <= recording.fps <= _RATES[1]:
        yield (
            f"warning: {recording.fps:.4g} frames a second is no rate of motion capture: give the right one with "
            "--recording-fps, e.g. --recording-fps 30"
        )
    if upright.mirrored:
        yield (
            "handedness: toes and knees point backwards, as in left-handed axes, or where names have left and right "
            "swapped: mirrored"
        )
    elif upright.mirrored is None:
        yield "handedness: right-handed axes assumed; it has no toes and no bent knees that would tell"
    if upright.dropped:
        yield f"left out at the start: a rest pose and the jump from it ({counted(upright.dropped, 'frame')})"
    yield (
        f"up: {upright.up}; unit: {upright.unit}"
        + (f", which makes the person {upright.height:.2f} m tall" if np.isfinite(upright.height) else "")
        + "; scaled by the legs"
    )
    usual = (upright.rest_up,) if recording.own_rest and upright.rest_up else ("y", "z")
    if upright.up not in usual:
        why = "as its rest pose does" if len(usual) == 1 else "as most programs have it"
        yield (
            f"warning: the person stands along {upright.up}, not {' or '.join(usual)}, {why}: taken for other axes and "
            "stood up; wrong for somebody who lies (look at --picture)"
        )
    if upright.straightened > 1:
        bent = f"{upright.straightened:.0f} degrees"
        yield f"elbows: bent by {bent} in its T-pose; taken as straight, as on Daz's figures"
    yield from _jumps(upright)
    left, right = _uneven(upright.at_rate(imported.clip.fps))
    if abs(left - right) > _UNEVEN:
        where = "above" if left > right else "below"
        yield (
            f"warning: uneven: the left foot stands {100 * abs(left - right):.0f} cm {where} the right one, in the "
            "recording; both are set down on one floor, so that hips and knees bend to reach it"
        )
    yield f"names: {names.convention}"
    yield from ("  " + line for line in names.lines())


def _jumps(upright: Upright) -> Iterator[str]:
    """Where a joint moves faster than anybody can: a fault of the recording."""
    recording, joints = upright.recording, list(upright.joints.values())
    _, positions = world(recording)
    speed = np.linalg.norm(np.diff(positions[:, joints], axis=0), axis=-1) * recording.fps
    fast = np.flatnonzero(speed.max(axis=1, initial=0) > _FASTEST)
    if len(fast):
        first, last = (upright.start + f / recording.fps for f in (fast[0], fast[-1]))
        joint = recording.names[joints[speed[fast[0]].argmax()]]
        yield (
            f"warning: jumps: {counted(len(fast), 'frame')} from {first:.2f} to {last:.2f} s, {joint} first, at up to "
            f"{speed.max():.0f} m/s: faults of the recording; --start and --stop cut them off, before anything else is "
            "made of it"
        )


def _uneven(upright: Upright) -> np.ndarray:
    """Height of the recording's left and right ankle while they stand [m], shape (2,)."""
    ankles = world(upright.recording)[1][:, [upright.joints["foot.L"], upright.joints["foot.R"]]]
    slow = np.linalg.norm(np.gradient(ankles, 1 / upright.recording.fps, axis=0), axis=-1) < 0.35
    return standing_height(ankles, slow)


def foot_slide_cm(clip: Clip, baked: BakedBody) -> float | None:
    """The most that a standing foot's lowest vertex moves along the ground from one frame to the next [cm]; None where
    no foot stands for two frames."""
    slides: list[float] = []
    for k, foot in enumerate(_feet(clip, baked)):
        lowest = foot[:-1, :, 2].argmin(axis=1)
        frames = np.arange(len(lowest))
        moved = np.linalg.norm((foot[frames + 1, lowest] - foot[frames, lowest])[:, :2], axis=1)
        slides += list(moved[clip.standing[1:, k] & clip.standing[:-1, k]])
    return 100 * max(slides) if slides else None


def foot_heights_cm(clip: Clip, baked: BakedBody) -> tuple[float, float] | None:
    """Lowest and highest that a standing foot's lowest vertex is [cm]; None where no foot stands."""
    heights = [foot[..., 2].min(axis=1)[clip.standing[:, k]] for k, foot in enumerate(_feet(clip, baked))]
    heights = np.concatenate(heights)
    return (100 * heights.min(), 100 * heights.max()) if len(heights) else None


def _feet(clip: Clip, baked: BakedBody) -> Iterator[np.ndarray]:
    """Vertices of the left and right foot [m], each shape (T, vertices, 3)."""
    for side in "LR":
        joints = [baked.joint_names.index(f"{name}.{side}") for name in ("foot", "toes")]
        yield pose_exact(baked, clip.rotations, clip.root, np.flatnonzero(baked.weights[:, joints].sum(axis=1) > 0.99))


def arms_inside(clip: Clip, baked: BakedBody) -> float:
    """Share of frames in which a vertex of a fore-arm or hand is more than 2 cm inside the rest of the body, from 0 to
    1.

    Of at most 60 frames, evenly spread. Upper arms don't count as the rest of the body: they hang on to the fore-arms.
    """
    from garmentbench.geometry.signed_distance import signed_distances

    chosen = np.unique(np.linspace(0, len(clip) - 1, _LOOKED_AT).round().astype(int))
    vertices = pose(baked, clip.rotations[chosen], clip.root[chosen])
    names = baked.body.part_names
    labels = baked.body.labels
    assert labels is not None, "a baked body has parts"
    arms = np.isin(labels, [names.index("fore_arm"), names.index("rear_arm")])
    fore_arms = labels == names.index("fore_arm")
    rest = baked.body.faces[~arms[baked.body.faces].any(axis=1)]
    distances = signed_distances(vertices[:, fore_arms], vertices, rest)
    return float((distances < -_INSIDE).any(axis=1).mean())


_COLUMNS, _ROWS = 8, 3
_TILE = (200, 290)


def contact_sheet(clip: Clip, baked: BakedBody, path: Path) -> None:
    """Draw 24 evenly spread frames of a clip into a PNG file, each with the body in the middle. Raises `UserError`."""
    from PIL import Image

    from garmentbench.viewing.render import RenderMesh, render

    clip = clip.from_origin(0)
    chosen = np.linspace(0, len(clip) - 1, _COLUMNS * _ROWS).round().astype(int)
    vertices = pose(baked, clip.rotations[chosen], clip.root[chosen] * [0.0, 0.0, 1.0])
    box = np.stack([vertices.min(axis=(0, 1)), vertices.max(axis=(0, 1))])
    tiles = [render([RenderMesh(v, baked.body.faces)], size=_TILE, focus=box) for v in vertices]
    rows = [np.concatenate(tiles[i : i + _COLUMNS], axis=1) for i in range(0, len(tiles), _COLUMNS)]
    with written_whole(path) as partial:
        Image.fromarray(np.concatenate(rows)).save(partial, format="PNG")
