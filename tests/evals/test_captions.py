"""A table's caption and its console's warnings agree with its cells."""

from pathlib import Path

import pytest
from report_example import WALK, measured, never_ran, write_results

from garmentbench.evals.accuracy_table import accuracy_table
from garmentbench.evals.run import noted
from garmentbench.evaluation.results import TRAINED_ON_IT, UNDER_LOAD, Row
from garmentbench.report.lines import Results, read_results


@pytest.fixture
def table(tmp_path, monkeypatch):
    """The table of some rows, in which only motion_guided has chance in its training."""

    def random(self: Results, run: str) -> dict:
        return {"results": {"random": run.startswith("guided")}}

    monkeypatch.setattr(Results, "training", random)

    def make(rows: list[dict]):
        write_results(tmp_path / "results.csv", rows)
        lines = Results(read_results(Path(tmp_path / "results.csv")), tmp_path).lines("baselines")
        return accuracy_table(lines, "Title")

    return make


def line(method: str, error: float, seed: int = 0, bad: int | None = None) -> list[dict]:
    run = f"{'guided' if method == 'motion_guided' else method}-{seed}"
    return measured("baselines", WALK, method, "full", seed, error, run, bad=bad)


def bold(table) -> bool:
    return any(cell.bold for row in table.rows for cell in row)


def test_a_line_that_never_ran_does_not_say_that_nothing_is_bold(table):
    """The caption looked at all lines, the cells at those that ran."""
    failed = never_ran("baselines", WALK, "motion_guided", "full", "no")
    made = table([*line("skinning", 3.8), *line("hold", 1.0), failed])
    assert bold(made) and "nothing is bold" not in made.caption and "; bold: better than every other" in made.caption


def test_beside_a_single_training_the_caption_says_that_nothing_is_bold(table):
    made = table([*line("skinning", 3.8), *line("motion_guided", 1.0)])
    assert not bold(made) and "; one seed." in made.caption and "nothing is bold" in made.caption


def test_where_some_columns_have_one_training_and_others_a_best_both_are_said(table):
    """It diverged after 50 frames."""
    made = table([*line("skinning", 3.8), *line("hold", 1.0), *line("motion_guided", 0.5, bad=60)])
    assert bold(made) and "nothing in other columns" in made.caption


def test_a_table_without_chance_says_so_rather_than_one_seed(table):
    made = table([*line("skinning", 3.8), *line("hold", 1.0)])
    assert "none of the methods has chance in its training" in made.caption and "; one seed." not in made.caption


def test_a_table_with_the_papers_errors_says_what_they_are_worth(table):
    said = "The paper does not define its L2"
    assert said in table([*line("skinning", 3.8), *line("motion_guided", 1.0)]).caption
    assert said not in table([*line("skinning", 3.8), *line("hold", 1.0)]).caption


def test_a_table_on_a_validation_scene_says_that_it_is_no_test(table):
    """Settings are chosen on it; it is never reported as a test."""
    rows = [*line("skinning", 3.8), *line("hold", 1.0)]
    assert "validation" not in table(rows).title
    assert table([row | {"split": "validation"} for row in rows]).title.endswith("(validation, no test)")


def test_noted_values_are_told_on_the_console():
    """`evaluate` said so, `evals` did not."""
    rows = [
        Row(method="mine", variant="full", scene="walk", metric="rollout_l2", note=f"{UNDER_LOAD}; {TRAINED_ON_IT}"),
        Row(method="mine", variant="full", scene="walk", metric="one_step_l2", note=TRAINED_ON_IT),
        Row(method="mine", variant="small", scene="walk", metric="one_step_l2", note=TRAINED_ON_IT),
        Row(method="other", metric="rollout_l2"),
    ]
    load, training = noted(rows)
    assert load.startswith("mine on walk: timed under load: wall time is far above")
    assert training.startswith("mine on walk, mine small on walk: trained on this scene: a training error")
