"""The ladder's part of the report: a sentence a method, the heat map, survival curves, and every line."""

from typing import TYPE_CHECKING

from garmentbench.evals.stability.plot import heat_map, survival_plot
from garmentbench.evals.stability.standing import Standing, standings
from garmentbench.evals.stability.table import ladder_table, verdict_table
from garmentbench.report.page import Picture, Section
from garmentbench.report.strips import stress_strip

if TYPE_CHECKING:
    from garmentbench.report.lines import Results

HEAT = (
    "How many of the starts passed, a column a method or simulator, a row a rung. Blue: all of them; red: none. A rung "
    "that one doesn't climb is empty."
)
SURVIVAL = (
    "Share of the starts that are still whole after so many predicted frames (Kaplan and Meier), over all rungs of a "
    "kind. A cross: there starts came to their end whole. Curves that would hide each other are drawn a little below."
)
LADDER = (
    "Each rung two thirds into the roll-out of its worst start: the reference above, below it the others, coloured by "
    "their distance to it."
)
DRAWN = 10  # rungs that a strip has room for


def ladder_sections(results: "Results", name: str, title: str) -> list[Section]:
    """The sections of a ladder's lines in results.csv.

    Args:
        results: All results.
        name: Of the ladder's table.
        title: Of its part.
    """
    found = standings(results, name)
    lines = [standing.line for standing in found]
    ran = [standing for standing in found if standing.starts]
    pictures = []
    if ran:
        pictures = [
            Picture(f"plots/{name}-heat.svg", HEAT, heat_map(ran)),
            Picture(f"plots/{name}-survival.svg", SURVIVAL, survival_plot(ran)),
        ]
    return [
        Section(verdict_table(found, f"{name}-verdicts", title), pictures),
        Section(ladder_table(found, name, title), _strip(ran, name, results), lines=lines),
    ]


def _strip(ran: list[Standing], name: str, results: "Results") -> list[Picture]:
    """Pictures of every rung, where these are few."""
    cases: dict[str, list] = {}
    for standing in ran:
        if not standing.reference:
            cases.setdefault(standing.rung.title, []).append(standing.line)
    if not 0 < len(cases) <= DRAWN:
        return []
    return [Picture(f"strips/{name}.jpg", LADDER, stress_strip(cases, results.excerpt))]
