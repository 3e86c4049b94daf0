"""What the experiment computes at which size, what failed keeps its lines, and its part of the report."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from garmentbench import sequence_file
from garmentbench.evals.baselines import BASELINES
from garmentbench.evals.error_time.measure import method_rows, roll_out_of
from garmentbench.evals.error_time.points import BUDGETS, Budget, Setting, budgets, settings
from garmentbench.evals.error_time.study import MEASURED, SIMULATED, STUDY, WHOLE, simulator_run
from garmentbench.evals.experiment import finished_rows
from garmentbench.evals.own import read_experiments
from garmentbench.evals.run import write_results
from garmentbench.evaluation.results import Row
from garmentbench.evaluation.rollout import ROLL_OUT, RollOut
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.reference import make_reference
from garmentbench.report.lines import Results, read_results
from garmentbench.report.runs import command
from garmentbench.scenes.garments import load_garment
from garmentbench.scenes.presets import preset
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.sequence import Sequence, Template
from garmentbench.storage.jobs import Failure
from garmentbench.storage.runs import RunStore


def test_what_the_main_table_trains_is_shared():
    ours, main = (set(e.work(preset("laptop"), 2).jobs) for e in (STUDY, BASELINES))
    shared = {key for key in ours & main if key[0] in ("train", "evaluate")}
    assert {key[2] for key in shared if key[0] == "train"} >= {"skinning", "tuned", "motion_guided", "pose_gru"}
    assert len([key for key in ours if key[0] == SIMULATED]) == len(budgets(preset("laptop")))
    assert len([key for key in ours if key[0] == MEASURED]) == len([key for key in ours if key[0] == "evaluate"])


def test_every_setting_is_another():
    found = [setting.choice(preset("laptop")) for setting in settings(preset("laptop"))]
    told = [(c.name, repr(c.config)) for c in found]
    assert len(set(told)) == len(told) and len({(c.name, c.variant) for c in found}) == len(found)
    network = Setting("motion_guided", "smoke_network", model="smoke")
    assert network in settings(preset("laptop")) and network not in settings(preset("smoke"))
    assert network.choice(preset("laptop")).config == Setting("motion_guided").choice(preset("smoke")).config


def test_coarser_meshes_are_those_there_are():
    assert {b.coarser for b in budgets(preset("smoke"))} == {0} and {b.coarser for b in budgets(preset("laptop"))} == {
        0,
        1,
    }
    assert budgets(preset("desktop")) == BUDGETS


def test_a_run_of_a_setting_names_the_experiment_that_makes_it():
    record = {"kind": "evaluate", "identity": {"variant": "error-time:4_codes", "preset": "laptop"}}
    assert command(record) == "garmentbench evals error-time --preset laptop"


@pytest.mark.parametrize("study", [STUDY, WHOLE])
def test_what_failed_keeps_its_lines(study, tmp_path):
    work = study.work(preset("smoke"), 1)
    rows = work.rows({key: Failure("not", "run") for key in work.jobs})
    assert {row.status for row in rows} == {"failed"}
    points = len(settings(preset("smoke"))) + len(budgets(preset("smoke")))
    tables = [section.table for section in sections(study, rows, tmp_path)]
    assert [len(table.rows) for table in tables][::2][: len(study.scenes)] == [points] * len(study.scenes)
    assert all(len(row) == len(table.header) for table in tables for row in table.rows)
    assert "Too little ended well" in tables[0].caption


def sections(study, rows, folder):
    write_results(folder / "results.csv", rows)
    return study.sections(Results(read_results(folder / "results.csv"), folder))


def test_its_part_of_the_report(tmp_path):
    """Over two seeds the error has an interval; what broke stands in the table and in no comparison."""
    scene = Row("laptop", "error-time", "tshirt-armspace-90", "test", "tshirt", "armspace-90", horizon=150)

    def lines(method, variant, ms, error, seed=0, **further):
        row = replace(scene, method=method, variant=variant, seed=seed, **further)
        return [
            replace(row, metric="error", value=error, unit="cm", spread=0.5),
            *(
                replace(row, metric=m, value=ms, unit="ms")
                for m in ("ms_per_frame", "ms_per_frame_p95", "ms_processor")
            ),
        ]

    rows = lines("simulator", "explicit", 100, 0.5) + lines("simulator", "xpbd_16_substeps", 20, 1.2)
    rows += lines("simulator", "xpbd_8_substeps", 10, 9.0, status="broken", first_bad_frame=3)
    rows += lines("tuned", "full", 5, 0.8) + lines("tuned", "full", 5, 1.0, seed=1) + lines("skinning", "full", 2, 2.3)
    points, equal = sections(STUDY, rows, tmp_path)
    shown = {row[0].text: [cell.text for cell in row] for row in points.table.rows}
    assert shown["tuned"][1] == "0.90 ± 1.27" and shown["simulator, explicit"][-1] == "ok"
    assert "broken" in shown["simulator, xpbd 8 substeps"][-1] and shown["simulator, xpbd 16 substeps"][-2] == "tuned"
    # From 1.2 to 0.5 cm: 20 (100 / 20)^(0.3 / 0.7) = 39.9 ms.
    assert [cell.text for cell in equal.table.rows[0]] == ["tuned", "0.90 ± 1.27", "5.00", "39.9", "7.97"]
    assert len(points.pictures) == 1


def test_growth_with_the_mesh(tmp_path):
    """0.1 ms at 400 vertices, 100 times that at 4,000: the power is 2. One mesh that failed is left out."""
    about = Row("laptop", "error-time-whole", "tshirt-armspace-90", "test", "tshirt", method="tuned")
    rows = [
        replace(about, variant=f"full_on_{mesh}", metric=metric, value=value)
        for mesh, vertices, ms in (("smoke", 400, 0.1), ("laptop", 4000, 10.0))
        for metric, value in (("vertices", vertices), ("growth_ms", ms))
    ]
    rows.append(replace(about, variant="full_on_paper", metric="growth_ms", status="failed", run_id="(too large)"))
    (section,) = sections(WHOLE, rows, tmp_path)
    assert [cell.text for cell in section.table.rows[0]] == ["tuned", "0.10", "10.0", "2.00"]


def test_a_method_is_measured_over_the_first_frames(tmp_path):
    """10 cm off from frame 20 on: over 20 frames nothing is wrong, though it diverged at frame 25."""
    test = tiny_sequence(30)
    runs = np.stack([test.garment] * 2)
    sequence_file.save(replace(test, runs=runs, info=test.info | {"runs": [{}, {}]}), tmp_path / "test.h5")
    garment = test.garment.copy()
    garment[20:, :, 0] += 0.1
    garment[25:] = np.nan
    ms = np.tile([0.0, 2.0, 0.0], (30, 1))
    RollOut(ROLL_OUT, 3, garment, None, ms, "diverged", 25, "far").save(tmp_path / "rollout.h5")
    early, late = ({row.metric: row for row in method_rows(tmp_path, tmp_path / "test.h5", n)} for n in (20, 23))
    assert early["error"].value == pytest.approx(0, abs=1e-6) and early["error"].horizon == 20
    assert late["error"].value == pytest.approx(10 * 3 / 20, rel=1e-4) and late["error"].status == "ok"
    assert early["ms_per_frame"].value == 2.0
    assert method_rows(tmp_path, tmp_path / "test.h5", 30)[0].status == "diverged"


def test_the_reference_s_own_solver_errs_by_about_the_spread(home):
    """Real simulations of a few frames at toy size: to the reference's two runs it is a third."""
    scene = replace(load_scene("pleated_skirt-armspace-90"), frames=6)
    path = make_reference(scene, preset("smoke"), runs=2).path
    run = RunStore().get(simulator_run(path, scene, preset("smoke"), Budget("explicit"), 6, "error-time"))
    found = {row["metric"]: row for row in run.results["rows"]}
    assert run.results["status"] == "ok" and (run.folder / "report.npz").is_file()
    assert 0 < found["error"]["value"] < 3 * found["error"]["spread"]
    assert all(found[f"ms_{of}"]["value"] > 0 for of in ("per_frame", "per_frame_p95", "processor"))


def test_a_coarse_mesh_s_roll_out_is_of_the_full_mesh():
    """The skirt of 400 vertices, carried to that of 1,500: they hang at the same place."""
    scene = replace(load_scene("pleated_skirt-armspace-90"), frames=6)
    fine = load_garment("pleated_skirt", "laptop")
    still = Sequence(Template(fine, None, 30.0), np.repeat(fine.rest[None], 6, axis=0), None)
    roll = roll_out_of(scene, preset("laptop"), Budget("coarse", substeps=16, coarser=1), still, "cpu")
    assert roll.status == "ok" and roll.garment.shape == still.garment.shape and (roll.ms[:, 1] > 0).all()
    size = np.ptp(roll.garment[0], axis=0)
    assert np.abs(size[2] - np.ptp(fine.rest[:, 2])) < 0.1 and (size < 1.2).all()


def test_the_page_s_own_experiment_can_be_made(tmp_path, monkeypatch):
    page = Path(__file__).parents[3] / "docs" / "error-against-time.md"
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "times.py").write_text(page.read_text().split("```python\n")[1].split("```")[0])
    (experiment,) = read_experiments(tmp_path / "times.py")
    keys = experiment.work(preset("laptop"), 1).jobs
    assert {key[1] for key in keys if key[0] == "train"} == {"pleated_skirt@walk-dance"}


def test_beside_other_experiments_it_is_not_taken_for_finished(home):
    assert WHOLE.on_request and not STUDY.on_request and finished_rows(WHOLE, preset("smoke")) == []
