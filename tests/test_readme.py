"""What the README shows is what there is."""

import re
import sys
from pathlib import Path

from garmentbench.cli import main

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text()


def test_the_table_is_the_report_s():
    shown = README.split("<!-- table -->")[1].split("<!-- /table -->")[0].strip()
    report = (ROOT / "reports/laptop/tables/baselines-tshirt-armspace-90.md").read_text()
    table = "\n".join(line for line in report.splitlines() if line.startswith("|"))
    assert shown == table.strip()


def test_the_files_it_links_to_are_there():
    for link in re.findall(r"\]\(([^)h][^)]*)\)", README):
        assert (ROOT / link).is_file(), link


def test_the_example_method_keeps_the_contract(tmp_path, monkeypatch, capsys):
    code = README.split("```python\n")[1].split("```")[0]
    assert len(code.splitlines()) <= 22
    (tmp_path / "my_method.py").write_text(code)
    monkeypatch.syspath_prepend(tmp_path)
    assert main(["check-method", "my_method:Follow"]) == 0, capsys.readouterr()
    sys.modules.pop("my_method")
