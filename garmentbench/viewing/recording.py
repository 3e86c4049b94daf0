"""Writing a recording.

Positions are rounded to 2^-13 m (0.12 mm), so that they compress. At most `COORDINATES` are kept: a roll-out too long
for that is recorded every second frame, and of these only the first ones; the text panel says which. The curves of
error and time hold every frame. A laptop roll-out of 1,150 frames (1.5k garment, 3.5k body vertices) makes 35 MB.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import rerun as rr

from garmentbench.evaluation.rollout import RollOut
from garmentbench.geometry.mesh import corner_matrix, vertex_normals
from garmentbench.method import PARTS
from garmentbench.metrics.interpenetration import inside_vertices
from garmentbench.metrics.l2 import frame_l2
from garmentbench.sequence import Sequence
from garmentbench.storage.atomic import written_whole
from garmentbench.viewing.recording_layout import TIMELINE, about, blueprint, side_by_side
from garmentbench.viewing.render import CLOTH, SKIN, error_colours

ROUNDING = 2.0**-13  # [m]
COORDINATES = 12_000_000
RED, BLUE, GREY = (230, 60, 60), (50, 110, 235), (160, 160, 160)
_BLOCK = 30  # frames sent at a time
_LIGHT = np.array([-0.45, -0.70, 0.55], np.float32)  # towards the light: before the body, above, on its right


def recorded_frames(start: int, stop: int, vertices: int) -> range:
    """Which frames from `start` to before `stop` are recorded, when `vertices` vertices are drawn in each."""
    kept = max(1, COORDINATES // (3 * vertices))
    return range(start, stop) if stop - start <= kept else range(start, min(stop, start + 2 * kept), 2)


def write_recording(path: Path, sequence: Sequence, roll_out: RollOut, title: str) -> None:
    """Write the recording of a roll-out, whole or not at all.

    Args:
        path: The .rrd file.
        sequence: The reference.
        roll_out: What a method made of it; from its first bad frame on nothing of it is drawn.
        title: What is shown, e.g. "motion_guided on tshirt-armspace-90".

    Raises:
        UserError: The file can't be written.
    """
    body, template = sequence.body, sequence.template
    drawn = 2 * sequence.garment.shape[1] + (0 if body is None else body.shape[1])
    frames = np.array(recorded_frames(roll_out.start, len(sequence), drawn))
    good = roll_out.start + np.flatnonzero(np.isfinite(roll_out.garment[roll_out.start :]).all(axis=(1, 2)))
    shown = np.intersect1d(frames, good)
    with written_whole(path) as partial:
        stream = rr.RecordingStream("garmentbench", send_properties=False)
        recorded = stream.binary_stream()  # in memory: Rerun's own file writer may hang when a disk is full
        stream.send_blueprint(blueprint(sequence))
        stream.send_recording_name(title)
        stream.log("about", about(title, sequence, roll_out, frames), static=True)
        _place(stream, sequence, frames)
        _mesh(stream, "scene/reference", template.garment.faces, sequence.garment, frames, lambda _: CLOTH)
        _mesh(
            stream, "scene/prediction", template.garment.faces, roll_out.garment, shown, _colours_of(roll_out, sequence)
        )
        if body is not None:
            _mesh(stream, "scene/body", template.required_body.faces, body, frames, lambda _: SKIN)
        if template.needs.interpenetration and len(shown):
            _penetration(stream, sequence, roll_out, shown)
        _curve(stream, "error/mean", good, frame_l2(roll_out.garment[good], sequence.garment[good]), BLUE)
        for part, ms, colour in zip(PARTS, roll_out.ms.T, (GREY, BLUE, RED), strict=True):
            _curve(stream, f"ms/{part}", good, ms[good], colour)
        if len(shown) < len(frames):
            stream.set_time(TIMELINE, sequence=int(frames[len(shown)]))
            stream.log("scene/prediction", rr.Clear(recursive=True))
        partial.write_bytes(recorded.read() or b"")


def _colours_of(roll_out: RollOut, sequence: Sequence) -> Callable[[np.ndarray], np.ndarray]:
    """The prediction's colours in given frames, shape (frames, V, 3), by its error."""

    def colours(frames: np.ndarray) -> np.ndarray:
        return error_colours(100.0 * np.linalg.norm(roll_out.garment[frames] - sequence.garment[frames], axis=2))

    return colours


def _place(stream: rr.RecordingStream, sequence: Sequence, frames: np.ndarray) -> None:
    """Keep what walks in view by a moving frame (positions stay those of the world), and draw the body twice."""
    stream.log("/", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    centres = sequence.garment[frames].mean(axis=1) * [1.0, 1.0, 0.0]
    stream.send_columns("scene", [_times(frames)], rr.Transform3D.columns(translation=-centres))
    left, right = side_by_side(sequence)
    stream.log("scene/reference", rr.Transform3D(translation=left), static=True)
    stream.log("scene/prediction", rr.Transform3D(translation=right), static=True)
    if sequence.body is not None:
        stream.log("scene/body", rr.InstancePoses3D(translations=[left, right]), static=True)


def _mesh(
    stream: rr.RecordingStream,
    entity: str,
    faces: np.ndarray,
    positions: np.ndarray,
    frames: np.ndarray,
    colours: Callable[[np.ndarray], np.ndarray | tuple[float, float, float]],
) -> None:
    """Send a moving mesh in the given frames. `colours` gives their sRGB colours, shape (3,) or (frames, V, 3).

    Shading is worked into the colours: normals, by which the viewer would shade, would double the file.
    """
    count = positions.shape[1]
    corners = corner_matrix(faces, count)
    stream.log(entity, rr.Mesh3D.from_fields(triangle_indices=faces), static=True)
    for block in np.split(frames, range(_BLOCK, len(frames), _BLOCK)) if len(frames) else []:
        rounded = np.round(positions[block] / np.float32(ROUNDING)) * np.float32(ROUNDING)
        light = 0.75 + 0.25 * vertex_normals(rounded, faces, corners) @ (_LIGHT / np.linalg.norm(_LIGHT))
        rgba = _packed(np.asarray(colours(block)) * light[..., None])
        columns = rr.Mesh3D.columns(vertex_positions=rounded.reshape(-1, 3), vertex_colors=rgba.ravel())
        stream.send_columns(entity, [_times(block)], [c.partition(np.full(len(block), count)) for c in columns])


def _packed(colours: np.ndarray) -> np.ndarray:
    """sRGB in [0, 1], shape (..., 3), as 0xRRGGBBAA, shape (...)."""
    r, g, b = np.moveaxis(np.round(255.0 * np.clip(colours, 0.0, 1.0)).astype(np.uint32), -1, 0)
    return (r << 24) | (g << 16) | (b << 8) | 255


def _penetration(stream: rr.RecordingStream, sequence: Sequence, roll_out: RollOut, shown: np.ndarray) -> None:
    """Mark the prediction's vertices inside the body, and give their share, in the frames that are drawn."""
    garment = roll_out.garment[shown]
    inside = inside_vertices(garment, sequence.body_positions[shown], sequence.template.required_body.faces)
    points = rr.Points3D.columns(positions=garment[inside]).partition(inside.sum(axis=1))
    stream.log("scene/prediction/inside", rr.Points3D.from_fields(colors=BLUE, radii=0.006), static=True)
    stream.send_columns("scene/prediction/inside", [_times(shown)], points)
    _curve(stream, "penetration/prediction", shown, 100.0 * inside.mean(axis=1), RED)


def _curve(stream: rr.RecordingStream, entity: str, frames: np.ndarray, values: np.ndarray, colour: tuple) -> None:
    stream.log(entity, rr.SeriesLines(colors=colour, widths=1.5), static=True)
    stream.send_columns(entity, [_times(frames)], rr.Scalars.columns(scalars=values))


def _times(frames: np.ndarray) -> rr.TimeColumn:
    return rr.TimeColumn(TIMELINE, sequence=frames)
