"""A reference is made once, with as many runs as are wanted."""

from dataclasses import replace

import pytest

from garmentbench import reference, sequence_file
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.reference import make_reference
from garmentbench.scenes.presets import preset
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.wardrobe import load_scene

SMOKE = preset("smoke")


@pytest.fixture
def made(tmp_path, monkeypatch) -> list[int]:
    """How many runs were simulated, each time that something was."""
    counts = []

    def simulated(scene: Scene, size, runs: int):
        counts.append(runs)
        further = runs - 1
        info = {"runs": [{"name": "finer", "status": "ok"}] * further} if further else {}
        return replace(tiny_sequence(20, "object", runs=further), info=info)

    monkeypatch.setenv("GARMENTBENCH_HOME", str(tmp_path))
    monkeypatch.setattr(reference, "_simulated", simulated)
    return counts


def test_what_is_tested_on_has_four_runs_and_what_is_trained_on_one(made):
    stick_a, stick_b = load_scene("sheet-stick-a"), load_scene("sheet-stick-b")
    assert (stick_a.split, stick_b.split) == ("train", "test")
    for scene, runs in ((stick_a, None), (stick_b, 3)):
        path = make_reference(scene, SMOKE).path
        found = sequence_file.load(path).runs
        assert (None if found is None else len(found)) == runs
    assert made == [1, 4]
    assert make_reference(stick_b, SMOKE).reused and made == [1, 4]


def test_more_runs_than_there_are_make_it_anew_and_fewer_do_not(made):
    scene = load_scene("sheet-stick-b")
    make_reference(scene, SMOKE, runs=1)
    assert not make_reference(scene, SMOKE).reused and made == [1, 4]
    assert not make_reference(scene, SMOKE, runs=8).reused and made == [1, 4, 8]
    assert make_reference(scene, SMOKE).reused and make_reference(scene, SMOKE, runs=2).reused
    assert len(sequence_file.load(make_reference(scene, SMOKE).path).runs) == 7


def test_settings_are_chosen_on_one_run(made):
    make_reference(replace(load_scene("sheet-stick-b"), name="stick-v", split="validation"), SMOKE)
    assert made == [1]
