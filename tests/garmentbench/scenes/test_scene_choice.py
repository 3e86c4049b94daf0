"""Scenes: every file in datasets/scenes, the grid they make up, and choosing among them as it is typed."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from garmentbench import sequence_file
from garmentbench.cli import main
from garmentbench.errors import UsageError
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.motion import human_motions, motion_names
from garmentbench.reference import Reference, reference_identity
from garmentbench.scenes.bodies import body_names
from garmentbench.scenes.choice import choose_scenes
from garmentbench.scenes.garments import garment_names
from garmentbench.scenes.presets import preset
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.wardrobe import load_scene, scene_names, wardrobe


@pytest.mark.parametrize("name", scene_names())
def test_every_scene_holds_what_there_is(name):
    scene = load_scene(name)
    assert scene.garment in garment_names() and scene.body in {*body_names(), "stick"}
    assert scene.motion.name in motion_names()
    if not name.startswith(("sheet-", "laid_sheet-")):
        assert name.startswith(f"{scene.garment}-{scene.motion.name}") and name.endswith(scene.body) == (
            scene.body != "base"
        )


@pytest.mark.parametrize(
    ("words", "names"),
    [
        (["sheet-*"], ["sheet-stick-a", "sheet-stick-b", "sheet-stick-c"]),
        (["sheet-*", "split=train"], ["sheet-stick-a"]),
        (["garment=sheet"], ["sheet-stick-a", "sheet-stick-b", "sheet-stick-c"]),
        (["laid*"], ["laid_sheet-stick-swing-a", "laid_sheet-stick-swing-b"]),
        (["split=validation", "garment=dress"], ["dress-armspace-60", "dress-dance-latin-held"]),
        (["garment=tshirt", "motion=dance-*", "body=slim"],
         [f"tshirt-dance-{dance}-slim" for dance in ("bounce", "latin-late", "latin", "spin")]),
        (["tshirt-run", "tshirt-r*-tall", "tshirt-jump"], ["tshirt-run", "tshirt-run-tall", "tshirt-jump"]),
    ],
)  # fmt: skip
def test_words_choose_scenes(words, names):
    assert [scene.name for scene in choose_scenes(words)] == names


def test_a_wardrobe_may_name_every_motion_of_the_human(tmp_path, monkeypatch):
    """Motions of the user's own grid are checked against those of the suite's scenes, which have them all."""
    monkeypatch.chdir(tmp_path)
    entries = [
        f"{name} = {{split = 'test', frames = 9}}\n" for name in human_motions() if name not in wardrobe().motions
    ]
    (tmp_path / "wardrobe.toml").write_text("[motions]\n" + "".join(entries))
    assert {entry.motion or name for name, entry in wardrobe().motions.items()} == set(human_motions()) and entries


def test_no_words_choose_all():
    assert choose_scenes([]) == [load_scene(name) for name in scene_names()]


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["x-*"], "no scene fits 'x-*'"),
        (["bdy=slim"], "did you mean 'body'"),
        (["tshirt-rn"], "did you mean 'tshirt-run'"),
        (["garment=cape"], "no scene fits garment=cape"),
    ],
)
def test_words_that_fit_nothing_are_told(words, complaint):
    with pytest.raises(UsageError) as error:
        choose_scenes(words)
    assert complaint in str(error.value)


def typed(capsys, *arguments: str) -> tuple[int, str, str]:
    return main(arguments), *capsys.readouterr()


def test_scenes_lists_by_filter_and_shows_by_name(capsys, tmp_path):
    code, out, _ = typed(capsys, "scenes", "garment=sheet", "split=test")
    assert code == 0 and [line.split()[0] for line in out.splitlines()] == ["scene", "sheet-stick-b"]
    code, shown, _ = typed(capsys, "scenes", "show", "tshirt-run")
    assert code == 0 and "motion: run\n" in shown and "left out: pins" in shown
    assert typed(capsys, "scenes", "tshirt-run") == (0, shown, "")
    far = tmp_path / "far.toml"
    placed = 'motion = {name = "armspace-90", translate = [1000.0, 0.0, 0.0], turn = 90.0}'
    far.write_text(f'garment = "tshirt"\nbody = "base"\nsplit = "test"\nframes = 150\n{placed}\n')
    code, out, _ = typed(capsys, "scenes", "show", str(far))
    assert "motion: armspace-90, translate (1000.0, 0.0, 0.0), turn 90.0\n" in out


def test_a_scene_that_was_simulated_says_whether_it_is_contracting_or_chaotic(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("GARMENTBENCH_HOME", str(tmp_path))
    assert "simulated" not in typed(capsys, "scenes", "show", "sheet-stick-b")[1]
    identity = reference_identity(load_scene("sheet-stick-b"), preset("smoke"))
    runs = [{"name": name, "status": "ok"} for name in ("pushed_warm_up", "pushed_frame_0", "finer")]
    info = {"made_from": identity, "runs": runs, "ensemble": {"spread_cm": 0.523, "push_growth": 14.4}}
    save(tmp_path / "sequences" / "smoke", info)
    save(tmp_path / "sequences" / "laptop", {"made_from": "another"})
    (tmp_path / "sequences" / "paper").mkdir()
    (tmp_path / "sequences" / "paper" / "sheet-stick-b.h5").write_bytes(b"")
    lines = [line for line in typed(capsys, "scenes", "show", "sheet-stick-b")[1].splitlines() if "simulated" in line]
    assert lines[0] == ("simulated, smoke: 4 runs, spread 0.52 cm, chaotic: a push of 1 mm is 14 mm in the last fifth")
    assert lines[1] == "simulated, laptop (of another scene or code): one run"
    assert lines[2].startswith("simulated, paper: ") and "an empty file" in lines[2] and len(lines) == 3


def save(folder: Path, info: dict) -> None:
    folder.mkdir(parents=True)
    sequence_file.save(replace(tiny_sequence(), info=info), folder / "sheet-stick-b.h5")


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["scenes", "show"], "which scene?"),
        (["scenes", "show", "tshirt-rn"], "did you mean 'tshirt-run'"),
        (["simulate", "tshirt-rn*"], "no scene fits 'tshirt-rn*'"),
        (["simulate", "--all", "--runs", "0"], "--runs is 0; wanted at least 1"),
        (["simulate", "--all", "--jobs", "0"], "--jobs is 0; wanted at least 1"),
        (["bodies", "bake"], "--name mine"),
        (["bodies", "bake", "--name", "mine", "--height", "3"], "--height is 3; wanted from 0 to 1"),
        (["bodies", "bak"], "bak"),
    ],
)
def test_wrong_calls(capsys, arguments, complaint):
    code, out, err = typed(capsys, *arguments)
    assert code == 2 and out == "" and complaint in err and len(err.splitlines()) == 1


def test_bodies_lists_height_and_volume(capsys):
    code, out, _ = typed(capsys, "bodies")
    rows = {line.split()[0]: line.split()[1:] for line in out.splitlines()[1:]}
    assert code == 0 and rows["base"][0] == "1.838" and float(rows["slim"][1]) < float(rows["heavy"][1])


def test_many_scenes_are_simulated_at_once_and_kept(tmp_path, monkeypatch, capsys):
    """Each in a process of its own, which writes where this one would; those that fail are told."""
    monkeypatch.setattr("garmentbench.reference.make_reference", _pretend)
    monkeypatch.chdir(tmp_path)
    code, out, _ = typed(capsys, "simulate", "sheet-stick-[ab]", "--preset", "smoke", "--jobs", "2")
    assert code == 0 and out.splitlines() == [f"smoke/sheet-stick-{k}.h5: spread 0.12 cm, contracting" for k in "ab"]
    code, _, err = typed(capsys, "simulate", "tshirt-run", "sheet-stick-a", "--preset", "smoke", "--jobs", "2")
    assert (
        code == 1 and "1 of 2 failed, the first: simulate tshirt-run: ValueError: no T-shirts" in err.splitlines()[-1]
    )


def _pretend(scene: Scene, preset, runs: int | None) -> Reference:
    if scene.garment == "tshirt":
        raise ValueError("no T-shirts")
    path = Path(preset.name, f"{scene.name}.h5")
    path.parent.mkdir(exist_ok=True)
    sequence_file.save(replace(tiny_sequence(), info={"ensemble": {"spread_cm": 0.123, "push_growth": 0.5}}), path)
    return Reference(scene.name, path, "")


def test_a_scene_is_a_file_of_five_lines(tmp_path):
    (tmp_path / "mine.toml").write_text(
        'garment = "tshirt"\nbody = "tall"\nmotion = "jump"\nsplit = "test"\nframes = 30\n'
    )
    (scene,) = choose_scenes([str(tmp_path / "mine.toml")])
    assert isinstance(scene, Scene) and (scene.name, scene.body, scene.motion.name) == ("mine", "tall", "jump")


def test_after_one_that_fails_the_others_are_made_and_warned_of(tmp_path, monkeypatch, capsys):
    """All are checked before the first; a failure is a line at the end, and what `check` warns of is repeated."""
    from dataclasses import replace

    from garmentbench import reference, sequence_file
    from garmentbench.errors import UserError
    from garmentbench.evaluation.toy import tiny_sequence

    monkeypatch.chdir(tmp_path)
    flipped = tiny_sequence(6)
    sequence_file.save(replace(flipped, body=flipped.body + np.float32([0.15, 0, 0])), tmp_path / "inside.h5")
    made = []

    def make(scene, size, runs):
        made.append(scene.name)
        if scene.name == "sheet-stick-a":
            raise UserError("the stick broke; take another")
        (tmp_path / "inside.h5").touch()
        return reference.Reference(scene.name, tmp_path / "inside.h5", "")

    monkeypatch.setattr(reference, "make_reference", make)
    code, out, err = typed(capsys, "simulate", "sheet-stick-a", "sheet-stick-b", "--preset", "smoke", "--jobs", "1")
    assert code == 1 and made == ["sheet-stick-a", "sheet-stick-b"] and "inside.h5" in out
    assert (
        "1 of 2 failed, the first: simulate sheet-stick-a: the stick broke; take another" in err
        and "sheet-stick-b: warning: " in out
    )
    made.clear()
    code, _, _ = typed(capsys, "simulate", "sheet-stick-a", "sheet-stick-none", "--preset", "smoke", "--jobs", "1")
    assert code == 2 and made == []
