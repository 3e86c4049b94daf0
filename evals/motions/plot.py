"""The map of motions, in the manner of figure 5 of the paper."""

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from garmentbench.evals.motions.table import TRAINED
from garmentbench.report.plots import MARKERS, STYLE, svg

LARGE_COLOURS = ("#1d2329", "#d55e00")
COLOURS = (
    "#56b4e9",
    "#0072b2",
    "#009e73",
    "#66a61e",
    "#7b4fb5",
    "#cc79a7",
    "#e7298a",
    "#e69f00",
    "#a6761d",
    "#8c8c8c",
)


def motions_plot(points: dict[str, tuple[str, np.ndarray]]) -> bytes:
    """Poses on the plane, one colour a motion; the two that the table measures from are large, and underneath. SVG.

    Args:
        points: Each motion's split and points, shape (poses, 2).
    """
    with matplotlib.rc_context({**STYLE, "axes.grid": False}):
        figure = Figure(figsize=(9, 5.6), layout="constrained")
        axes = figure.subplots()
        for large, colours, look in (
            (True, LARGE_COLOURS, {"s": 60, "alpha": 0.35, "linewidths": 0}),
            (False, COLOURS, {"s": 16, "alpha": 0.9, "linewidths": 0}),
        ):
            found = [(name, *point) for name, point in points.items() if (name in TRAINED) == large]
            for k, (name, split, plane) in enumerate(found):
                marker = "o" if large else MARKERS[k % len(MARKERS)]
                label = f"{name} ({split})"
                axes.scatter(*plane.T, color=colours[k % len(colours)], marker=marker, label=label, **look)
        axes.set(xticks=[], yticks=[])
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        return svg(figure)
