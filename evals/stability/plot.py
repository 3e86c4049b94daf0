"""The ladder's plots: a heat map of who passes what, and survival curves."""

import math
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import StrMethodFormatter

from garmentbench.evals.stability.standing import Standing
from garmentbench.evals.stability.statistics import kaplan_meier
from garmentbench.report.plots import COLOURS, OTHERS, STYLE, svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SHARES = LinearSegmentedColormap.from_list("shares", ["#d6604d", "#fddbc7", "#d1e5f0", "#4393c3"])
EMPTY = "#f0f0f0"
OWN = {"simulator": "#444444", "XPBD": "#e69f00", "linear memory": "#0072b2", "tuned": "#000000"}
COLUMN, ROW = 0.95, 0.3  # of the heat map [inches]
PANEL = (3.5, 2.5)  # of the survival curves [inches]
ACROSS = 3  # panels
THIN, WIDER = 1.2, 0.9  # widths of the last curve and of each before it: where they coincide all can be seen


def heat_map(found: list[Standing]) -> bytes:
    """Starts passed of each method (columns) on each rung (rows). SVG."""
    rungs = list(dict.fromkeys(s.rung.title for s in found))
    labels = list(dict.fromkeys(s.label for s in found))
    shares = np.full((len(rungs), len(labels)), np.nan)
    look: dict[Any, Any] = STYLE | {"axes.grid": False}
    with matplotlib.rc_context(look):
        size = (COLUMN * len(labels) + 3.2, ROW * len(rungs) + 1.1)
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots()
        for s in found:
            y, x = rungs.index(s.rung.title), labels.index(s.label)
            shares[y, x] = s.passed / s.count
            text = f"{s.passed}/{s.count}"
            axes.text(x, y, text, ha="center", va="center", fontsize=8.5, color="#1a1a1a")
        axes.set_facecolor(EMPTY)
        axes.imshow(np.ma.masked_invalid(shares), cmap=SHARES, vmin=0, vmax=1, aspect="auto", interpolation="nearest")
        axes.set_xticks(range(len(labels)), [label.replace(" ", "\n") for label in labels])
        axes.set_yticks(range(len(rungs)), rungs)
        axes.tick_params(length=0, labeltop=True, labelbottom=False)
        for spine in axes.spines.values():
            spine.set_visible(False)
        axes.set_xticks(np.arange(len(labels) + 1) - 0.5, minor=True)
        axes.set_yticks(np.arange(len(rungs) + 1) - 0.5, minor=True)
        axes.grid(which="minor", color="white", linewidth=2)
        axes.tick_params(which="minor", length=0)
        return svg(figure)


def survival_plot(found: list[Standing]) -> bytes:
    """Share of starts that are whole over frames, a panel a kind of rung. SVG."""
    groups = list(dict.fromkeys(s.rung.group for s in found))
    labels = list(dict.fromkeys(s.label for s in found))
    others = iter(OTHERS * len(labels))
    colours = {label: OWN.get(label) or COLOURS.get(label) or next(others) for label in labels}
    across = min(ACROSS, len(groups))
    down = math.ceil(len(groups) / across)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(PANEL[0] * across, PANEL[1] * down + 0.6), layout="constrained")
        panels = figure.subplots(down, across, squeeze=False, sharey=True).ravel()
        for axes, group in zip(panels, groups, strict=False):
            axes.set_xscale("log")
            axes.xaxis.set_major_formatter(StrMethodFormatter("{x:,g}"))
            for k, label in enumerate(labels):
                starts = [start for s in found if (s.rung.group, s.label) == (group, label) for start in s.starts]
                if starts:
                    _draw(axes, starts, label, colours[label], THIN + WIDER * (len(labels) - 1 - k))
            axes.set(title=group, xlabel="predicted frames", ylim=(-0.04, 1.06))
        for axes in panels[len(groups) :]:
            axes.set_visible(False)
        for axes in panels[::across]:
            axes.set_ylabel("share whole")
        names = {
            name: handle for axes in panels for handle, name in zip(*axes.get_legend_handles_labels(), strict=True)
        }
        figure.legend(names.values(), names.keys(), loc="outside lower center", ncols=4, fontsize=9)
        return svg(figure)


def _draw(axes: "Axes", starts: list[dict[str, Any]], label: str, colour: str, width: float) -> None:
    """One curve: a step down where a start went bad, a cross where some came to their end."""
    frames = np.array([start["survived"] for start in starts])
    ended = np.array([start["first_bad_frame"] is not None for start in starts])
    steps, shares = kaplan_meier(frames, ended)
    last = max(int(frames.max()), 1)
    axes.step([*np.maximum(steps, 1), last], [*shares, shares[-1]], where="post", color=colour, label=label, lw=width)
    out = np.unique(frames[~ended])
    if len(out):
        at = shares[np.searchsorted(steps, out, side="right") - 1]
        axes.plot(np.maximum(out, 1), at, linestyle="none", marker="x", markersize=5, color=colour)
