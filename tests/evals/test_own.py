"""Experiments of the user's own, from a file in any folder to tables; and one line for what is wrong with a file."""

from dataclasses import replace

import pandas
import pytest

from garmentbench import sequence_file
from garmentbench.cli import main
from garmentbench.errors import UsageError
from garmentbench.evals.own import read_experiments
from garmentbench.evals.run import run_file
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.scenes.presets import preset
from garmentbench.storage.jobs import Failure

METHOD = """
from dataclasses import dataclass
from garmentbench.methods.baselines.untrained import Untrained


class {name}(Untrained):
    name = "{label}"

    def begin(self, template, history):
        return history.garments[-1]

    def step(self, state, body):
        return state, state
"""
TOML = """
train = ["sheet-stick-a"]  # or several
test = ["sheet-stick-b"]
entries = ["skinning", "still_water:StillWater"]
"""


def entry(more: str) -> str:
    """A file whose first entry says more than its method."""
    return TOML.replace('"skinning"', "{method = 'skinning', " + more + "}")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder of the user's, which is not the home folder."""
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "still_water.py").write_text(METHOD.format(name="StillWater", label="still_water"))
    monkeypatch.syspath_prepend(folder)  # put back after the test; read_experiments adds it by itself
    home = tmp_path / "home"
    home.mkdir()
    monkeypatch.chdir(home)
    return folder


def test_an_own_method_gets_into_a_table_by_a_declaration(folder, capsys):
    """Item 8, N3: the class's name is in rows and tables, and `runs` finds it."""
    (folder / "ponds.toml").write_text(TOML)
    assert main(["evals", str(folder / "ponds.toml"), "--preset", "smoke"]) == 0, capsys.readouterr()
    report = folder.parent / "home" / "reports" / "ponds-smoke"
    rows = pandas.read_csv(report / "results.csv")
    compared = rows[rows.experiment == "ponds"]
    another, compared = compared[compared.method == "another_run"], compared[compared.method != "another_run"]
    assert {"error", "rollout_l2", "push_growth"} <= set(another.metric)
    assert set(compared.method) == {"skinning", "still_water"} and set(compared.status) == {"ok"}
    assert set(compared.train_scenes) == {"sheet-stick-a"}
    table = (report / "tables" / "ponds-sheet-stick-b.md").read_text()
    assert "### Ponds: sheet, stick-b" in table and "\n| still water | " in table
    assert "still_water:StillWater" in (report / "runs.json").read_text()  # in the command that makes it
    capsys.readouterr()
    assert main(["runs", "kind=evaluate", "method=still_water"]) == 0
    assert capsys.readouterr().out.count("evaluate-") == 1
    before = {path: path.read_bytes() for path in report.rglob("*") if path.is_file()}
    assert main(["report", str(folder / "ponds.toml"), "--preset", "smoke"]) == 0
    assert before == {path: path.read_bytes() for path in report.rglob("*") if path.is_file()}
    run_file(folder / "ponds.toml", preset("smoke"))  # N9: repeating it changes no byte
    assert before == {path: path.read_bytes() for path in report.rglob("*") if path.is_file()}


def test_a_python_file_may_define_the_method_too(folder):
    (folder / "brooks.py").write_text(
        METHOD.format(name="Brook", label="brook")
        + "\nfrom garmentbench.evals.comparison import Comparison, Entry\n"
        + "EXPERIMENTS = (Comparison(name='brooks', table='brooks', title='Brooks', train=('sheet-stick-a',), "
        + "tests=('sheet-stick-b',), entries=(Entry(Brook),)),)\n"
    )
    (experiment,) = read_experiments(folder / "brooks.py")
    work = experiment.work(preset("smoke"), 1)
    assert [job.label for job in work.jobs.values() if job.key[0] == "train"] == ["train brook full on sheet-stick-a"]


def test_several_scenes_and_finished_files_serve_too(folder):
    info = {"scene": "far", "split": "test", "motion": "fall"}
    sequence_file.save(replace(tiny_sequence(20), info=info), folder / "own.h5")
    toml = TOML.replace('"sheet-stick-a"]', '"sheet-stick-a", "sheet-stick-b"]').replace(
        '["sheet-stick-b"]', '["own.h5"]'
    )
    (folder / "ponds.toml").write_text(toml)
    (experiment,) = read_experiments(folder / "ponds.toml")
    work = experiment.work(preset("smoke"), 1)
    failures = {key: Failure("not", "run") for key in work.jobs}
    assert {row.train_scenes for row in work.rows(failures)} == {"sheet-stick-a+sheet-stick-b"}
    assert {(row.scene, row.motion, row.split) for row in work.rows(failures)} == {("own", "fall", "test")}
    assert ("sequence", "sheet-stick-b") in work.jobs and ("sequence", "own") in work.jobs


def test_a_training_set_may_be_named(folder):
    """Its scenes are trained on together; rows call it by its name and count the frames of all of them."""
    toml = TOML.replace('"sheet-stick-a"]', '"dress@walk-dance"]').replace('["sheet-stick-b"]', '["dress-armspace-90"]')
    (folder / "ponds.toml").write_text(toml)
    (experiment,) = read_experiments(folder / "ponds.toml")
    work = experiment.work(preset("laptop"), 1)
    simulated = {key[1] for key in work.jobs if key[0] == "sequence"}
    assert simulated == {"dress-armspace-75", "dress-dance-latin", "dress-armspace-90"}
    rows = work.rows({key: Failure("not", "run") for key in work.jobs})
    assert {(row.train_scenes, row.train_frames) for row in rows} == {("dress@walk-dance", 1290)}


@pytest.mark.parametrize(
    ("name", "text", "complaint"),
    [
        ("a.toml", "train = 3", "a.toml: train is 3; wanted a list"),
        ("a.toml", "train = ['sheet-stick-a']", "a.toml: test, entries are missing"),
        ("a.toml", TOML + "sedes = 3", "a.toml: unknown key 'sedes': did you mean 'seeds'?"),
        ("a.toml", TOML + "seeds = 0", "a.toml: seeds is 0; wanted a whole number of at least 1"),
        ("a.toml", TOML + "seeds = '3'", "a.toml: seeds is '3'; wanted a whole number"),
        ("a.toml", TOML.replace('"skinning"', "3"), "a.toml: entries[0] is 3; wanted a text in quotes or a table"),
        ("a.toml", entry("variat = 'full'"), "unknown key of [entries[0]] 'variat': did you mean 'variant'?"),
        ("a.toml", entry("train_frames = 'all'"), "a.toml: entries[0].train_frames is 'all'; wanted a whole number"),
        (
            "a.toml",
            entry("train_frames = 100000"),
            "train_frames = 100000: sheet-stick-a has 1500 frames; wanted at most",
        ),
        ("a.toml", "train = [", "a.toml: "),
        ("a.toml", TOML + "colour = 1", "a.toml: unknown key 'colour'"),
        ("a.toml", TOML.replace("test", "tests"), "unknown key 'tests': did you mean 'test'?"),
        ("a.toml", TOML.replace("sheet-stick-b", "sheet-stik-b"), "did you mean 'sheet-stick-b'?"),
        ("a.toml", TOML.replace("skinning", "skining"), "did you mean 'skinning'?"),
        ("a.toml", TOML.replace("still_water:S", "stil_water:S"), "no module named 'stil_water'"),
        ("a.toml", TOML.replace('"skinning"', '"skinning", "skinning"'), "two entries are called 'skinning', full"),
        ("baselines.toml", TOML, "'baselines' is an experiment of the suite's own"),
        ("b1.py", "x = (", "b1.py:1: raised SyntaxError"),
        ("b2.py", "\n1 / 0", "b2.py:2: raised ZeroDivisionError: division by zero"),
        ("b3.py", "x = 1", "b3.py: has no EXPERIMENTS"),
        ("b4.py", "EXPERIMENTS = [1]", "b4.py: 1 in EXPERIMENTS is no Experiment"),
        ("json.py", "EXPERIMENTS = [1]", "another module is called 'json'"),
        ("absent.toml", None, "absent.toml: no such file"),
    ],
)
def test_what_is_wrong_with_a_file_is_one_line(folder, capsys, name, text, complaint):
    if text is not None:
        (folder / name).write_text(text)
    assert main(["evals", str(folder / name), "--preset", "smoke"]) == 2
    said = capsys.readouterr().err
    assert complaint in said and said.count("\n") == 1 and "Traceback" not in said


@pytest.mark.parametrize(
    ("name", "whose"), [("skinning", "as another method does"), ("another_run", "as the simulator's line")]
)
def test_a_method_that_takes_another_s_name_is_refused(folder, capsys, name, whose):
    (folder / f"{name}_thief.py").write_text(METHOD.format(name="Thief", label=name))
    (folder / "t.toml").write_text(
        TOML.replace("still_water:StillWater", f"{name}_thief:Thief").replace('"skinning", ', "")
    )
    assert main(["evals", str(folder / "t.toml"), "--preset", "smoke"]) == 2
    assert f"{name}_thief:Thief calls itself '{name}', {whose}" in capsys.readouterr().err


def test_one_file_and_nothing_beside_it(folder, capsys):
    (folder / "ponds.toml").write_text(TOML)
    assert main(["evals", "baselines", str(folder / "ponds.toml"), "--preset", "smoke"]) == 2
    assert "one file alone" in capsys.readouterr().err


def test_a_training_on_more_frames_than_a_file_has_is_refused(folder):
    """The label said "train 100000" of a training on 40."""
    sequence_file.save(tiny_sequence(20), folder / "own.h5")
    (folder / "f.toml").write_text(entry("train_frames = 21").replace('["sheet-stick-a"]', '["own.h5"]'))
    (experiment,) = read_experiments(folder / "f.toml")
    with pytest.raises(UsageError, match="train_frames = 21: own has 20 frames; wanted at most that"):
        experiment.work(preset("smoke"), 1)


def test_another_garment_is_refused_in_the_words_of_the_file(folder, capsys):
    """It said --train-scene, which `evals` does not have."""
    one = tiny_sequence(20)
    garment = replace(one.template.garment, name="cut_tube", faces=one.template.garment.faces[:-1])
    for name, sequence in {"one": one, "other": replace(one, template=replace(one.template, garment=garment))}.items():
        sequence_file.save(sequence, folder / f"{name}.h5")
    (folder / "g.toml").write_text(
        'train = ["one.h5"]\ntest = ["other.h5"]\nentries = [{method = "linear_subspace", train_frames = 20}]\n'
    )
    assert main(["evals", str(folder / "g.toml"), "--preset", "smoke"]) == 1
    said = capsys.readouterr().err
    assert "other has another garment" in said and "train = [...]" in said and "--train-scene" not in said
