"""results.csv: skill beside errors, failures kept, some lines computed anew and the others kept."""

import math

import pandas
import pytest

from garmentbench.evals.rows import about, failed_row, merged, with_skill, write_results
from garmentbench.report.lines import COLUMNS
from garmentbench.scenes.presets import PRESETS
from garmentbench.scenes.scene import load_scene
from garmentbench.storage.jobs import Failure

SCENE = load_scene("tshirt-armspace-90")


def row(method: str, value: float, experiment: str = "baselines", status: str = "ok", **more) -> dict:
    columns = about(experiment, PRESETS["smoke"], SCENE, method, "full", 300, 0)
    return columns | {"metric": "rollout_l2", "horizon": 50, "value": value, "unit": "cm", "status": status} | more


def test_skill_is_measured_against_skinning_on_the_same_frames_of_any_table():
    rows = with_skill([row("skinning", 4.0), row("hold", 1.0, experiment="ablations"), row("hold", 1.0, horizon=1150)])
    skills = {(r["method"], r["horizon"]): r["value"] for r in rows if r["metric"] == "skill"}
    assert skills == {("skinning", 50): 0.0, ("hold", 50): 0.75}


def test_a_diverged_line_has_no_skill_and_stays():
    rows = with_skill([row("skinning", 4.0), row("hold", math.nan, status="diverged")])
    assert [r["status"] for r in rows if r["method"] == "hold"] == ["diverged"]


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
    columns = about("baselines", PRESETS["smoke"], SCENE, "mine", "full", 300, 0)
    write_results(tmp_path / "results.csv", [failed_row(columns, Failure("train mine", "ValueError: no"))])
    table = pandas.read_csv(tmp_path / "results.csv")
    assert table.status.tolist() == ["failed"] and math.isnan(table.value[0]) and "ValueError" in table.run_id[0]


def test_writing_twice_gives_the_same_bytes(tmp_path):
    rows = [row("skinning", 4.0), row("hold", 1 / 3)]
    write_results(tmp_path / "a.csv", rows)
    write_results(tmp_path / "b.csv", merged(tmp_path / "a.csv", []))
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
