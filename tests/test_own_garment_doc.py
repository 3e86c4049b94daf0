"""docs/own-garment.md does what it says: its commands are run as typed, at smoke size, with a poncho."""

import re
import shlex
import subprocess
from pathlib import Path

import pandas
import pytest
from poncho import write_poncho

from garmentbench.cli import main
from garmentbench.scenes.material import Material, Settings
from garmentbench.scenes.wardrobe import load_scene, read_wardrobe
from garmentbench.storage.runs import RunStore

TEXT = (Path(__file__).parents[1] / "docs" / "own-garment.md").read_text()
BLOCKS = [block.splitlines() for block in re.findall(r"```sh\n(.*?)```", TEXT, flags=re.S)]
SIZED = ("simulate", "train", "evaluate", "evals")


@pytest.fixture
def home(tmp_path, monkeypatch):
    """An empty folder to work in; what `view` opens is noted in place of a window."""
    opened = []
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("garmentbench.viewing.viewer.open_viewer", opened.append)
    return tmp_path, opened


def typed(line: str) -> None:
    """Run a line of the document."""
    if not line.startswith("garmentbench"):
        subprocess.run(line, shell=True, check=True)
        return
    arguments = shlex.split(line)[1:]
    assert main([*arguments, *(["--preset", "smoke"] if arguments[0] in SIZED else [])]) == 0, line


def test_nine_commands_lead_from_a_mesh_to_a_report_and_a_picture(home, capsys):
    folder, opened = home
    commands = [line for line in BLOCKS[0] if not line.startswith("#")]
    assert len(commands) == 9
    typed(commands[0])
    write_poncho(folder / "poncho.obj", folder / "body.obj")
    for command in commands[1:]:
        typed(command)
    assert load_scene("poncho-armspace-90-slim").material == Material(bending=3e-3)
    rows = pandas.read_csv(folder / "reports" / "poncho-smoke" / "results.csv")
    tested = rows[(rows.experiment == "poncho") & (rows.metric == "rollout_l2")]
    assert set(tested.method) == {"skinning", "linear_subspace", "another_run"} and set(tested.status) == {"ok"}
    tested = tested[tested.method != "another_run"]
    assert set(tested.scene) == {"poncho-armspace-90-slim"} and set(tested.train_scenes) == {"poncho-armspace-75"}
    assert "poncho" in (folder / "reports" / "poncho-smoke" / "index.html").read_text()
    (recording,) = opened
    assert RunStore().get(recording.parent.name).identity["scene"] == "poncho-armspace-90-slim"
    assert "spread" in capsys.readouterr().out


def test_a_scene_without_an_entry_has_a_name_from_then_on(home):
    """... also after the nine commands, when the wardrobe has a poncho."""
    folder, _ = home
    assert main(["bodies", "export", "base", "body.obj"]) == 0
    write_poncho(folder / "poncho.obj", folder / "body.obj")
    (entry,) = (line for line in BLOCKS[0] if line.endswith(">> wardrobe.toml"))
    typed(entry)
    assert main(["check", "poncho.obj", "--fix", "poncho.npz"]) == 0
    for command in BLOCKS[1]:
        typed(command)
    assert load_scene("cape-run-tall").frames == 150
    assert main(["card", "cape-run-tall", "--preset", "smoke"]) == 0


def test_the_wardrobe_in_the_document_is_one(tmp_path):
    (entry,) = re.findall(r"```toml\n(.*?)```", TEXT, flags=re.S)
    (tmp_path / "wardrobe.toml").write_text(entry)
    skirt = read_wardrobe(tmp_path / "wardrobe.toml").garments["skirt"]
    assert skirt.material == Material(bending=1e-3, density=0.3)
    assert skirt.simulation == Settings(queries=6)
    assert skirt.mesh is not None and skirt.mesh.pins == "waistband"
    assert all(f"`{name}`" in TEXT for name in vars(Material()))


def test_a_garment_beside_its_body_is_an_error_after_simulating_too(home, capsys):
    """What `check` says of the mesh, `simulate` says of what it made of it."""
    folder, _ = home
    assert main(["bodies", "export", "base", "body.obj"]) == 0
    write_poncho(folder / "poncho.obj", folder / "body.obj")
    lines = (folder / "poncho.obj").read_text().splitlines()
    away = [
        f"v {float(line.split()[1]) + 2} {' '.join(line.split()[2:])}" if line[0] == "v" else line for line in lines
    ]
    (folder / "beside.obj").write_text("\n".join(away))
    call = ["simulate", "--garment", "beside.obj", "--motion", "armspace-90", "--frames", "4", "--preset", "smoke"]
    assert main([*call, "--runs", "1"]) == 1
    told = capsys.readouterr()
    assert "beside-armspace-90: error: frame 0: 'base' doesn't go through" in told.out
    assert "1 of 1 failed, the first: beside-armspace-90" in told.err
