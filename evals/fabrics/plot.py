"""Pictures of draped discs: from above, as the test's shadow, and from the side."""

from typing import TYPE_CHECKING

import matplotlib
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

from garmentbench.evals.validation.drape import TABLE
from garmentbench.report.plots import STYLE, svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CLOTH, DARK = np.array([0.0, 0.447, 0.698]), 0.25
LIGHT = np.array([0.3, -0.5, 0.8])
ELEVATION = np.radians(20.0)
REACH = 0.16  # [m] that is shown


def drapes_plot(draped: dict[str, tuple[np.ndarray, np.ndarray]]) -> bytes:
    """A column a fabric: its positions [m], shape (V, 3), and faces, (F, 3). SVG."""
    with matplotlib.rc_context({**STYLE, "axes.grid": False}):
        figure = Figure(figsize=(2.1 * len(draped), 3.4), layout="constrained")
        rows = figure.subplots(2, len(draped), squeeze=False)
        for (above, side), (name, (positions, faces)) in zip(rows.T, draped.items(), strict=True):
            _paint(above, *_from_above(positions), positions, faces)
            above.set(xlim=(-REACH, REACH), ylim=(-REACH, REACH), title=name.replace("_", " "))
            _paint(side, *_from_the_side(positions), positions, faces)
            for axes, flat in ((above, 1.0), (side, np.sin(ELEVATION))):
                axes.add_patch(Ellipse((0, 0), 2 * TABLE, 2 * TABLE * flat, facecolor="#dfe3e6", zorder=3))
            side.set(xlim=(-REACH, REACH), ylim=(-0.1, 0.07))
        return svg(figure)


def _from_above(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return x[:, :2], x[:, 2]


def _from_the_side(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """From a little above."""
    c, s = np.cos(ELEVATION), np.sin(ELEVATION)
    return np.column_stack([x[:, 0], c * x[:, 2] + s * x[:, 1]]), s * x[:, 2] - c * x[:, 1]


def _paint(axes: "Axes", points: np.ndarray, depth: np.ndarray, x: np.ndarray, faces: np.ndarray) -> None:
    """Triangles from back to front, shaded by a light."""
    a, b, c = x[faces].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    shade = 0.35 + 0.65 * np.abs(normal @ LIGHT / np.linalg.norm(LIGHT))
    order = np.argsort(depth[faces].mean(axis=1))
    colours = CLOTH * shade[order, None] + DARK * (1 - shade[order, None])
    triangles = list(points[faces[order]])
    axes.add_collection(PolyCollection(triangles, facecolors=colours, edgecolors=colours, linewidths=0.3))
    axes.set(aspect="equal", xticks=[], yticks=[])
    axes.set_frame_on(False)
