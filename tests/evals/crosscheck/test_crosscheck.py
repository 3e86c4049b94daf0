"""The cross-check: its runs, shared and reused, and its rows, with another engine made up for the purpose."""

import numpy as np
import pytest

from garmentbench.errors import UserError
from garmentbench.evals.crosscheck import study as crosscheck
from garmentbench.evals.crosscheck.match_material import Match
from garmentbench.evals.crosscheck.study import STUDY, VARIANTS, compare
from garmentbench.evals.crosscheck.vbd import VbdRun
from garmentbench.evals.experiment import finished_rows
from garmentbench.evals.run import run
from garmentbench.scenes.presets import PRESETS
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.storage.jobs import Failure

SMOKE = PRESETS["smoke"]
SHEET = "sheet-stick-b"
FULL, DOUBLED = VARIANTS


@pytest.fixture
def engine(monkeypatch, tmp_path):
    """An engine whose garment stays where it was put on, the study on the small sheet alone; gives the calls it got."""
    calls = []

    def stay(garment, start, obstacle, frames, fps, material, settings, vbd, step):
        calls.append(vbd)
        assert len(obstacle.positions) == frames
        return VbdRun(np.tile(start.astype(np.float32), (frames, 1, 1)), 600.0)

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("garmentbench.reference.sequence_path", lambda preset, scene: tmp_path / f"{scene}.h5")
    monkeypatch.setattr(crosscheck, "SCENES", (SHEET,))
    monkeypatch.setattr(crosscheck, "drive_vbd", stay)
    monkeypatch.setattr(crosscheck, "match", lambda material, settings, vbd, edge: Match(vbd, 0.004, -0.0125))
    return calls


def test_comparisons_share_the_other_engine_s_run_and_are_reused(engine):
    from dataclasses import replace

    doubled = replace(DOUBLED, scenes=(SHEET,))
    made = [compare(load_scene(SHEET), SMOKE, v) for v in (FULL, doubled)]
    assert [v.substeps for v in engine] == [25, 50]
    assert compare(load_scene(SHEET), SMOKE, FULL) == made[0] and len(engine) == 2 and len(set(made)) == 2


def test_rows_have_the_distance_its_doubt_and_the_match(engine):
    assert finished_rows(STUDY, SMOKE) == []
    compare(load_scene(SHEET), SMOKE, FULL)
    rows = finished_rows(STUDY, SMOKE)
    values = {(r.variant, r.metric): r for r in rows}
    plain = values["full", "difference"]
    assert plain.value > 1 and plain.unit == "cm" and plain.spread >= 0 and plain.method == "newton_vbd"
    assert values["full", "ms_per_frame"].value == 600 and 0 < values["full", "ms_per_frame"].reference_value < 600
    assert values["full", "match_hanging"].value == pytest.approx(0.4)
    assert values["full", "match_cantilever"].value == pytest.approx(1.25)
    assert ("full", "interpenetration") not in values  # there is no human body


def test_a_comparison_that_failed_keeps_its_row(engine):
    work = STUDY.work(SMOKE, 1)
    rows = work.rows({key: Failure("cross-check", "no such luck") for key in work.jobs})
    assert [r.status for r in rows] == ["failed"] and "no such luck" in rows[0].run_id


def test_without_newton_nothing_is_begun(monkeypatch, tmp_path):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UserError, match="pip install"):
        run(["crosscheck"], SMOKE, 1)
    assert not list(tmp_path.iterdir())
