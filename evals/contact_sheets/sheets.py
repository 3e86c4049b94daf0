"""The sheets: the rows of a garment's pictures below one another, each with its scene's name."""

import io
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from garmentbench.errors import UserError
from garmentbench.evals.contact_sheets.table import FRAME, NAME, ROW
from garmentbench.report.lines import Line
from garmentbench.report.page import Picture

ROWS = 8  # of a sheet, at most
TITLE = 26  # room for a row's title [pixels]
DPI = 100
CAPTION = "{}: from the front, one side, the back and the other side, each in the frame in which the cloth moves most."


def sheets(lines: list[Line], runs: Path) -> list[Picture]:
    """A picture or more of each garment on each body. Raises `UserError` where a run is missing."""
    groups: dict[str, list[Line]] = {}
    for line in sorted((line for line in lines if line.run_ids), key=lambda line: line.scene):
        body = str(line.rows.body.iloc[0])
        known = line.garment if body in ("base", "stick", "") else f"{line.garment}-{body}"
        groups.setdefault(known, []).append(line)
    return [
        Picture(_file(name, i), CAPTION.format(_words(name)), _sheet(found[i : i + ROWS], runs))
        for name, found in groups.items()
        for i in range(0, len(found), ROWS)
    ]


def _file(name: str, first: int) -> str:
    page = f"-{1 + first // ROWS}" if first else ""
    return f"{NAME}/{name}{page}.webp"


def _words(name: str) -> str:
    garment, _, body = name.partition("-")
    return garment.replace("_", " ") + (f" on the {body} body" if body else "")


def _sheet(lines: list[Line], runs: Path) -> bytes:
    """Rows of pictures with their titles. A WebP: of the size of a JPEG that blurs folds, it keeps them."""
    pictures = [_row(runs / line.run_ids[0] / ROW) for line in lines]
    width, height = pictures[0].shape[1], sum(TITLE + len(picture) for picture in pictures)
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI)
    canvas, below = FigureCanvasAgg(figure), height
    for line, picture in zip(lines, pictures, strict=True):
        shown = line.value(FRAME)
        title = f"{line.scene}, frame {shown.mean:.0f}" if shown is not None else line.scene
        figure.text(8 / width, (below - TITLE / 2) / height, title, va="center", fontsize=10, fontweight="bold")
        below -= TITLE + len(picture)
        figure.figimage(picture, 0, below)
    canvas.draw()
    buffer = io.BytesIO()
    Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3]).save(buffer, "WEBP", quality=85, method=6)
    return buffer.getvalue()


def _row(path: Path) -> np.ndarray:
    if not path.is_file():
        raise UserError(f"{path}: named in results.csv, but missing; `garmentbench evals contact-sheets` makes it")
    with Image.open(path) as picture:
        return np.asarray(picture)
