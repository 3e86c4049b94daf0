"""Scenes from the wardrobe, and what is said of one that is written wrong."""

from dataclasses import replace
from pathlib import Path

import pytest

from garmentbench import paths
from garmentbench.cli import main
from garmentbench.errors import UserError
from garmentbench.pipeline.choice import choose_method
from garmentbench.reference import reference_identity
from garmentbench.scenes.presets import preset
from garmentbench.scenes.wardrobe import load_scene, read_wardrobe, scene_names, wardrobe

SCENE = 'garment = "tshirt"\nbody = "base"\nmotion = "catwalk"\nsplit = "test"\nframes = 20\n'


def write(folder: Path, text: str) -> str:
    (folder / "wrong.toml").write_text(text)
    return str(folder / "wrong.toml")


def changed(key: str, value: str) -> str:
    """The scene with another value, in place of the old one or beside it."""
    rest = "".join(line + "\n" for line in SCENE.splitlines() if not line.startswith(f"{key} "))
    return f"{key} = {value}\n{rest}"


WRONG = [
    (changed("garment", "3"), "garment is 3; wanted a text in quotes"),
    (changed("motion", "3"), "motion is 3; wanted a text in quotes or a table"),
    (changed("body", "[]"), "body is []; wanted a text in quotes"),
    (changed("split", '"trian"'), "split is 'trian'; wanted \"train\" or \"validation\" or \"test\""),
    (changed("frames", "-3"), "frames is -3; wanted a whole number of at least 4"),
    (changed("frames", "20.5"), "frames is 20.5; wanted a whole number"),
    (changed("fps", '"thirty"'), "fps is 'thirty'; wanted a number"),
    (changed("fps", "0"), "fps is 0; wanted a number of at least 1"),
    (changed("fps", "inf"), "fps is inf; wanted a finite number"),
    (changed("material", "3"), "material is 3; wanted a table"),
    (changed("simulation", "true"), "simulation is True; wanted a table"),
    (changed("worn_over", "3"), "worn_over is 3; wanted the name of a scene"),
    (changed("motion", '{name = "fast", translate = 3}'), "motion.translate is 3; wanted a list"),
    (changed("motion", '{name = "fast", translate = [0, 1]}'), "motion.translate is [0, 1]; wanted a list of length 3"),
    (changed("motion", '{name = "fast", translate = [0, 1, "up"]}'), "motion.translate[2] is 'up'; wanted a number"),
    (changed("motion", '{name = "fast", translate = [0, 1, nan]}'), "translate[2] is nan; wanted a finite number"),
    (changed("motion", '{name = "fast", speed = "fast"}'), "motion.speed is 'fast'; wanted a number"),
    (changed("motion", '{name = "fast", speed = -1}'), "motion.speed is -1; wanted a number above 0"),
    (changed("motion", '{name = "fast", freeze_after = -1}'), "motion.freeze_after is -1; wanted a whole number of at"),
    (changed("motion", "{speed = 2}"), "motion: name is missing; wanted a text in quotes"),
    (changed("motion", '{file = "a.npz"}'), 'motion: name is missing; with a file it is name = "clip"'),
    (SCENE.replace("motion", "#"), "motion is missing; wanted a text in quotes or a table"),
    (changed("motion", '{name = "fast", sped = 2}'), "unknown key of [motion] 'sped': did you mean 'speed'?"),
    (SCENE + "[material]\nstrech = 3.0\n", "unknown key of [material] 'strech': did you mean 'stretch'?"),
    (SCENE + "[material]\nstretch = -3\n", "material.stretch is -3; wanted a number of at least 0"),
    (SCENE + "[simulation]\nqueries = 2.5\n", "simulation.queries is 2.5; wanted a whole number"),
    (SCENE + "[simulation]\nqueries = 0\n", "simulation.queries is 0; wanted a whole number of at least 1"),
    (SCENE + "[simulation]\ngravity = true\n", "simulation.gravity is True; wanted a number"),
    (SCENE + "[simulation]\nself_contact = 1\n", "simulation.self_contact is 1; wanted true or false"),
    (SCENE + "farmes = 3\n", "unknown key 'farmes': did you mean 'frames'?"),
    ("frames = 20\n", "garment, body, motion, split are missing; wanted a text in quotes, "),
    (changed("split", ""), "not a TOML file"),
    ("frames = \n", 'wanted lines like frames = 100 and motion = "fast"'),
]  # fmt: skip


@pytest.mark.parametrize(("text", "complaint"), WRONG, ids=[complaint[:40] for _, complaint in WRONG])
def test_a_malformed_scene_is_one_line(tmp_path, capsys, text, complaint):
    """... that names the file and the key, what was found and what is wanted; whoever reads it."""
    file = write(tmp_path, text)
    for command in (["scenes", "show", file], ["simulate", file, "--preset", "smoke"]):
        assert main(command) == 1
        out, err = capsys.readouterr()
        assert out == "" and err.count("\n") == 1 and f"{file}: " in err and complaint in err


@pytest.mark.parametrize(
    ("key", "complaint"),
    [("garment", "unknown garment 'capes'"), ("body", "unknown body 'capes'"), ("motion", "unknown motion 'capes'")],
)
def test_a_scene_of_what_does_not_exist_is_not_shown(tmp_path, capsys, key, complaint):
    file = write(tmp_path, changed(key, '"capes"'))
    for command in (["scenes", "show", file], ["simulate", file, "--preset", "smoke"]):
        assert main(command) == 2
        assert f"{file}: {complaint}" in capsys.readouterr().err


def test_a_typo_names_at_most_five_scenes(capsys):
    assert main(["scenes", "show", "tshirt-armspce-90"]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1 and "did you mean 'tshirt-armspace-90'?" in message
    assert sum(name in message.replace(",", "").split() for name in scene_names()) == 5


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("[motions]\nrun = {split = 'test'}", "motions.run: frames is missing"),
        ("[motions]\nrun = {split = 'test', frames = 1}", "motions.run.frames is 1; wanted a whole number of at least"),
        ("[garments.cape]\nmaterial = {bending = 'soft'}", "garments.cape.material.bending is 'soft'; wanted a number"),
        ("[garments.cape]\nmatrial = {}", "unknown key of [garments.cape] 'matrial': did you mean 'material'?"),
    ],
)  # fmt: skip
def test_a_malformed_wardrobe_is_one_line(tmp_path, text, complaint):
    with pytest.raises(UserError) as error:
        read_wardrobe(Path(write(tmp_path, text)))
    assert str(error.value).startswith(f"{tmp_path}/wrong.toml: ") and complaint in str(error.value)


def test_material_belongs_to_the_garment(tmp_path):
    """A file that names a garment has its material, and changes what it says."""
    scene = load_scene(write(tmp_path, SCENE.replace("tshirt", "dress") + "[material]\nfriction = 0.1\n"))
    assert scene.material == replace(load_scene("dress-catwalk").material, friction=0.1)
    assert scene.simulation == load_scene("dress-catwalk").simulation
    over = load_scene(write(tmp_path, SCENE.replace("tshirt", "over_skirt")))
    assert over.worn_over == replace(load_scene("dress-catwalk"), frames=20, split="test")


def test_no_scene_file_could_be_derived():
    """D15: what a garment is made of stands in one place, and no file repeats what the wardrobe says."""
    files, grid = {path.stem for path in paths.SCENES.glob("*.toml")}, set(wardrobe().scenes())
    assert len(files) == 6 and len(grid) == 5 * 53 and not files & grid
    assert not any("bending" in path.read_text() for path in paths.SCENES.glob("*.toml"))


def test_a_scene_of_a_recording_is_one_line_with_what_to_do(tmp_path, capsys):
    (tmp_path / "walk.bvh").write_text("HIERARCHY")
    file = write(tmp_path, changed("motion", '{name = "clip", file = "walk.bvh"}'))
    for command in (["scenes", "show", file], ["simulate", file, "--preset", "smoke"]):
        assert main(command) == 1
        out, err = capsys.readouterr()
        assert out == "" and err.count("\n") == 1 and "garmentbench import-motion" in err


def test_mesh_and_network_sizes_are_chosen_one_by_one():
    config = choose_method("motion_guided", "full", preset("smoke", model="laptop")).config
    assert config == choose_method("motion_guided", "full", preset("laptop")).config
    assert config != choose_method("motion_guided", "full", preset("smoke")).config


def test_presets_are_pairs_and_only_the_mesh_decides_a_reference():
    mixed, scene = preset("laptop", mesh="smoke"), load_scene("over_skirt-catwalk")
    assert (mixed.name, mixed.mesh, mixed.model) == ("smoke+laptop", preset("smoke").mesh, "laptop")
    assert preset("laptop", model="laptop") == preset("laptop") and preset("smoke", model="paper").needs_cuda
    assert reference_identity(scene, mixed) == reference_identity(scene, preset("smoke"))
    assert reference_identity(scene, mixed) != reference_identity(scene, preset("laptop"))
    with pytest.raises(UserError, match="unknown network size 'larg'"):
        preset("laptop", model="larg")
