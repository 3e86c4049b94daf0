"""The three forms of a table, byte for byte as those that are committed."""

import html
import re
from pathlib import Path

import pytest

from garmentbench.report.table import Cell, Table, write

TABLES = Path(__file__).resolve().parents[3] / "reports" / "laptop" / "tables"


def read(name: str) -> Table:
    """A committed table, read back: words and marks from its HTML, title and caption from its Markdown."""
    lines = (TABLES / f"{name}.md").read_text().splitlines()
    page = (TABLES / f"{name}.html").read_text()
    titles = re.findall(r"<th( class=\"words\")?>(.*?)</th>", page)
    rows = [
        [
            Cell(html.unescape(re.sub("</?small>", "", text)), *(mark in classes for mark in ("best", "note", "bad")))
            for classes, text in re.findall(r"<td(?: class=\"(.*?)\")?>(.*?)</td>", row)
        ]
        for row in re.findall(r"<tr>(<td.*?)</tr>", page)
    ]
    words = frozenset(i for i, (mark, _) in enumerate(titles) if mark)
    return Table(name, lines[2].removeprefix("### "), lines[4], [html.unescape(t) for _, t in titles], rows, words)


@pytest.mark.parametrize("form", ["md", "tex", "html"])
def test_committed_tables_are_written_byte_for_byte(form):
    found = sorted(path.stem for path in TABLES.glob("*.md"))
    assert found
    for name in found:
        assert write(read(name), form) == (TABLES / f"{name}.{form}").read_text(), name


def test_awkward_text_is_escaped_in_each_form():
    cells = [Cell("x_y|z"), Cell("< 0.01 & 5 %", bold=True)]
    table = Table("t", "Title_1", "50 % & more", ["a|b", "c [m/s²]"], [cells])
    assert "| x_y\\|z | **< 0.01 & 5 %** |" in write(table, "md")
    assert r"x\_y|z & \textbf{$<$ 0.01 \& 5 \%} \\" in write(table, "tex") and r"50 \% \& more" in write(table, "tex")
    assert '<td class="best">&lt; 0.01 &amp; 5 %</td>' in write(table, "html")
