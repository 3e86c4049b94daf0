"""The page: index.html, which needs no network."""

from dataclasses import dataclass
from importlib.resources import files

from jinja2 import Environment
from markupsafe import Markup

from garmentbench.report.table import NOTICE, Table, html_table


@dataclass(frozen=True)
class Picture:
    """A picture of the report: its file, relative to the page, and what it shows."""

    path: str
    caption: str


@dataclass(frozen=True)
class Section:
    """A part of the page: a table, and the pictures and further files (relative to the page) that go with it."""

    table: Table
    pictures: list[Picture]
    files: list[str]


@dataclass(frozen=True)
class Ended:
    """A line that did not end well: where, what, and what it said."""

    scene: str
    method: str
    ending: str
    message: str


def page(preset: str, sections: list[Section], ended: list[Ended], made_on: list[str]) -> str:
    """The page of a preset's report. `made_on`: the machines that the runs name."""
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(files("garmentbench.report").joinpath("page.html.j2").read_text("utf-8"))
    shown = [(section, Markup(html_table(section.table))) for section in sections]
    return template.render(preset=preset, sections=shown, ended=ended, made_on=made_on, notice=NOTICE)
