"""The page: index.html, which needs no network."""

from dataclasses import dataclass, field
from importlib.resources import files

from jinja2 import Environment
from markupsafe import Markup

from garmentbench.report.lines import Line
from garmentbench.report.table import NOTICE, Table, write


@dataclass(frozen=True)
class Picture:
    """A picture of the report: its file, relative to the page, what it shows, and the file's content."""

    path: str
    caption: str
    content: bytes = field(repr=False)


@dataclass(frozen=True)
class Section:
    """A part of the page.

    Attributes:
        table: Its table.
        pictures: What stands below it.
        files: Further files that go with it, by their paths relative to the page.
        lines: The lines that it is about, whose runs are listed with it.
    """

    table: Table
    pictures: list[Picture] = field(default_factory=list)
    files: dict[str, bytes] = field(default_factory=dict)
    lines: list[Line] = field(default_factory=list)


@dataclass(frozen=True)
class Ended:
    """A line that did not end well: where, what, and what it said."""

    scene: str
    method: str
    ending: str
    message: str


def page(
    name: str,
    command: str,
    made_on: list[str],
    sections: list[Section],
    runs: dict[str, Section],
    ended: list[Ended],
) -> str:
    """The page of a report.

    Args:
        name: The report's.
        command: What makes all of it.
        made_on: The machines that the runs name.
        sections: Its parts.
        runs: The runs behind a part, by the name of its table.
        ended: Lines that did not end well.
    """
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters["table"] = lambda table: Markup(write(table, "html"))
    template = environment.from_string(files("garmentbench.report").joinpath("page.html.j2").read_text("utf-8"))
    return template.render(
        name=name, command=command, made_on=made_on, sections=sections, runs=runs, ended=ended, notice=NOTICE
    )
