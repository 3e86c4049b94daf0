"""The convergence study: what each run changes, the numbers on a case that can be computed, and its rows."""

import math
from dataclasses import replace

import numpy as np
import pytest

from garmentbench.evals.convergence import study as convergence
from garmentbench.evals.convergence.study import VARIANTS, changed, distances, simulate_variant
from garmentbench.evals.convergence.table import CHOSEN, FINEST, OTHER_CLOTH, observed_order
from garmentbench.scenes.material import Settings
from garmentbench.scenes.presets import PRESETS
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.storage.jobs import Failure
from garmentbench.storage.runs import UnfinishedError, only_finished

SMOKE = PRESETS["smoke"]
SHEET = "sheet-stick-b"


def oscillator(substeps: int, frames: int = 30) -> np.ndarray:
    """A mass on a spring (3 Hz, 30 frames a second) by symplectic Euler; positions [m], shape (T, 1, 3)."""
    dt, square, x, v, found = 1 / 30 / substeps, (2 * np.pi * 3) ** 2, 0.1, 0.0, []
    for _ in range(frames):
        for _ in range(substeps):
            v -= dt * square * x
            x += dt * v
        found.append(x)
    return np.array(found)[:, None, None] * np.array([0.0, 0.0, 1.0])


def test_the_study_finds_the_order_of_symplectic_euler():
    finest = oscillator(8 * 16)
    errors = [distances(oscillator(k * 16), finest)["difference"][0] for k in (1, 2, 4)]
    assert errors[0] > errors[1] > errors[2]
    assert errors[1] / errors[2] == pytest.approx(3, rel=0.1)  # (1/2 - 1/8) / (1/4 - 1/8)
    assert observed_order(errors[0], errors[2]) == pytest.approx(1, abs=0.1)


def test_a_run_that_ended_early_has_no_difference():
    value, unit = distances(oscillator(16, 20), oscillator(16, 30))["difference"]
    assert math.isnan(value) and unit == "cm"


def test_a_scene_s_own_settings_are_multiplied_not_replaced():
    scene = replace(load_scene(SHEET), simulation=Settings(substep_factor=2, start_noise=0.01, queries=16))
    finer, preset = changed(scene, SMOKE, VARIANTS["substeps_x4"])
    assert preset == SMOKE
    assert finer.simulation == Settings(substep_factor=8, start_noise=0.01, queries=16)
    assert changed(scene, SMOKE, VARIANTS["start_1mm"])[0].simulation.start_noise == pytest.approx(0.011)
    assert finer.frames == convergence.FRAMES
    assert changed(scene, SMOKE, VARIANTS["queries_x8"])[0].simulation.queries == 128
    assert changed(scene, SMOKE, VARIANTS["drag_half"])[0].material == replace(scene.material, drag=0.6)
    assert changed(scene, SMOKE, VARIANTS["body_full"])[1].mesh.body_size == "full"


def test_both_layers_are_changed():
    scene = changed(load_scene("over_skirt-armspace-90"), SMOKE, VARIANTS["bending_double"])[0]
    plain = load_scene("over_skirt-armspace-90")
    assert scene.worn_over is not None and plain.worn_over is not None
    for one, other in ((scene, plain), (scene.worn_over, plain.worn_over)):
        assert one.material.bending == 2 * other.material.bending


def test_what_is_compared_with_what():
    assert {v.name: v.compared_with for v in VARIANTS.values()} == {
        CHOSEN: FINEST,
        "substeps_x2": FINEST,
        "substeps_x4": FINEST,
        FINEST: FINEST,
        **dict.fromkeys(("queries_x8", "start_1um", "start_1mm", "start_1cm", "mesh_fine", *OTHER_CLOTH), CHOSEN),
    }


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """A study of the smallest sheet, really run in some of the ways, but for one run that failed."""
    some = {name: VARIANTS[name] for name in (CHOSEN, "substeps_x2", "substeps_x4", FINEST, "mesh_fine", "drag_half")}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("home"))
        patch.setattr(convergence, "SCENES", (SHEET,))
        patch.setattr(convergence, "VARIANTS", some)
        made = {
            ("convergence", SHEET, name): simulate_variant(load_scene(SHEET), SMOKE, variant)
            for name, variant in some.items()
            if name != "substeps_x4"
        }
        made["convergence", SHEET, "substeps_x4"] = Failure("substeps_x4", "no such luck")
        yield made


def test_rows_of_a_real_study(results):
    rows = convergence.STUDY.work(SMOKE, 1).rows(results)
    values = {(r.variant, r.metric): r.value for r in rows}
    assert {v for v, _ in values} == set(convergence.VARIANTS)
    assert values[FINEST, "substeps"] == 8 * values[CHOSEN, "substeps"]
    assert 0 < values["substeps_x2", "difference"] < 1.0 and (FINEST, "difference") not in values
    assert 0 < values["mesh_fine", "difference"] < 5.0
    assert values["mesh_fine", "substeps"] > values[CHOSEN, "substeps"]
    assert all(r.method == "reference" and r.run_id for r in rows)
    assert {r.status for r in rows} == {"ok", "failed"}


def test_a_failed_run_keeps_its_row(results):
    row = next(r for r in convergence.STUDY.work(SMOKE, 1).rows(results) if r.variant == "substeps_x4")
    assert row.status == "failed" and math.isnan(row.value) and "no such luck" in row.run_id


def test_what_is_finished_is_reused_and_found_without_running(results):
    again = simulate_variant(load_scene(SHEET), SMOKE, VARIANTS[CHOSEN])
    assert again == results["convergence", SHEET, CHOSEN]
    for key, job in convergence.STUDY.work(SMOKE, 1).jobs.items():
        with only_finished():
            if isinstance(results[key], Failure):
                with pytest.raises(UnfinishedError):
                    job.call(*job.arguments)
            else:
                assert job.call(*job.arguments) == results[key]
