"""Strips of frames: the reference in the first row, below it what each method made of it, coloured by its error."""

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from garmentbench.report.lines import Line
from garmentbench.viewing.render import CLOTH, ERROR_COLOURS, ERROR_SCALE_CM, RenderMesh, error_colours, render

if TYPE_CHECKING:
    from collections.abc import Callable

    from garmentbench.evaluation.excerpt import Excerpt

WIDTH, HEIGHT = 170, 210  # of one picture [pixels]
LEFT, TOP, BOTTOM = 150, 26, 62  # room for words [pixels]
DPI = 100
AROUND = 0.10  # what is seen around the garment [m]
STRESS_COLUMN = 3  # which of the frames drawn is shown of each stress case


@dataclass(frozen=True)
class Shot:
    """One picture: frame number `column` of a roll-out's excerpt.

    predicted: The method's garment, else the reference's. ending: What stands there if it had ended by then.
    """

    excerpt: "Excerpt"
    column: int
    predicted: bool = True
    ending: str = ""


def frame_strip(lines: list[Line], excerpt: "Callable[[str], Excerpt]") -> bytes:
    """Reference and methods over time, on one scene; of each method its first seed. A JPEG. lines: with a run each."""
    first = excerpt(lines[0].run_ids[0])
    columns = range(len(first.frames))
    rows: list[list[Shot | None]] = [[Shot(first, k, predicted=False) for k in columns]]
    rows.extend([Shot(excerpt(line.run_ids[0]), k, ending=line.endings[0]) for k in columns] for line in lines)
    return _sheet(rows, ["reference", *(line.label for line in lines)], [f"frame {f}" for f in first.frames])


def stress_strip(cases: dict[str, list[Line]], excerpt: "Callable[[str], Excerpt]") -> bytes:
    """Reference and methods in every stress case, at the same point of the roll-out. A JPEG. cases: name -> lines."""
    labels = list(dict.fromkeys(line.label for lines in cases.values() for line in lines))
    rows: list[list[Shot | None]] = [[] for _ in range(1 + len(labels))]
    for lines in cases.values():
        first = excerpt(lines[0].run_ids[0])
        at = min(STRESS_COLUMN, len(first.frames) - 1)
        rows[0].append(Shot(first, at, predicted=False, ending="not finite"))
        by_label = {line.label: Shot(excerpt(line.run_ids[0]), at, ending=line.endings[0]) for line in lines}
        for row, label in zip(rows[1:], labels, strict=True):
            row.append(by_label.get(label))
    return _sheet(rows, ["reference", *labels], list(cases))


def _sheet(rows: list[list[Shot | None]], row_titles: list[str], column_titles: list[str]) -> bytes:
    """Pictures in rows and columns, with titles and the scale of the colours; where there is no shot, nothing."""
    width, height = LEFT + WIDTH * len(rows[0]), TOP + HEIGHT * len(rows) + BOTTOM
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI)
    canvas = FigureCanvasAgg(figure)

    def write(x: float, y: float, text: str, **options) -> None:
        figure.text(x / width, 1 - y / height, text, va="center", fontsize=9, **options)

    for j, title in enumerate(column_titles):
        write(LEFT + (j + 0.5) * WIDTH, TOP / 2, title, ha="center", color="#555555")
    for i, (row, title) in enumerate(zip(rows, row_titles, strict=True)):
        write(8, TOP + (i + 0.5) * HEIGHT, title.replace(", ", ",\n"), ha="left", fontweight="bold")
        for j, shot in enumerate(row):
            picture = _picture(shot) if shot is not None else None
            if picture is not None:
                figure.figimage(picture, LEFT + j * WIDTH, height - TOP - (i + 1) * HEIGHT)
            elif shot is not None:
                ending = shot.ending.replace(" at ", "\nat ")
                write(LEFT + (j + 0.5) * WIDTH, TOP + (i + 0.5) * HEIGHT, ending, ha="center", color="#b3261e")
    _scale(figure, width, height)
    canvas.draw()
    buffer = io.BytesIO()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3]
    Image.fromarray(pixels).save(buffer, "JPEG", quality=85, optimize=True, subsampling=0)
    return buffer.getvalue()


def _picture(shot: Shot) -> np.ndarray | None:
    """One picture, or None where the roll-out had ended. The view stays with the reference garment."""
    excerpt, k = shot.excerpt, shot.column
    garment = excerpt.prediction[k] if shot.predicted else excerpt.reference[k]
    if not np.isfinite(garment).all():
        return None
    colour = CLOTH
    if shot.predicted:
        colour = error_colours(100.0 * np.linalg.norm(garment - excerpt.reference[k], axis=1))
    meshes = [RenderMesh(garment, excerpt.garment_faces, colour, cloth=True)]
    if excerpt.body.shape[1]:
        meshes.append(RenderMesh(excerpt.body[k], excerpt.body_faces))
    return render(meshes, "three-quarter", (WIDTH, HEIGHT), _focus(excerpt, k))


def _focus(excerpt: "Excerpt", k: int) -> np.ndarray:
    """A box round frame k's reference garment, of one size for all frames of the scene; shape (2, 3) [m]."""
    centres = 0.5 * (excerpt.reference.min(axis=1) + excerpt.reference.max(axis=1))
    half = 0.5 * np.ptp(excerpt.reference, axis=1).max(axis=0) + AROUND
    return np.stack([centres[k] - half, centres[k] + half])


def _scale(figure: Figure, width: int, height: int) -> None:
    """The scale of the error colours, at the bottom."""
    axes = figure.add_axes((LEFT / width, 34 / height, 2 * WIDTH / width, 12 / height))
    axes.imshow(np.linspace(0, 1, 256)[None], aspect="auto", cmap=ERROR_COLOURS, extent=(0, ERROR_SCALE_CM, 0, 1))
    axes.set_yticks([])
    axes.tick_params(labelsize=8, length=2)
    axes.set_xlabel("distance to the reference [cm]", fontsize=8, labelpad=1)
