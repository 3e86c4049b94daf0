"""The Pareto plot of a scene: error against time a frame, dominated points grey, the spread as a band."""

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from garmentbench.evals.error_time.pareto import SIMULATOR, Point, dominated_by, front
from garmentbench.report.plots import FLOOR, MARKERS, OTHERS, STYLE, logarithmic, svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes

GREY, SIMULATED = "#b5b5b5", "#1d2329"
AWAY = tuple(itertools.product((10, 18, 28, 42, 58), (0, 45, -45, 180, 135, -135, 90, -90)))  # [points], [degrees]

STEPS = 40  # points of a line that names avoid, between two corners


def pareto_plot(points: Sequence[Point]) -> bytes:
    """Every point that has an error and a time; one that broke is a cross. SVG."""
    shown = sorted((p for p in points if math.isfinite(p.error) and math.isfinite(p.ms)), key=lambda p: (p.ms, p.error))
    methods = list(dict.fromkeys(p.method for p in sorted(shown, key=lambda p: p.method)))
    colours = dict(zip(methods, itertools.cycle(OTHERS))) | {SIMULATOR: SIMULATED}
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(10.5, 6.4), layout="constrained")
        axes = figure.subplots()
        logarithmic(axes.xaxis)
        logarithmic(axes.yaxis)
        for p in shown:
            grey = not p.competes or dominated_by(p, shown) is not None
            marker = MARKERS[methods.index(p.method) % len(MARKERS)] if p.competes else "x"
            look = {"color": GREY if grey else colours[p.method], "zorder": 2 if grey else 4}
            axes.errorbar(p.ms, p.error, yerr=p.interval, marker=marker, markersize=6 if grey else 9, capsize=3, **look)
        _curve(axes, front([p for p in shown if p.of_simulator]), "the simulator's budgets", ":")
        _curve(axes, front(shown), "nothing is better", "-")
        axes.margins(x=0.2, y=0.12)  # names stand beside the outermost points, too
        clock = "processor time" if any(p.loaded for p in points) else "time"
        axes.set(xlabel=f"{clock} a frame [ms]", ylabel="error [cm]")
        spread = next((p.spread for p in shown if math.isfinite(p.spread)), math.nan)
        if math.isfinite(spread):
            low, high = axes.get_ylim()
            low = min(low, 0.8 * spread)
            axes.axhspan(low, spread, color=FLOOR, zorder=0, label=f"what another run errs by, {spread:.2g} cm")
            axes.set_ylim(low, high)
        axes.legend(loc="upper right", fontsize=9)
        _name(figure, axes, shown)
        return svg(figure)


def _curve(axes: "Axes", points: Sequence[Point], label: str, dashes: str) -> None:
    axes.plot([p.ms for p in points], [p.error for p in points], dashes, color=SIMULATED, lw=1.1, zorder=1, label=label)


def _along(corners: np.ndarray) -> np.ndarray:
    """Points along a line through corners, shape (N, 2), in pixels: names are not to stand on it."""
    parts = [np.linspace(a, b, STEPS) for a, b in itertools.pairwise(corners)]
    return np.concatenate(parts) if parts else corners


def _name(figure: Figure, axes: "Axes", points: Sequence[Point]) -> None:
    """Write every point's name beside it where nothing is yet, those that nothing dominates first."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # where things are stays as it is from here on
    places = axes.transData.transform([(p.ms, p.error) for p in points])
    scale = figure.dpi / 72
    taken = [Bbox.from_bounds(x - 5 * scale, y - 5 * scale, 10 * scale, 10 * scale) for x, y in places]
    taken += [
        Bbox.from_bounds(x - scale, y - scale, 2 * scale, 2 * scale)
        for line in (front([p for p in points if p.of_simulator]), front(points))
        for x, y in _along(axes.transData.transform([(p.ms, p.error) for p in line] or np.zeros((0, 2))))
    ]
    legend = axes.get_legend()
    taken += [] if legend is None else [legend.get_window_extent(renderer)]
    room = axes.get_window_extent(renderer)
    for k in sorted(range(len(points)), key=lambda k: dominated_by(points[k], points) is not None):
        p, tried = points[k], []
        grey = not p.competes or dominated_by(p, points) is not None
        for distance, angle in AWAY:
            x, y = distance * math.cos(math.radians(angle)), distance * math.sin(math.radians(angle))
            side = "left" if x > 1 else "right" if x < -1 else "center"
            text = axes.annotate(
                p.label, (p.ms, p.error), (x, y), textcoords="offset points", ha=side, va="center", fontsize=7.5,
                color="#8a8a8a" if grey else SIMULATED, zorder=5,
                arrowprops={"arrowstyle": "-", "color": "#cccccc", "lw": 0.6} if distance > AWAY[0][0] else None,
            )  # fmt: skip
            text.update_positions(renderer)
            box = Text.get_window_extent(text, renderer)  # without the line that leads to it
            hidden = sum(box.overlaps(other) for other in taken)
            outside = box.x0 < room.x0 or box.x1 > room.x1 or box.y0 < room.y0 or box.y1 > room.y1
            text.remove()
            cost = hidden + 10 * outside
            tried.append((cost, text, box))
            if cost == 0:
                break
        _, text, box = min(tried, key=lambda place: place[0])
        axes.add_artist(text)
        taken.append(box)
