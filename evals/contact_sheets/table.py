"""The table beside the sheets: which frames they show, and what the metrics find wrong in these."""

from garmentbench.report.cells import value_cell
from garmentbench.report.lines import Line
from garmentbench.report.table import Cell, Table

NAME = "contact_sheets"  # of the experiment's table, of its runs, and of the folder of its pictures
ROW = "row.png"  # in a run's folder: a sequence's pictures side by side
FRAME = "frame_shown"
COUNTS = {FRAME: "frames", "crossing_faces": "faces", "skin_through": "points"}  # what a row is about, and its unit


def sheets_table(lines: list[Line], title: str) -> Table:
    """Which frames are shown, and what the metrics find wrong in them."""
    titles = ["frame shown", "faces through others", "points with skin through"]
    cells = [[value_cell(line.value(name), whole=True) for name in COUNTS] for line in lines]
    rows = [[Cell(line.scene), *counts] for line, counts in zip(lines, cells, strict=True)]
    return Table(
        NAME,
        title,
        "All sequences that are tested on, seen from four sides, so that a hole, a crack or skin can't hide. The "
        "counts are of the frame that is shown: faces of the garment that cross others, and middles of its edges and "
        "faces through which what it is worn on comes by more than 0.5 mm.",
        ["scene", *titles],
        sorted(rows, key=lambda row: row[0].text),
    )
