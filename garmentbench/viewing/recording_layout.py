"""How a recording opens: 3D view on the left, curves over time on the right, a text that says what is shown."""

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from garmentbench.evaluation.rollout import OK, RollOut
from garmentbench.sequence import Sequence
from garmentbench.viewing.render import ERROR_SCALE_CM

TIMELINE = "frame"


def side_by_side(sequence: Sequence) -> tuple[list[float], list[float]]:
    """Where reference and prediction are drawn: translations [m]."""
    half = 0.65 * _size(sequence)[0]
    return [-half, 0.0, 0.0], [half, 0.0, 0.0]


def _size(sequence: Sequence) -> np.ndarray:
    """The first frame's width, bottom and top [m]."""
    points = np.concatenate([sequence.garment[0]] + ([] if sequence.body is None else [sequence.body[0]]))
    return np.array([np.ptp(points[:, :2], axis=0).max(), points[:, 2].min(), points[:, 2].max()])


def blueprint(sequence: Sequence) -> rrb.Blueprint:
    """The layout that a recording of `sequence` opens with."""
    width, bottom, top = _size(sequence).tolist()
    middle = 0.5 * (bottom + top)
    away = 1.5 * max(2.3 * width, top - bottom)
    position = (0.35 * away, -away, middle + 0.2 * away)
    eye = rrb.EyeControls3D(position=position, look_target=(0.0, 0.0, middle), eye_up=(0, 0, 1))
    scene = rrb.Spatial3DView(
        origin="/",  # not "scene": a view does not see its own origin move
        contents="scene/**",
        name="reference (left), prediction (right)",
        eye_controls=eye,
        background=(250, 250, 250),
        line_grid=rrb.LineGrid3D(visible=True, plane=rr.components.Plane3D((0, 0, 1), bottom), color=(0, 0, 0, 40)),
    )
    curves = [_curves("error", "error [cm]"), _curves("ms", "time a frame [ms]")]
    if sequence.template.needs.interpenetration:
        curves.insert(1, _curves("penetration", "interpenetration [%]"))
    about = rrb.TextDocumentView(origin="about", name="what is shown")
    return rrb.Blueprint(
        rrb.Horizontal(scene, rrb.Vertical(about, *curves, row_shares=[3] + [4] * len(curves)), column_shares=[2, 1]),
        rrb.TimePanel(timeline=TIMELINE, fps=sequence.template.fps, state="collapsed"),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
    )


def _curves(entity: str, name: str) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(origin=entity, name=name, plot_legend=rrb.Corner2D.RightTop)


def about(title: str, sequence: Sequence, roll_out: RollOut, frames: np.ndarray) -> rr.TextDocument:
    """The text panel. `frames`: those that are drawn."""
    ending = "" if roll_out.status == OK else f" at frame {roll_out.first_bad_frame}: {roll_out.message}"
    predicted = len(sequence) - roll_out.start
    step = f" (every second one, to frame {frames[-1]})" if len(frames) < predicted else ""
    lines = [
        f"# {title}",
        "",
        f"Status: **{roll_out.status}**{ending}",
        "",
        f"- Left: reference. Right: prediction, its error as colour: pale 0, dark red {ERROR_SCALE_CM:g} cm or more.",
        f"- Frames {roll_out.start} to {len(sequence) - 1}; drawn: {len(frames)} of {predicted}{step}.",
        "- The view moves with the garment; positions in the file are those of the world, rounded to 2^-13 m.",
    ]
    if sequence.template.needs.interpenetration:
        lines.append("- Blue points: vertices behind the tangent plane of the nearest body vertex.")
    return rr.TextDocument("\n".join(lines), media_type="text/markdown")
