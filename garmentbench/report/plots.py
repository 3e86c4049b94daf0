"""The plots: error over frames, and error against run time. SVG, the same bytes every time."""

import io
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from garmentbench.report.lines import Line

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes

    from garmentbench.evaluation.excerpt import Excerpt

COLOURS = {
    "another run": "#444444",
    "skinning": "#8c8c8c",
    "hold": "#56b4e9",
    "constant velocity": "#cc79a7",
    "linear subspace": "#009e73",
    "motion-guided": "#d55e00",
}
OTHERS = ("#0072b2", "#e69f00", "#000000", "#7b4fb5", "#a6761d", "#1b9e9e", "#e7298a", "#66a61e")
MARKERS = "osD^vPX*<>"
STYLE: dict[Any, Any] = {
    "svg.hashsalt": "garmentbench",  # else element ids differ from run to run
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e6e6e6",
    "legend.frameon": False,
}
FLOOR = "#f1e9cf"
DECADES = 3_000.0  # between an axis's ends, from which on its ticks are powers of ten
SMOOTHED = 30  # frames; a walk's cycle is about as long


def style(lines: list[Line]) -> dict[str, tuple[str, str]]:
    """Colour and marker of each line's label; the same method has the same colour in every plot."""
    others = iter(OTHERS * len(lines))
    return {
        line.label: (COLOURS[line.label] if line.label in COLOURS else next(others), MARKERS[i % len(MARKERS)])
        for i, line in enumerate(lines)
    }


def error_over_frames(lines: list[Line], excerpt: "Callable[[str], Excerpt]") -> bytes:
    """Mean error of each frame of the roll-outs, on a logarithmic scale; a cross where one ended early."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(9, 3.8), layout="constrained")
        axes = figure.subplots()
        looks = style(lines)
        for line in lines:
            for run in line.run_ids:
                _draw_error(axes, excerpt(run), line.label if run == line.run_ids[0] else None, looks[line.label][0])
        logarithmic(axes.yaxis)
        _floor(axes, lines)
        axes.set(xlabel="frame", ylabel="mean error [cm]")
        axes.margins(x=0.01)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        return svg(figure)


def _draw_error(axes: "Axes", excerpt: "Excerpt", name: str | None, colour: str) -> None:
    error = excerpt.error_cm[np.isfinite(excerpt.error_cm)]
    frames = int(excerpt.start) + np.arange(len(error))
    if len(error) > 4 * SMOOTHED:
        axes.plot(frames, error, color=colour, linewidth=0.5, alpha=0.3)
        smooth = np.convolve(error, np.full(SMOOTHED, 1 / SMOOTHED), mode="valid")
        middle = slice(SMOOTHED // 2, SMOOTHED // 2 + len(smooth))
        axes.plot(frames[middle], smooth, color=colour, linewidth=1.8, label=name)
    else:
        axes.plot(frames, error, color=colour, linewidth=1.6, label=name)
    if len(error) < len(excerpt.error_cm):
        at = (frames[-1], error[-1]) if len(error) else (int(excerpt.start), 1.0)
        cross = {"marker": "x", "markersize": 9, "markeredgewidth": 2.5, "linestyle": "none"}
        axes.plot(*at, color=colour, label=None if len(error) else name, **cross)


def error_against_time(lines: list[Line]) -> bytes:
    """Roll-out error against time a frame, both logarithmic, with intervals over the seeds.

    The simulator's time too.
    """
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(9, 4.2), layout="constrained")
        axes = figure.subplots()
        looks = style(lines)
        for line in lines:
            error, ms = line.value("rollout_l2"), line.value("ms_per_frame")
            if error is None or ms is None or not (np.isfinite(error.mean) and np.isfinite(ms.mean)):
                continue
            colour, marker = looks[line.label]
            axes.errorbar(
                ms.mean,
                error.mean,
                yerr=error.interval,
                xerr=ms.interval,
                color=colour,
                marker=marker,
                markersize=9,
                markeredgecolor="white",
                linestyle="none",
                capsize=3,
                label=line.label,
                zorder=3,
            )
        logarithmic(axes.xaxis)
        logarithmic(axes.yaxis)
        axes.margins(0.1)
        axes.autoscale_view()
        _floor(axes, lines)
        simulator = [
            v.reference for v in (line.value("ms_per_frame") for line in lines) if v and np.isfinite(v.reference)
        ]
        if simulator:
            axes.axvline(
                simulator[0], color="#555555", linestyle=":", linewidth=1.2, label="the reference simulator's time"
            )
        axes.set(xlabel="time a frame [ms]", ylabel="roll-out error [cm]")
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        return svg(figure)


def logarithmic(axis) -> None:
    """A logarithmic axis whose ticks say 0.5, 1, 2, 5; of many decades powers of ten alone, since more would touch."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    class Ticks(LogLocator):
        def tick_values(self, vmin: float, vmax: float) -> Any:
            self.set_params(subs=(1.0, 2.0, 5.0) if vmax < DECADES * vmin else (1.0,))
            return super().tick_values(vmin, vmax)

    axis.axes.set(**{f"{axis.axis_name}scale": "log"})
    axis.set_major_locator(Ticks(numticks=12))
    axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axis.set_minor_formatter(NullFormatter())


def _floor(axes: "Axes", lines: list[Line]) -> None:
    """The spread, shaded: below it errors mean nothing."""
    known = [v.spread for v in (line.value("rollout_l2") for line in lines) if v and np.isfinite(v.spread)]
    low, high = axes.get_ylim()
    if known:
        low = min(low, 0.6 * known[0])
        axes.axhspan(
            low, known[0], color=FLOOR, zorder=0, label=f"the spread of the reference's runs, {known[0]:.2g} cm"
        )
    axes.set_ylim(low, 1.15 * high)


def svg(figure: Figure) -> bytes:
    """A figure as SVG, the same bytes every time."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    return buffer.getvalue()
