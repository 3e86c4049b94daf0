"""The validation table: what passes, what fails and stays, and what could not be run."""

import math

import pandas
import pytest

from garmentbench.evals.validation.study import _rows
from garmentbench.evals.validation.table import Found, read_cases, validation_table
from garmentbench.evaluation.results import COLUMNS
from garmentbench.report.lines import Results, read_results
from garmentbench.scenes.presets import preset
from garmentbench.storage.jobs import Failure
from garmentbench.storage.runs import RunStore

VALUES = {"1/10": 8.5, "1/20": 8.0, "1/40": 7.9}


@pytest.fixture
def found(tmp_path, monkeypatch) -> list[Found]:
    """Rows of a case that passes, of one that fails, and of one that raised, through results.csv and back."""
    monkeypatch.setenv("GARMENTBENCH_HOME", str(tmp_path))
    rows = []
    for name, high in (("self_buckling", 8.0), ("euler_load", 7.85)):
        with RunStore().open("validation", {"case": name}) as run:
            run.finish(
                {"wanted": 7.8, "low": 7.6, "high": high, "values": VALUES, "seconds": dict.fromkeys(VALUES, 1.0)}
            )
        rows += _rows(name, preset("smoke"), run.id)
    rows += _rows("twist", preset("smoke"), Failure("twist", "no cloth"))
    path = tmp_path / "smoke" / "results.csv"
    path.parent.mkdir()
    pandas.DataFrame(map(vars, rows), columns=COLUMNS).to_csv(path, index=False)
    return read_cases(Results(read_results(path), tmp_path / "runs"))


def test_cases_are_read_in_the_order_of_the_suite(found):
    assert [case.name for case in found] == ["self_buckling", "euler_load", "twist"]
    assert [case.passed for case in found] == [True, False, False]
    assert found[0].values == VALUES and found[0].wanted == 7.8 and math.isnan(found[2].finest)


def test_what_fails_stays_and_is_red(found):
    table = validation_table(found)
    assert table.title == "Validation: 1 of 3 pass"
    good, bad, broken = ([cell.text for cell in row] for row in table.rows)
    assert good[2:9] == ["8.5 (1/10)", "8 (1/20)", "7.9 (1/40)", "7.8", "1.28", "1.00", "yes"]
    assert bad[8] == "no" and broken[8] == "no: no cloth" and broken[2:5] == ["–"] * 3
    assert [row[8].bad for row in table.rows] == [False, True, True]
