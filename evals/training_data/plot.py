"""Error against the number of training frames."""

from typing import TYPE_CHECKING

import matplotlib
from matplotlib.figure import Figure

from garmentbench.evals.training_data.table import curves
from garmentbench.evaluation.another_run import ANOTHER_RUN
from garmentbench.report.plots import STYLE, logarithmic, style, svg

if TYPE_CHECKING:
    from garmentbench.report.lines import Line


def error_against_frames(lines: "list[Line]") -> bytes:
    """Panels side by side, one a test scene, both axes logarithmic. SVG."""
    scenes = list(dict.fromkeys(line.scene for line in lines))
    labels = sorted({label for scene in scenes for label in curves(lines, scene)})
    looks = style([next(line for line in lines if line.label == label) for label in labels])
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(4.6 * len(scenes) + 1.8, 4.0), layout="constrained")
        for axes, scene in zip(figure.subplots(1, len(scenes), squeeze=False)[0], scenes, strict=True):
            for label, points in curves(lines, scene).items():
                frames, error, half = zip(*points, strict=True)
                colour, marker = looks[label]
                axes.errorbar(
                    frames,
                    error,
                    yerr=half,
                    color=colour,
                    marker=marker,
                    capsize=3,
                    label=label,
                )
            spread = [line.value("rollout_l2") for line in lines if (line.scene, line.method) == (scene, ANOTHER_RUN)]
            for value in filter(None, spread):
                axes.axhline(value.mean, color="#444444", linestyle="--", linewidth=1.2, label="another run")
            logarithmic(axes.xaxis)
            logarithmic(axes.yaxis)
            axes.set(xlabel="training frames", ylabel="roll-out error [cm]", title=scene)
        handles = {
            label: handle for a in figure.axes for handle, label in zip(*a.get_legend_handles_labels(), strict=True)
        }
        figure.legend(handles.values(), handles.keys(), loc="outside right center")
        return svg(figure)
