"""The command as it is typed: what it says, what it writes, and what it refuses."""

from pathlib import Path

import bvh_example
import numpy as np
import pytest
from PIL import Image

from garmentbench.cli import main
from garmentbench.scenes.bodies import load_body

BASE = load_body("base", "small")


@pytest.fixture
def walk(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("walk.bvh").write_text(bvh_example.y_up(bvh_example.own_walk(BASE, 40)).text(prefix="mixamorig:"))
    return Path("walk.bvh")


def typed(capfd, *arguments: str) -> tuple[int, str, list[str]]:
    code = main(["import-motion", *arguments])
    out, err = capfd.readouterr()
    return code, out, [line for line in err.splitlines() if not line.startswith("Warp")]


def test_says_what_it_found_and_writes_clip_and_picture(walk, capfd):
    code, out, lines = typed(capfd, "walk.bvh", "--out", "walk.npz", "--picture", "walk.png")
    assert code == 0 and not lines
    for said in (
        "recording: 40 frames at 30 a second, 1.30 s",
        "up: y; unit: centimetres",
        "m tall",
        "names: Mixamo",
        "upper_arm  mixamorig:LeftArm | mixamorig:RightArm",
        "result: 40 frames at 30 a second on body base",
        "feet: slide 0.0",
        "arms: fore-arm or hand more than 2 cm inside the rest of the body in 0 % of the frames\n",
    ):
        assert said in out
    with np.load("walk.npz") as arrays:
        assert arrays["rotations"].shape == (40, 22, 3, 3) and "walk.bvh" in str(arrays["notes"])
    assert Image.open("walk.png").size == (1600, 870)
    code, out, _ = typed(capfd, "walk.npz")
    assert code == 0 and "result: 40 frames" in out and "names" not in out


def test_names_from_a_file_and_from_the_line(walk, capfd):
    text = walk.read_text().replace("mixamorig:LeftArm", "A").replace("mixamorig:RightArm", "B")
    Path("odd.bvh").write_text(text)
    Path("names.toml").write_text('A = "upper_arm.L"\n')
    code, out, _ = typed(capfd, "odd.bvh", "--map", "names.toml", "B=upper_arm.R")
    assert code == 0 and "upper_arm  A | B" in out


@pytest.mark.parametrize(
    ("arguments", "code", "complaint"),
    [
        (["none.bvh"], 1, "none.bvh: no such file"),
        (["walk.bvh", "--map", "Hips"], 2, "'Hips' is no pair"),
        (["walk.bvh", "--map", "none.toml"], 1, "none.toml: can't be read"),
        (["walk.bvh", "--map", "number.toml"], 1, "wanted lines such as"),
        (["walk.bvh", "--body", "bse"], 2, "did you mean 'base'"),
        (["walk.bvh", "--fps", "0"], 2, "--fps is 0"),
        (["walk.bvh", "--out", "walk.txt"], 2, "ends in .npz"),
        (["walk.bvh", "--start", "9"], 1, "it has 0 to 1.30 s"),
        (["walk.bvh", "--smplx-models", "."], 2, "Wanted --out"),
        (["walk.bvh", "--smplx-models", ".", "--out", "b.npz"], 1, "damaged, or no .npz file"),
    ],
)
def test_refusals_are_one_line(walk, capfd, arguments, code, complaint):
    Path("number.toml").write_text("A = 3\n")
    got, _, lines = typed(capfd, *arguments)
    assert got == code and len(lines) == 1 and complaint in lines[0]
