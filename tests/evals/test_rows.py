"""results.csv: skill beside errors, failures kept, some lines computed anew and the others kept."""

import math
from dataclasses import replace

import pandas
import pytest

from garmentbench.evals.experiment import about, failed_row
from garmentbench.evals.run import merged, with_skill, write_results
from garmentbench.evaluation.results import COLUMNS, Row
from garmentbench.metrics import metric
from garmentbench.scenes.presets import PRESETS
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.storage.jobs import Failure

SCENE = load_scene("tshirt-armspace-90")


def row(method: str, value: float, experiment: str = "baselines", **more) -> Row:
    columns = about(experiment, PRESETS["smoke"], SCENE, method, train_frames=300)
    return replace(columns, metric="rollout_l2", value=value, unit="cm", **{"horizon": 50} | more)


def test_skill_is_measured_against_skinning_on_the_same_frames_of_any_table():
    rows = with_skill([row("skinning", 4.0), row("hold", 1.0, experiment="ablations"), row("hold", 1.0, horizon=1150)])
    skills = {(r.method, r.horizon): r.value for r in rows if r.metric == "skill"}
    assert skills == {("skinning", 50): 0.0, ("hold", 50): 0.75}


def test_skill_in_results_is_the_metric_also_where_skinning_makes_no_error():
    """D7: there were two formulas; one divided by zero."""
    rows = with_skill([row("skinning", 0.0), row("hold", 1.0)])
    assert all(math.isnan(r.value) for r in rows if r.metric == "skill")
    assert math.isnan(metric("skill").compute(1.0, 0.0))


def test_a_diverged_line_has_no_skill_and_stays():
    rows = with_skill([row("skinning", 4.0), row("hold", math.nan, status="diverged")])
    assert [r.status for r in rows if r.method == "hold"] == ["diverged"]


def test_lines_computed_anew_replace_their_old_rows_only(tmp_path):
    path = tmp_path / "results.csv"
    write_results(path, [row("skinning", 4.0), row("hold", 2.0)])
    write_results(path, merged(path, [row("hold", 1.0)]))
    table = pandas.read_csv(path)
    assert list(table.columns) == COLUMNS
    found = table.set_index(["method", "metric"]).value
    assert found["hold", "rollout_l2"] == 1.0 and found["hold", "skill"] == pytest.approx(0.75)
    assert found["skinning", "rollout_l2"] == 4.0 and len(table) == 4


def test_a_line_that_could_not_be_computed_keeps_its_row(tmp_path):
    columns = about("baselines", PRESETS["smoke"], SCENE, "mine", train_frames=300)
    write_results(tmp_path / "results.csv", [failed_row(columns, Failure("train mine", "ValueError: no"))])
    table = pandas.read_csv(tmp_path / "results.csv")
    assert table.status.tolist() == ["failed"] and math.isnan(table.value[0]) and "ValueError" in table.run_id[0]


def test_writing_twice_gives_the_same_bytes(tmp_path):
    rows = [row("skinning", 4.0), row("hold", 1 / 3)]
    write_results(tmp_path / "a.csv", rows)
    write_results(tmp_path / "b.csv", merged(tmp_path / "a.csv", []))
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_skill_does_not_change_when_other_experiments_are_made_again(tmp_path):
    """N9: it followed from all digits of what was just measured, but from six of what results.csv had."""
    measured = [row("skinning", 1.8411111449), row("hold", 1.7123456551)]
    write_results(tmp_path / "a.csv", measured)
    write_results(tmp_path / "b.csv", merged(tmp_path / "a.csv", measured[:1]))
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_an_older_results_csv_without_training_scenes_is_still_read(tmp_path):
    path = tmp_path / "results.csv"
    write_results(path, [row("skinning", 4.0)])
    table = pandas.read_csv(path)
    table.drop(columns="train_scenes").to_csv(path, index=False)
    write_results(path, merged(path, [row("hold", 2.0)]))
    assert pandas.read_csv(path).method.tolist() == ["hold", "hold", "skinning", "skinning"]
