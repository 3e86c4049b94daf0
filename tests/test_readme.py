"""What the README and docs/ show is what there is."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from garmentbench.cli import main

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text()


def committed(path: str) -> str:
    """A file as it is committed: `make evals` remakes reports/laptop with the numbers of the user's own machine."""
    asked = ["git", "-C", str(ROOT), "show", f"HEAD:{path}"]
    try:
        shown = subprocess.run(asked, capture_output=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("not a git checkout")
    return shown.stdout.decode()


def cells(text: str) -> dict[tuple[str, str], str]:
    """A Markdown table's cells by line and column; of columns with the same title the first."""
    rows = [[c.strip() for c in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]
    header, _, *lines = rows
    return {(line[0], title): cell for line in lines for title, cell in reversed(list(zip(header, line, strict=True)))}


def test_the_committed_table_is_the_committed_report_s():
    """Its columns may be fewer; a user's own run in reports/laptop changes nothing (N13)."""
    shown = cells(committed("README.md").split("<!-- table -->")[1].split("<!-- /table -->")[0])
    report = cells(committed("reports/laptop/tables/baselines-tshirt-armspace-90.md"))
    columns = {column for _, column in shown} & {column for _, column in report}
    assert len(columns) >= 4
    for (line, column), cell in shown.items():
        if column in columns:
            assert report[line, column] == cell, (line, column)


@pytest.mark.parametrize(
    "page", ["README.md", "CONTRIBUTING.md", *(f"docs/{p.name}" for p in (ROOT / "docs").glob("*.md"))]
)
def test_the_files_it_links_to_are_there(page):
    for link in re.findall(r"\]\(([^)#h][^)#]*)", (ROOT / page).read_text()):
        assert ((ROOT / page).parent / link).exists(), link


def test_the_example_method_keeps_the_contract(tmp_path, monkeypatch, capsys):
    code = (ROOT / "docs" / "own-method.md").read_text().split("```python\n")[1].split("```")[0]
    assert len(code.splitlines()) <= 22
    (tmp_path / "my_method.py").write_text(code)
    monkeypatch.syspath_prepend(tmp_path)
    assert main(["check-method", "my_method:Follow"]) == 0, capsys.readouterr()
    sys.modules.pop("my_method")


def test_the_front_door_is_small():
    """A table of at most six columns, and a garment of one's own in at most nine commands."""
    assert max(line.count("|") for line in README.splitlines() if line.startswith("|")) - 1 <= 6
    commands = README.split("```sh\n")[1].split("```")[0].splitlines()
    assert len([line for line in commands if line and not line.startswith("#")]) <= 9
    own = (ROOT / "docs" / "own-garment.md").read_text()
    assert README.split("```sh\n")[1].split("```")[0] == own.split("```sh\n")[1].split("```")[0]
