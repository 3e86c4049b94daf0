"""The convergence study's plot: a row of two a scene, error against substeps and against run time, both logarithmic."""

from typing import TYPE_CHECKING

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from garmentbench.evals.convergence.table import CHOSEN, PART_OF_ERROR, ROUNDING, SUBSTEPS, SceneStudy
from garmentbench.report.plots import STYLE, logarithmic, svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ERROR = "#0072b2"
LEVELS = {  # horizontal lines: variant -> name, colour, line style
    "start_1mm": ("start pushed by 1 mm", "#009e73", "--"),
    "start_1cm": ("start pushed by 1 cm", "#009e73", ":"),
    "mesh_fine": ("finer mesh", "#cc79a7", "-."),
    ROUNDING: ("start pushed by a micrometre: rounding", "#8c8c8c", ":"),
}
BOUND = "#d55e00"
WIDTH, HEIGHT = 10.5, 2.9  # of a row [inches]


def convergence_plot(found: list[SceneStudy]) -> bytes:
    """Error in the step of each scene's reference, beside what its start and its mesh change. SVG."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, HEIGHT * len(found) + 0.4), layout="constrained")
        rows = figure.subplots(len(found), 2, squeeze=False, sharey="row")
        for study, (left, right) in zip(found, rows, strict=True):
            _draw(left, study, {v: study.mean(v, "substeps") for v in SUBSTEPS}, "substeps a frame")
            _draw(right, study, {v: study.mean(v, "ms_per_frame") for v in SUBSTEPS}, "time a frame [ms]")
            left.set(ylabel="difference [cm]", title=study.scene)
        names = {
            name: handle for axes in rows.flat for handle, name in zip(*axes.get_legend_handles_labels(), strict=True)
        }
        figure.legend(names.values(), names.keys(), loc="outside lower center", ncols=4, fontsize=9)
        return svg(figure)


def _draw(axes: "Axes", study: SceneStudy, places: dict[str, float], label: str) -> None:
    """One picture: the runs with other steps at their places along the x axis; the chosen one has a star."""
    x, y = np.array([(places[v], study.mean(v)) for v in SUBSTEPS]).T
    known = np.isfinite(x) & np.isfinite(y) & (y > 0)
    logarithmic(axes.xaxis)
    logarithmic(axes.yaxis)
    axes.plot(x[known], y[known], "o-", color=ERROR, label="step, against 8 times the substeps")
    if known[0]:
        axes.plot(
            places[CHOSEN],
            study.mean(CHOSEN),
            "*",
            color=ERROR,
            markersize=17,
            markeredgecolor="white",
            zorder=4,
            label="the chosen setting",
        )
    for variant, (name, colour, dashes) in LEVELS.items():
        if study.mean(variant) > 0:
            axes.axhline(study.mean(variant), color=colour, linestyle=dashes, linewidth=1.4, label=name)
    if study.model_error > 0:
        axes.axhline(
            PART_OF_ERROR * study.model_error, color=BOUND, linewidth=1.4, label="a third of the full model's error"
        )
    axes.set_xlabel(label)
    axes.margins(0.1)
