"""Which pictures go with which table."""

from pathlib import Path
from typing import TYPE_CHECKING

from garmentbench.evals.convergence.plot import convergence_plot
from garmentbench.evals.convergence.table import CONVERGENCE, studies
from garmentbench.evals.crosscheck.table import CROSSCHECK
from garmentbench.evals.motions.plot import motions_plot
from garmentbench.evals.motions.table import MOTIONS, read_points
from garmentbench.evals.tables import STABILITY, STRESS, case
from garmentbench.report.lines import Line
from garmentbench.report.page import Picture
from garmentbench.report.plots import error_against_time, error_over_frames
from garmentbench.report.strips import frame_strip, stress_strip

if TYPE_CHECKING:
    import pandas

    from garmentbench.evaluation.excerpt import Material

FRAMES = (
    "Error of the free roll-out in each frame (thin) and over 30 frames (thick). A cross: it diverged or failed there."
)
TIME = (
    "Error of the whole roll-out against time a frame. Lower left is better; inside the shaded band, differences mean "
    "nothing."
)
STRIP = "Frames of the roll-outs: the reference above, below it what each method (first seed) made of it, coloured by its error."
LADDER = "The stress cases, each two thirds into the roll-out: the reference above, below it the methods, coloured by their error."
STEPS = (
    "Difference from the finest run against substeps (left) and run time (right); lines: what another start and a finer mesh "
    "change, and a third of the full model's error. The star is the chosen setting."
)
MAP = "Poses of all motions, nearest ones side by side (t-SNE). Large: what methods are trained on."
ENGINES = "Frames of {scene}: the reference above, below it the other engine, coloured by how far they are apart."


def all_pictures(
    name: str, results: "pandas.DataFrame", lines: list[Line], materials: dict[str, "Material"], runs_root: Path
) -> list[tuple[Picture, bytes]]:
    """The pictures that go with the table of that name, whose lines with runs are given."""
    if name == CONVERGENCE:
        return convergence_pictures(results)
    return motions_pictures(results, runs_root) if name == MOTIONS else pictures_of(name, lines, materials)


def convergence_pictures(results: "pandas.DataFrame") -> list[tuple[Picture, bytes]]:
    """The convergence study's plot, from results.csv alone: it shows the full model's error too."""
    return [(Picture(f"plots/{CONVERGENCE}.svg", STEPS), convergence_plot(studies(results)))]


def motions_pictures(results: "pandas.DataFrame", runs_root: Path) -> list[tuple[Picture, bytes]]:
    """The map of motions, from its run; none where it failed."""
    points = read_points(results, runs_root)
    return [(Picture(f"plots/{MOTIONS}.svg", MAP), motions_plot(points))] if points else []


def pictures_of(name: str, lines: list[Line], materials: dict[str, "Material"]) -> list[tuple[Picture, bytes]]:
    """The pictures of a table's lines, of which each has a run; none where there are no lines."""
    if not lines:
        return []
    if lines[0].experiment == STABILITY:
        by_scene = sorted(lines, key=lambda line: (line.scene.startswith(STRESS), line.scene))
        cases = {case(line): [other for other in lines if other.scene == line.scene] for line in by_scene}
        return [(Picture(f"strips/{name}.jpg", LADDER), stress_strip(cases, materials))]
    if lines[0].experiment == CROSSCHECK:
        as_it_is = [line for line in lines if line.variant == "full"]
        return [
            (
                Picture(f"strips/{name}-{line.scene}.jpg", ENGINES.format(scene=line.scene)),
                frame_strip([line], materials),
            )
            for line in as_it_is
        ]
    made = [(Picture(f"plots/{name}-frames.svg", FRAMES), error_over_frames(lines, materials))]
    if len({line.method for line in lines}) > 1:
        made.append((Picture(f"plots/{name}-time.svg", TIME), error_against_time(lines)))
    return [*made, (Picture(f"strips/{name}.jpg", STRIP), frame_strip(lines, materials))]
