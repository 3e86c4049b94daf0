"""The convergence study's and the cross-check's tables and pictures, made from fixture rows."""

import math

import pytest
from report_example import WALK, row, write_results, write_run

from garmentbench.evals.convergence.plot import convergence_plot
from garmentbench.evals.convergence.table import (
    CHOSEN,
    FINEST,
    OTHER_CLOTH,
    convergence_table,
    observed_order,
    sensitivity_table,
    studies,
    trust_table,
)
from garmentbench.evals.report import make_report
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.report.lines import Results, read_results
from garmentbench.report.table import write

DRESS = WALK | {"scene": "dress-armspace-90", "garment": "dress"}
STEP = {CHOSEN: 0.7, "substeps_x2": 0.3, "substeps_x4": 0.1}  # C (1/k - 1/8), C = 0.8: first order


def study_rows(scene: dict, scale: float = 1.0) -> list[dict]:
    """The rows of a study of first order."""

    def of(variant, metric, value, unit):
        run = f"convergence-{variant}"
        return row("convergence", scene, "reference", variant, 0, metric, 90, value, unit, train_frames=None, run=run)

    rows = []
    for k, variant in ((1, CHOSEN), (2, "substeps_x2"), (4, "substeps_x4"), (8, FINEST)):
        rows += [of(variant, "substeps", 56 * k, "1"), of(variant, "ms_per_frame", 20.0 * k, "ms")]
        if variant in STEP:
            rows.append(of(variant, "difference", scale * STEP[variant], "cm"))
            rows.append(of(variant, "difference_p95", 2 * scale * STEP[variant], "cm"))
    other = {"queries_x8": 0.01, "start_1um": 0.001, "start_1mm": 0.02, "start_1cm": 0.2, "mesh_fine": 0.9}
    for variant, value in (other | dict.fromkeys(OTHER_CLOTH, 1.25)).items():
        rows += [of(variant, "difference", scale * value, "cm"), of(variant, "ms_per_frame", 20.0, "ms")]
    return rows


def card_row(spread: float, scene: dict = WALK) -> dict:
    return row("data", scene, "reference", "full", 0, "spread", None, spread, "cm", train_frames=None)


def model_rows(error: float, scene: dict = WALK, run: str = "") -> list[dict]:
    values = ((50, 9.0), (1150, error))
    return [row("baselines", scene, "motion_guided", "full", 0, "rollout_l2", h, e, "cm", run=run) for h, e in values]


def markdown(table) -> str:
    return write(table, "md")


def read(tmp_path, rows) -> Results:
    write_results(tmp_path / "results.csv", rows)
    return Results(read_results(tmp_path / "results.csv"), tmp_path / "runs")


@pytest.mark.parametrize("p", [0.5, 1.0, 2.0, 3.0])
def test_the_order_of_a_known_error(p):
    """e(k) = C (k^-p - 8^-p); by hand, p = 1: 7/8 and 1/8."""
    assert observed_order(5 * (1 - 8**-p), 5 * (4**-p - 8**-p)) == pytest.approx(p)


def test_an_error_that_does_not_fall_has_no_order():
    for errors in ((0.5, 0.5), (0.1, 0.3), (math.nan, 1.0)):
        assert math.isnan(observed_order(*errors))
    assert observed_order(1.0, 0.5) < 0  # less than a third at 4 times the substeps: slower than any power


def test_the_verdict_is_a_third_of_the_full_model_s_error(tmp_path):
    rows = study_rows(WALK, scale=0.1) + study_rows(DRESS) + model_rows(0.6) + model_rows(0.9, DRESS)
    rows += [card_row(0.05), card_row(0.8, DRESS)]
    text = markdown(trust_table(studies(read(tmp_path, rows))))
    assert "| tshirt-armspace-90 | 1.00 | 0.07 | 0.05 | 0.09 | 0.6 | tshirt-armspace-90 | yes: 11.7 % |" in text
    assert "| dress-armspace-90 | 1.00 | 0.7 | 0.8 | 0.9 | 0.9 | dress-armspace-90 | no: 88.9 % |" in text


def test_an_order_hidden_by_rounding_is_not_told(tmp_path):
    """A micrometre at the start changes 0.06 cm, the step at 4 times the substeps 0.1 cm: less than twice that."""
    rows = [
        r | {"value": 0.06} if (r["variant"], r["metric"]) == ("start_1um", "difference") else r
        for r in study_rows(WALK)
    ]
    hidden = studies(read(tmp_path, [*rows, card_row(0.7)]))
    assert math.isnan(hidden[0].order) and "| tshirt-armspace-90 | none | 0.7 |" in markdown(trust_table(hidden))
    assert studies(read(tmp_path, study_rows(WALK)))[0].order == pytest.approx(1)


def test_without_the_model_it_says_so(tmp_path):
    text = markdown(trust_table(studies(read(tmp_path, study_rows(DRESS) + model_rows(0.6)))))
    assert "full model not run on it" in text


def test_another_scene_of_the_garment_will_do_and_then_the_one_with_the_smallest_error(tmp_path):
    others = [WALK | {"scene": f"tshirt-{motion}", "motion": motion} for motion in ("strut", "catwalk")]
    found = studies(read(tmp_path, study_rows(WALK) + model_rows(1.2, others[0]) + model_rows(0.8, others[1])))
    assert (found[0].model_error, found[0].model_scene) == (0.8, "tshirt-catwalk")


def test_an_order_of_next_to_nothing_is_not_told(tmp_path):
    """What the step changes is 0.0042 cm, at first order."""
    found = studies(read(tmp_path, study_rows(WALK, scale=0.006)))
    assert found[0].order == pytest.approx(1) and "| tshirt-armspace-90 | below 0.005 cm |" in markdown(
        trust_table(found)
    )


def test_without_an_ensemble_the_spread_is_not_known(tmp_path):
    found = studies(read(tmp_path, study_rows(WALK) + model_rows(0.6)))
    assert math.isnan(found[0].spread) and "spread not known" in markdown(trust_table(found))


def test_the_chosen_setting_is_marked_and_every_run_is_there(tmp_path):
    text = markdown(convergence_table(studies(read(tmp_path, study_rows(WALK)))))
    assert "| tshirt-armspace-90 | **the chosen setting** | **56** | **0.7** | **1.4** | **20.0** | ok |" in text
    assert "| tshirt-armspace-90 | 8 times the substeps, the finest | 448 | – | – | 160 | ok |" in text
    assert text.count("| tshirt-armspace-90 |") == 9


def test_what_the_reference_depends_on_stands_beside_what_changes_nothing(tmp_path):
    text = markdown(sensitivity_table(studies(read(tmp_path, study_rows(WALK)))))
    assert "| tshirt-armspace-90 | 0.7 |" + " 1.2 |" * len(OTHER_CLOTH) in text


def test_a_run_that_became_unstable_says_so(tmp_path):
    rows = [
        r | ({"status": "diverged", "first_bad_frame": 12} if r["variant"] == "start_1cm" else {})
        for r in study_rows(WALK)
    ]
    assert "diverged at frame 12" in markdown(convergence_table(studies(read(tmp_path, rows))))


def test_the_plot_is_the_same_bytes_every_time(tmp_path):
    found = studies(read(tmp_path, study_rows(WALK) + study_rows(DRESS, 0.1) + model_rows(0.6)))
    assert convergence_plot(found) == convergence_plot(found) != convergence_plot(found[:1])


def test_the_report_has_both_studies(tmp_path):
    """With the cross-check's strip, and without asking for the runs of the reference's own lines."""
    sequence = tiny_sequence(40)
    run = write_run(tmp_path / "runs", sequence, "crosscheck-1", 1.5)
    about = ("crosscheck", WALK, "newton_vbd", "full", 0)
    rows = (
        study_rows(WALK)
        + model_rows(0.6, run=write_run(tmp_path / "runs", sequence, "evaluate-1", 0.6))
        + [
            row(*about, "difference", 90, 1.5, "cm", spread=0.014, train_frames=None, run=run),
            row(*about, "difference_p95", 90, 3.25, "cm", spread=0.014, train_frames=None, run=run),
            row(*about, "interpenetration_strict", 90, 0.09, "%", reference=0.0, train_frames=None, run=run),
            row(*about, "ms_per_frame", 90, 656.0, "ms", reference=21.3, train_frames=None, run=run),
            row(*about, "match_hanging", 90, 0.4, "%", train_frames=None, run=run),
            row(*about, "match_cantilever", 90, 1.25, "%", train_frames=None, run=run),
        ]
    )
    write_results(tmp_path / "reports" / "laptop" / "results.csv", rows)
    page = make_report("laptop", tmp_path / "reports", tmp_path / "runs")
    text = (page.parent / "tables" / "crosscheck.md").read_text()
    assert (
        "| tshirt-armspace-90 | as it is | **1.5** | 3.2 | 0.014 | 0.09, 0.00 | 656, 21.3 | 0.40, 1.25 | ok |" in text
    )
    assert (page.parent / "tables" / "trust.tex").is_file()
    for picture in ("plots/convergence.svg", "strips/crosscheck-tshirt-armspace-90.jpg"):
        assert (page.parent / picture).is_file() and picture in page.read_text()
