"""Training on one or more scenes and evaluating, as typed.

Names resolved once, other garments refused, failures told.
"""

import shutil
from dataclasses import replace

import numpy as np
import pytest

from garmentbench import sequence_file
from garmentbench.cli import main
from garmentbench.errors import UsageError
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.methods import load_method
from garmentbench.pipeline.choice import choose_method, default_training_scene
from garmentbench.pipeline.train import train
from garmentbench.reference import resolve_source
from garmentbench.scenes.presets import preset
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.storage.runs import RunStore

SMALL = ("--preset", "smoke", "--frames", "20")


@pytest.fixture
def files(tmp_path, monkeypatch):
    """Three sequences of one garment and one of another, as files; runs go to an empty place. Their names by role."""
    monkeypatch.chdir(tmp_path)
    sequences = {"one": tiny_sequence(20), "two": tiny_sequence(20, phase=1.0), "test": tiny_sequence(20, phase=2.0)}
    garment = sequences["one"].template.garment
    cut = replace(garment, name="cut_tube", faces=garment.faces[:-1])
    sequences["other"] = replace(sequences["one"], template=replace(sequences["one"].template, garment=cut))
    sequences["object"] = tiny_sequence(20, "object")
    for name, sequence in sequences.items():
        sequence_file.save(sequence, tmp_path / f"{name}.h5")
    return tmp_path


def typed(capsys, *arguments: str) -> tuple[int, str, list[str]]:
    code = main(arguments)
    out, err = capsys.readouterr()
    return code, out, err.splitlines()


def test_several_training_scenes_are_typed_one_by_one(files, capsys):
    scenes = ("--train-scene", "one.h5", "--train-scene", "two.h5", "--scene", "test.h5")
    code, _, lines = typed(capsys, "evaluate", "linear_subspace", *scenes, *SMALL)
    assert code == 0, lines
    store = RunStore()
    trained, evaluated = store.list({"kind": "train"})[0], store.list({"kind": "evaluate"})[0]
    assert trained.identity["train_scenes"] == evaluated.identity["train_scenes"] == ["one", "two"]
    assert typed(capsys, "train", "linear_subspace", "--scene", "one.h5", "--scene", "two.h5", *SMALL)[0] == 0
    assert len(store.list({"kind": "train"})) == 1  # the same training
    assert "one+two" in typed(capsys, "runs")[1]


def test_of_scenes_in_a_training_set_as_many_frames_are_taken_as_it_says(files, monkeypatch):
    """... and of others as many as are asked for."""
    seen = []
    choice, size = choose_method("hold", "full", preset("smoke")), preset("smoke")
    monkeypatch.setattr(choice.method, "fit", classmethod(lambda cls, train, c, r: seen.extend(train) or cls(c)))
    sources = [resolve_source("one.h5"), resolve_source("two.h5")]
    run = train(choice, sources, size, 12, 0, RunStore(), {"two": 15})
    assert [len(sequence) for sequence in seen] == [12, 15] and run.identity["train_frames"] == [12, 15]
    assert train(choice, sources, size, 12, 0, RunStore(), {"two": 12}).identity["train_frames"] == 12


@pytest.mark.parametrize("option", ["--scene", "--train-scene"])
def test_a_training_set_that_does_not_exist_is_told(files, capsys, option):
    command = ("train", "hold") if option == "--scene" else ("evaluate", "hold")
    code, out, lines = typed(capsys, *command, option, "dress@vried", *SMALL)
    assert code == 2 and out == "" and len(lines) == 1 and "did you mean 'varied'" in lines[0]


def test_training_scenes_of_different_garments_are_refused_by_name(files, capsys):
    code, _, lines = typed(capsys, "train", "hold", "--scene", "one.h5", "--scene", "other.h5", *SMALL)
    assert code == 1 and len(lines) == 1
    assert "the garment of one (tube, 105 vertices) is not that of other (cut_tube, 105 vertices)" in lines[0]
    code, _, lines = typed(capsys, "train", "hold", "--scene", "one.h5", "--scene", "object.h5", *SMALL)
    assert code == 1 and "the body of one (human" in lines[0]


def test_a_method_trained_on_another_garment_is_refused_before_it_is_rolled_out(files, capsys):
    code, out, lines = typed(
        capsys, "evaluate", "linear_subspace", "--train-scene", "one.h5", "--scene", "other.h5", *SMALL
    )
    assert code == 1 and out == "" and len(lines) == 1
    assert "trained on one (tube, 105 vertices), but other has another garment (cut_tube" in lines[0]
    assert "--train-scene" in lines[0]
    assert not RunStore().list({"kind": "evaluate", "state": "finished"})
    scenes = ("--train-scene", "one.h5", "--scene", "other.h5")
    assert typed(capsys, "evaluate", "skinning", *scenes, *SMALL)[0] == 0, "skinning learns nothing of a garment"


@pytest.mark.parametrize(
    ("scene", "trained_on"),
    [
        ("tshirt-armspace-90", "tshirt-armspace-75"),
        ("dress-armspace-90", "dress-armspace-75"),
        ("over_skirt-armspace-90", "over_skirt-armspace-75"),
        ("sheet-stick-b", "sheet-stick-a"),
    ],
)
def test_the_training_scene_follows_from_the_garment_of_the_test_scene(scene, trained_on):
    assert default_training_scene(load_method("linear_subspace"), load_scene(scene)) == load_scene(trained_on)


def test_a_garment_without_a_training_scene_needs_one_to_be_named(files):
    with pytest.raises(
        UsageError, match="no training scene has the garment 'tube' of one; give one with --train-scene"
    ):
        default_training_scene(load_method("linear_subspace"), resolve_source("one.h5"))
    assert default_training_scene(load_method("skinning"), resolve_source("one.h5")).name == "one"


def test_the_class_is_called_by_its_name_in_runs_and_tables(files, capsys):
    scenes = ("--train-scene", "one.h5", "--scene", "test.h5")
    assert typed(capsys, "evaluate", "foreign_methods:Good", *scenes, *SMALL)[0] == 0
    out = typed(capsys, "runs", "method=good")[1]
    assert out.count("good full one") == 2 and "foreign_methods" not in out


def test_what_must_be_known_of_a_number_stands_beside_it(files, capsys):
    """The reference's own value and spread (N2), a method that reads the reference (N7), a time under load
    (N12)."""
    test = sequence_file.load(files / "test.h5")
    another = test.garment[None] + np.float32([0.0025, 0, 0])
    sequence_file.save(replace(test, runs=another), files / "test.h5")
    scenes = ("--train-scene", "one.h5", "--scene", "test.h5")
    _, out, _ = typed(capsys, "evaluate", "foreign_methods:KnowsTheAnswer", *scenes, *SMALL)
    rows = {line.split()[0]: line.split() for line in out.splitlines()}
    assert "spread" in rows["metric"] and rows["rollout_l2"][2:4] == ["0", "0.25"]
    assert float(rows["strain_p95"][-2]) > 0 and rows["liveliness"][-2] == "1"
    assert rows["error"][2:4] == ["0.125", "0.25"] and rows["error_over_spread"][2] == "0.5"
    assert "warning: " in out and "exactly the reference: no prediction hits" in out, out
    _, out, _ = typed(capsys, "evaluate", "foreign_methods:Waits", *scenes, *SMALL)
    assert "exactly the reference" not in out
    assert "warning: ms_per_frame, ms_per_frame_p95" in out and "timed under load: wall time is far above" in out
    run = RunStore().list({"kind": "evaluate", "class": "foreign_methods:Waits"})[0]
    out = typed(capsys, "runs", "--compare", run.id, run.id)[1]
    assert "timed under load" in out


def test_a_module_in_the_working_folder_is_found(files, monkeypatch):
    (files / "my_module.py").write_text("from foreign_methods import Good\n\nclass Mine(Good):\n    name = 'mine'\n")
    monkeypatch.setattr("sys.path", [p for p in __import__("sys").path if p not in ("", str(files))])
    choice = choose_method("my_module:Mine", "full", preset("smoke"))
    assert (choice.name, choice.variant, choice.random) == ("mine", "full", False)


def test_a_diverged_roll_out_is_a_result_and_a_failed_one_an_error(files, capsys):
    scenes = ("--train-scene", "one.h5", "--scene", "test.h5")
    code, out, lines = typed(capsys, "evaluate", "foreign_methods:NaN", *scenes, *SMALL)
    assert code == 0 and "rollout_l2" in out and "good diverged at frame 7 of test: 105 of 105 vertices" in lines[-1]
    code, out, lines = typed(capsys, "evaluate", "foreign_methods:Raises", *scenes, *SMALL)
    assert code == 1 and "rollout_l2" in out and "good failed at frame 7 of test: raised ZeroDivision" in lines[-1]
    assert np.isnan([r["value"] for r in RunStore().list({"kind": "evaluate"})[-1].results["rows"]]).any()


def test_a_class_without_a_file_is_told_to_have_one(monkeypatch):
    class Cell(load_method("hold")):
        __module__ = "__main__"

    with pytest.raises(UsageError, match="write it into my_module.py and name it"):
        choose_method(Cell, "full", preset("smoke"))


def test_training_and_evaluating_from_python(files):
    import garmentbench as gb

    one, two, test = (gb.SequenceFile(files / f"{name}.h5") for name in ("one", "two", "test"))
    size, store = gb.preset("smoke"), gb.RunStore(files / "elsewhere")
    trained = gb.train(gb.choose_method("linear_subspace", "full", size), (one, two), size, 20, 0, store)
    run = gb.evaluate(trained, test, size, store)
    assert run.results["status"] == "ok" and run.identity["train_scenes"] == ["one", "two"]
    assert not (files / "runs").exists()


@pytest.mark.parametrize(("name", "doing"), [("Fit", "fit"), ("Load", "load"), ("Begin", ""), ("Step", "")])
def test_a_method_that_exits_has_raised(files, capsys, name, doing):
    """sys.exit(0) in a method ended everything with exit code 0 and without a word."""
    scenes = ("--train-scene", "one.h5", "--scene", "test.h5")
    code, _, lines = typed(capsys, "evaluate", f"foreign_methods:{name}Exits", *scenes, *SMALL)
    assert code == 1 and f"{doing} raised SystemExit: 0 (".strip() in lines[-1]


def test_a_step_that_returns_no_state_is_told_so(files, capsys):
    scenes = ("--train-scene", "one.h5", "--scene", "test.h5")
    code, _, lines = typed(capsys, "evaluate", "foreign_methods:ForgetsTheState", *scenes, *SMALL)
    assert code == 1 and lines[-1].endswith("frame 3 of test: step returned one array; return (positions, state)")


@pytest.mark.parametrize(
    ("method", "noted"), [("linear_subspace", True), ("foreign_methods:Good", True), ("hold", False)]
)
def test_a_test_on_a_training_scene_is_noted(files, capsys, method, noted):
    """By name or by content; a method that learns nothing is exempt."""
    shutil.copy(files / "one.h5", files / "same.h5")
    for learnt in ("one.h5", "same.h5"):
        scenes = ("--train-scene", learnt, "--train-scene", "two.h5", "--scene", "one.h5")
        code, out, _ = typed(capsys, "evaluate", method, *scenes, *SMALL)
        assert code == 0 and ("trained on this scene: a training error" in out) == noted
    out = typed(capsys, "evaluate", method, "--train-scene", "two.h5", "--scene", "test.h5", *SMALL)[1]
    assert "trained on this scene" not in out
    run = next(r for r in RunStore().list({"kind": "evaluate"}) if r.identity["train_scenes"] == ["same", "two"])
    notes = {row["metric"]: row["note"] for row in run.results["rows"]}
    assert ("trained on this scene" in notes["rollout_l2"]) == noted and "trained" not in notes["ms_per_frame"]


def test_a_configuration_that_can_not_be_made_is_one_line(tmp_path, monkeypatch, capsys):
    (tmp_path / "odd_config.py").write_text(
        "from dataclasses import dataclass\n"
        "from foreign_methods import Good\n\n\n"
        "@dataclass(frozen=True)\nclass Config:\n    width: int = 3\n\n"
        "    def __post_init__(self):\n        raise ValueError('width is odd')\n\n\n"
        "class Odd(Good):\n    name, Config = 'odd', Config\n"
    )
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    code, _, lines = typed(capsys, "train", "odd_config:Odd", "--scene", "sheet-stick-a", *SMALL)
    assert code == 2 and len(lines) == 1, lines
    assert "odd: its configuration 'full' raised ValueError: width is odd (odd_config.py:10)" in lines[0]
