"""What was run before keeps its place in the report while it would come out the same; when it loses it, it says so."""

from dataclasses import replace

import pytest

from garmentbench import sequence_file
from garmentbench.evals.comparison import Comparison
from garmentbench.evals.data import CARDS
from garmentbench.evals.experiment import finished_rows
from garmentbench.evals.run import kept_rows, write_results
from garmentbench.evals.trial import Entry
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.scenes.presets import preset
from garmentbench.storage.jobs import run_here

SMOKE = preset("smoke")


@pytest.fixture
def study(home):
    """Two methods on files, run; and its results.csv."""
    for name, phase in (("one", 0.0), ("test", 1.0)):
        sequence_file.save(tiny_sequence(12, phase=phase, runs=2), home / f"{name}.h5")
    study = Comparison(
        name="asks", table="asks", title="Asks", train=("one.h5",), tests=("test.h5",), on_request=True,
        entries=(Entry("hold", train_frames=12), Entry("linear_subspace", train_frames=12)),
    )  # fmt: skip
    assert finished_rows(study, SMOKE) == [] and not (home / "runs").exists()
    work = study.work(SMOKE, 1)
    rows = work.rows(run_here(work.jobs))
    assert {row.method for row in rows} == {"another_run", "hold", "linear_subspace"}
    write_results(home / "results.csv", rows)
    return study, rows


def test_what_was_run_is_found_without_running_and_its_cards_with_it(study, monkeypatch):
    study, rows = study
    monkeypatch.setattr("garmentbench.pipeline.evaluate._predict", None)
    assert [str(row) for row in finished_rows(study, SMOKE)] == [str(row) for row in rows]  # NaN is not itself
    beside = finished_rows(study, SMOKE, 1, CARDS)[len(rows) :]
    assert {(row.experiment, row.scene) for row in beside} == {("data", "tiny")}


def test_it_is_dropped_with_a_word_when_its_data_changes(study, home, capsys):
    study, rows = study
    assert len(kept_rows(study, SMOKE, home / "results.csv")) > len(rows) and capsys.readouterr().out == ""
    sequence_file.save(tiny_sequence(12, phase=2.0, runs=2), home / "test.h5")
    assert kept_rows(study, SMOKE, home / "results.csv") == []
    assert capsys.readouterr().out == (
        "warning: asks: its part of the report is dropped, which was made by other code or of other data; "
        "`garmentbench evals asks --preset smoke` makes it again\n"
    )
    assert kept_rows(replace(study, table="never"), SMOKE, home / "results.csv") == [] and capsys.readouterr().out == ""


def test_as_many_seeds_are_looked_for_as_the_report_has(study, home, monkeypatch):
    study, rows = study
    write_results(home / "results.csv", [*rows, replace(rows[-1], seed=2)])
    monkeypatch.setattr("garmentbench.evals.run.finished_rows", lambda experiment, size, seeds, *beside: [seeds])
    assert kept_rows(study, SMOKE, home / "results.csv") == [3]
