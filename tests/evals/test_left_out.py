"""What leaving out saves is measured once and kept, and what a lean build leaves out is not there."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pandas
import pytest

from garmentbench import sequence_file
from garmentbench.evals.left_out import costs, simulator, study, table
from garmentbench.evals.left_out.otherwise import (
    VARIANTS,
    OtherwiseMotionGuided,
    config_for,
    said,
    seeds_everywhere,
)
from garmentbench.evals.left_out.study import LEAVING_OUT, LEAVING_OUT_WHOLE
from garmentbench.evaluation.rollout import roll_out
from garmentbench.evaluation.score import score
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.geometry.seeds import select_seeds
from garmentbench.methods.motion_guided.canonical import Canonical
from garmentbench.pipeline.train import training_run
from garmentbench.reference import scene_template
from garmentbench.report.lines import Results
from garmentbench.scenes.presets import MESH_SIZES, preset
from garmentbench.scenes.wardrobe import load_scene

SMOKE = preset("smoke")


def test_a_measurement_is_kept(home, monkeypatch):
    """N9: repeated `evals` wrote other times into results.csv."""
    sequence_file.save(tiny_sequence(40), home / "a.h5")
    calls = []
    monkeypatch.setattr(costs, "cost_rows", lambda *_: [costs.row("part_radii", len(calls), "ms")])
    monkeypatch.setattr(simulator, "simulator_rows", lambda *_: [])
    scene = load_scene("sheet-stick-b")
    made = study.left_out(home / "a.h5", scene, SMOKE)
    calls.append(1)
    assert study.left_out(home / "a.h5", scene, SMOKE) == made
    work = LEAVING_OUT.work(SMOKE, 1)
    rows = work.rows({key: made for key in work.jobs if key[0] == study.LEFT_OUT})
    assert [(row.metric, row.value, row.unit) for row in rows] == [("left_out:part_radii", 0.0, "ms")] * 2


def _fitted(tmp_path, part: str, built: bool):
    """A model of a human scene with a part built or left out, hardly trained, and the names of its stages."""
    config = costs.shortened(replace(config_for("smoke"), part=part, built=built), 0.0)
    run = training_run(tmp_path / f"{part}-{built}")
    method = OtherwiseMotionGuided.fit((tiny_sequence(8),), config, run)
    return method, {path.name.split("-")[0] for path in (tmp_path / f"{part}-{built}").iterdir()}


def test_what_is_left_out_of_a_network_is_not_there(tmp_path):
    with_force, _ = _fitted(tmp_path, "interaction_force", True)
    without, stages = _fitted(tmp_path, "interaction_force", False)
    gone = set(with_force.dynamics.state_dict()) - set(without.dynamics.state_dict())
    assert gone and all(name.startswith("motion_block.") for name in gone) and "sdf" in stages
    assert "sdf" not in _fitted(tmp_path, "sdf", False)[1]
    assert len(_fitted(tmp_path, "part_radii", False)[0].generative.log_radii) == 1


def test_a_stage_that_is_left_out_is_not_timed_and_has_no_columns(tmp_path):
    sequence = tiny_sequence(8)
    lean = replace(sequence, template=said(sequence.template, "interpenetration", False))
    method, _ = _fitted(tmp_path, "collision_stage", False)
    roll = roll_out(method, sequence)
    assert roll.before_collision is None and not np.nansum(roll.ms[:, 2])
    columns = {row.metric for row in score(roll, None, sequence)} - {row.metric for row in score(roll, None, lean)}
    assert {"interpenetration", "interpenetration_strict", "faces_inside"} <= columns


def test_what_needs_no_body_surface_does_not_import_it():
    """In a fresh interpreter: describing a stick's needs brings no network, no SDF and no simulator's kernels."""
    code = (
        "import sys; from garmentbench.needs import of_template; from garmentbench.reference import scene_template; "
        "from garmentbench.scenes.wardrobe import load_scene; from garmentbench.scenes.presets import MESH_SIZES; "
        "of_template(scene_template(load_scene('sheet-stick-b'), MESH_SIZES['smoke'])); "
        "print([m for m in ('torch', 'warp', 'rerun', 'garmentbench.geometry.signed_distance') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.strip() == "[]"


def test_seeds_on_the_whole_body_are_more_and_farther():
    template = scene_template(load_scene("pleated_skirt-armspace-90"), MESH_SIZES["smoke"])
    near, everywhere = select_seeds(template, 40), seeds_everywhere(template, 40)
    top = template.garment.rest[:, 2].max() + 0.3
    assert len(near.rest) == 40 and near.rest[:, 2].max() < top
    assert len(everywhere.rest) > 80 and everywhere.rest[:, 2].max() > top


def test_only_trainings_that_nothing_else_tells_apart_are_marked():
    template = tiny_sequence(4).template
    assert said(template, "velocity", False).needs == template.needs
    assert vars(said(template, "velocity", False).body) == vars(template.body)  # so that stages are shared
    assert "said" in vars(said(template, "sdf", False).body)
    assert not said(template, "sdf", False).needs.body and Canonical.of(template, config_for("smoke").model)
    assert VARIANTS["no_sdf"](config_for("smoke")).part == "sdf"


def test_the_whole_is_on_request_and_asks_for_both_ways():
    stick = LEAVING_OUT_WHOLE.comparisons(SMOKE)[-2]
    assert LEAVING_OUT_WHOLE.on_request and not LEAVING_OUT.comparisons(SMOKE)
    variants = {entry.variant for entry in stick.entries}
    assert {"full", "no_interaction_force", "with_sdf", "with_collision_stage", "with_part_radii"} <= variants


def test_the_table_pairs_seeds_and_names_what_changes_nothing(tmp_path, monkeypatch):
    """Errors 1.0, 1.2, 1.1 with and 1.1, 1.3, 1.2 without: +0.1 in each, so the interval is nothing."""
    columns = {"preset": "smoke", "experiment": "x", "scene": "a", "split": "test", "run_id": "", "spread": np.nan}
    about = {"method": OtherwiseMotionGuided.name, "metric": "rollout_l2", "horizon": 40, "unit": "cm"}
    rows = [
        columns | about | {"variant": variant, "seed": seed, "value": value}
        for variant, values in (("full", (1.0, 1.2, 1.1)), ("no_velocity", (1.1, 1.3, 1.2)))
        for seed, value in enumerate(values)
    ]
    for part, value, unit in (("velocity", 2.0, "ms"), ("self_contact", 0.01, "cm")):
        measured = {"method": "reference", "metric": f"left_out:{part}", "unit": unit, "value": value, "run_id": "r"}
        rows.append(columns | {"variant": "full", "seed": 0, "horizon": np.nan, "spread": 0.05} | measured)
    results = Results(pandas.DataFrame(rows), tmp_path)
    kept = [
        {"name": "velocity", "needed": True, "because": "w"},
        {"name": "self_contact", "needed": True, "because": "w"},
    ]
    monkeypatch.setattr(results, "record", lambda run: {"results": {"parts": kept}})
    made = table.left_out_table("x", "t", results)
    velocity, contact = ([cell.text for cell in row] for row in made.rows)
    assert velocity[:5] == ["a", "velocity", "yes", "w", "2.00"] and velocity[-3:] == ["1.10", "1.20", "0.10 ± < 0.01"]
    assert contact[-1] == "0.01 (0.05)" and "changes nothing that can be told: self contact on a." in made.caption


@pytest.mark.parametrize(("built", "left"), [({0: 1.0}, {0: float("nan")}), ({}, {})])
def test_a_failed_training_is_a_line_that_says_so(built, left):
    cells, changes = table._compared(built, left)
    assert cells[-1].bad and changes is None
