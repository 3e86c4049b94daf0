"""What training frames are worth: the points of the plot and the table, of rows made up by hand."""

from dataclasses import replace

import pytest

from garmentbench.evals import EXPERIMENTS
from garmentbench.evals.ablations import PARTS_OF_TUNED
from garmentbench.evals.run import write_results
from garmentbench.evals.training_data.plot import error_against_frames
from garmentbench.evals.training_data.table import curves, training_data_table
from garmentbench.evaluation.results import Row
from garmentbench.report.lines import Results, read_results
from garmentbench.scenes.presets import preset

LATE, BOUNCE = "skirt-late", "skirt-bounce"
ROW = Row(experiment="training_data", preset="laptop", horizon=400, metric="rollout_l2", unit="cm", status="ok")


def _row(method: str, scene: str, frames: int | None, value: float, seed: int = 0) -> Row:
    trained = "" if frames is None else f"skirt@{frames}"
    about = {"method": method, "scene": scene, "train_frames": frames, "train_scenes": trained, "seed": seed}
    return replace(ROW, variant="full", garment="skirt", motion="late", value=value, **about)


ROWS = [
    _row("another_run", LATE, None, 0.4),
    _row("tuned", LATE, 6210, 1.0),
    _row("tuned", LATE, 6210, 1.2, seed=1),
    _row("tuned", LATE, 300, 2.0),
    _row("linear_subspace", LATE, 300, 3.0),
    _row("tuned", BOUNCE, 300, 5.0),
]


@pytest.fixture
def lines(tmp_path):
    write_results(tmp_path / "results.csv", ROWS)
    return Results(read_results(tmp_path / "results.csv"), tmp_path).lines("training_data")


def test_a_curve_goes_from_few_frames_to_many_with_the_mean_and_interval_of_its_seeds(lines):
    """Two seeds, 1.0 and 1.2: mean 1.1; half the 95 % interval is 12.706 x 0.1414 / sqrt(2) = 1.2706."""
    found = curves(lines, LATE)
    assert list(found) == ["linear subspace", "tuned"]
    assert found["tuned"] == [(300, 2.0, 0.0), (6210, pytest.approx(1.1), pytest.approx(1.2706, abs=1e-4))]
    assert curves(lines, BOUNCE) == {"tuned": [(300, 5.0, 0.0)]}


def test_the_table_has_a_row_for_each_method_and_training_set_and_a_column_for_each_test(lines):
    table = training_data_table(lines, "frames")
    texts = [[cell.text for cell in row] for row in table.rows]
    columns = {title: [row[k] for row in texts] for k, title in enumerate(table.header)}
    assert columns["method"] == ["another run", "linear subspace", "tuned", "tuned"]
    assert columns["trained on"][1:] == ["skirt@300", "skirt@300", "skirt@6210"]
    assert columns["frames"][1:] == ["300", "300", "6,210"]
    assert columns[f"{BOUNCE} [cm]"][2].startswith("5.0") and columns[f"{LATE} [cm]"][0].startswith("0.4")


def test_the_plot_names_every_method_once(lines):
    svg = error_against_frames(lines).decode()
    assert svg.count("<!-- tuned -->") == 1 and svg.count("<!-- another run -->") == 1


def test_each_method_is_trained_on_each_set_and_each_part_of_tuned_is_taken_away():
    laptop = preset("laptop")
    trained = {key for key in EXPERIMENTS["training-data"].work(laptop, 1).jobs if key[0] == "train"}
    assert len(trained) == 4 * 6
    keys = {key for key in EXPERIMENTS["ablation-tuned"].work(laptop, 3).jobs if key[0] == "train"}
    assert {key[3] for key in keys} == {"full", *PARTS_OF_TUNED} and len(keys) == 3 * (1 + len(PARTS_OF_TUNED))


def test_every_part_of_tuned_is_taken_away_somewhere():
    from garmentbench.methods.tuned import VARIANTS

    assert {"full", *PARTS_OF_TUNED} == set(VARIANTS)
