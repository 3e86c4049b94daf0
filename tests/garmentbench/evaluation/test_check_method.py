"""Each check has a method that breaks it alone; methods that keep the contract pass all of them."""

from dataclasses import replace

import foreign_methods as foreign
import pytest

from garmentbench.evaluation.check_method import check_method, parametrize_with_checks
from garmentbench.evaluation.checks import CHECKS, SCENES
from garmentbench.methods import METHODS, load_method
from garmentbench.pipeline.choice import choose_method
from garmentbench.scenes.presets import preset

BROKEN = {
    foreign.FitRaises: ("fit", "fit raised ZeroDivisionError: no data ("),
    foreign.FitTakesOne: ("fit_on_several_sequences", "fit on two sequences raised ValueError"),
    foreign.FitWrites: ("fit_leaves_sequences_alone", "writes into the training sequence"),
    foreign.Raises: ("begin_and_step_run", "at frame 7 it raised ZeroDivisionError: seventh frame ("),
    foreign.BeginsAtTheStart: ("begin_at_any_frame", "begun at frame 4 it raised IndexError: too late ("),
    foreign.WrongShape: ("output_shape", "at frame 7 step returned float32 of shape (104, 3)"),
    foreign.Integers: ("output_shape", "at frame 3 step returned int64"),
    foreign.NaN: ("output_is_finite", "at frame 7, 105 of 105 vertices are not finite"),
    foreign.Writes: ("inputs_are_left_alone", "writes into the history"),
    foreign.Random: ("second_run_is_the_same", "twice, gives different garments"),
    foreign.HidesState: ("roll_outs_do_not_disturb_each_other", "disturb each other"),
    foreign.Forgets: ("save_and_load", "predicts something else"),
    foreign.LoadRaises: ("save_and_load", "load raised FileNotFoundError: weights.pt ("),
    foreign.LooksAhead: ("future_is_not_seen", "up to frame 12 depends on what comes after it"),
    foreign.LooksAround: ("future_is_not_seen", "up to frame 12 depends on what comes after it"),
    foreign.ReadsTheReference: ("reference_is_not_read", "opens sequences/smoke/tshirt-armspace-90.h5"),
}


def test_every_check_has_a_method_that_breaks_it():
    assert {check.__name__.removeprefix("check_") for check in CHECKS} == {name for name, _ in BROKEN.values()}


@pytest.mark.parametrize("method", BROKEN)
def test_a_broken_contract_is_found_by_its_check_alone(method):
    name, what = BROKEN[method]
    report = check_method(method)
    failed = [result for result in report.results if result.status == "failed"]
    assert not report.ok and {result.check for result in failed} == {name}, report
    assert what in failed[0].problem.what and failed[0].problem.do and what in str(report)


@pytest.mark.parametrize("method", [foreign.FitRaises, foreign.Raises, foreign.LoadRaises])
def test_where_a_method_raised_is_told_by_file_and_line(method):
    assert "foreign_methods.py:" in check_method(method).problems[0].what


def test_every_scene_is_tried_and_a_failure_on_one_does_not_end_the_others():
    report = check_method(foreign.NaN)
    found = {r.scene for r in report.results if r.check == "output_is_finite" and r.status == "failed"}
    assert found == set(SCENES)
    assert {r.status for r in report.results if r.check == "save_and_load"} == {"passed"}


def test_a_step_that_returns_no_state_is_told_so_and_nothing_else():
    """It failed with "two roll-outs in turns disturb each other" beside it."""
    report = check_method(foreign.ForgetsTheState)
    assert {r.check for r in report.results if r.status == "failed"} == {"begin_and_step_run"}
    assert report.problems[0].what == "at frame 3 step returned one array"
    assert report.problems[0].do == "return (positions, state)"
    skipped = {r.check for r in report.results if r.status == "skipped"}
    assert {"roll_outs_do_not_disturb_each_other", "output_shape", "save_and_load"} <= skipped
    assert str(report).endswith(f"4 failed, {report.skipped} skipped")


@pytest.mark.parametrize(
    ("method", "check"),
    [
        (foreign.FitExits, "fit"),
        (foreign.LoadExits, "save_and_load"),
        (foreign.BeginExits, "begin_and_step_run"),
        (foreign.StepExits, "begin_and_step_run"),
    ],
)
def test_a_method_that_exits_has_raised(method, check):
    report = check_method(method)
    assert {r.check for r in report.results if r.status == "failed"} == {check}
    assert "raised SystemExit: 0 (" in report.problems[0].what


def test_missing_parts_are_told_all_at_once():
    (problem,) = check_method(foreign.Nameless).problems
    assert "`name` is missing" in problem.what and "`step` is missing" in problem.what


def test_a_good_method_passes_every_check():
    told = []
    report = check_method(foreign.Good, foreign.Config(), told.append)
    assert report.ok and {r.status for r in report.results} == {"passed"} and tuple(told) == report.results
    assert len(report.results) == 1 + 4 * (len(CHECKS) - 1) + 1


def test_a_scene_may_be_refused_but_not_the_human_one():
    report = check_method(foreign.RefusesObjects)
    assert report.ok
    refused = {r.scene for r in report.results if r.check == "fit" and r.status == "skipped"}
    assert refused == {"object", "garment", "bodiless"}


def small(name):
    config = choose_method(name, "full", preset("smoke")).config
    if name == "motion_guided":
        for stage in ("sdf", "stage1", "stage2"):
            options = getattr(config, stage)
            config = replace(config, **{stage: replace(options, training=replace(options.training, steps=3))})
    return load_method(name), config


@parametrize_with_checks([small(name) for name in METHODS])
def test_our_own_methods_keep_the_contract(method, check):
    check(method)


def test_a_failing_check_fails_the_test_of_the_user(pytester_file):
    outcome = pytester_file(
        "from foreign_methods import Good, NaN\n"
        "from garmentbench import parametrize_with_checks\n\n"
        "@parametrize_with_checks([Good, NaN])\n"
        "def test_mine(method, check):\n    check(method)\n"
    )
    assert "4 failed" in outcome and "at frame 7, 105 of 105 vertices are not finite" in outcome
    assert "test_mine[NaN-output_is_finite-human]" in outcome


@pytest.fixture
def pytester_file(tmp_path):
    """Run pytest on a test file of the user's own; its output."""
    import os
    import subprocess
    import sys
    from pathlib import Path

    def run(text):
        (tmp_path / "test_mine.py").write_text(text)
        root = Path(__file__).parents[3]
        env = os.environ | {"PYTHONPATH": os.pathsep.join([str(root / "tests" / "helpers"), str(root)])}
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_mine.py"]
        return subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=env).stdout

    return run
