"""docs/own-motion.md does what it says: its commands are run as typed, with files of the names that it uses."""

import re
import shlex
import struct
from dataclasses import replace
from pathlib import Path

import bvh_example
import numpy as np
import pytest
from exchange_example import MESHES

from garmentbench import sequence_file
from garmentbench.cli import main
from garmentbench.importing.meshes.obj import write_template
from garmentbench.importing.meshes.point_caches import write_pc2
from garmentbench.scenes.bodies import load_body

TEXT = (Path(__file__).parents[1] / "docs" / "own-motion.md").read_text()
COMMANDS = [line for block in re.findall(r"```sh\n(.*?)```", TEXT, flags=re.S) for line in block.splitlines()]
ASF_BONE = "begin\nid 1\nname {}\ndirection {} {} {}\nlength {}\naxis 0 0 0 XYZ\n{}end\n"


def captured(folder: Path) -> None:
    """A person of CMU's joints who stands, as ASF and AMC."""
    person = {"lhipjoint": ("root", (4, -3, 0)), "lowerback": ("root", (0, 12, 0)), "thorax": ("lowerback", (0, 22, 0)),
              "lowerneck": ("thorax", (0, 8, 0)), "head": ("lowerneck", (0, 12, 0))}  # fmt: skip
    for side, x in (("l", 1), ("r", -1)):
        person |= {
            f"{side}hipjoint": ("root", (9 * x, -4, 0)),
            f"{side}femur": (f"{side}hipjoint", (0, -40, 0)),
            f"{side}tibia": (f"{side}femur", (0, -40, 1)),
            f"{side}foot": (f"{side}tibia", (0, -6, 13)),
            f"{side}toes": (f"{side}foot", (0, 0, 5)),
            f"{side}clavicle": ("thorax", (17 * x, 6, 0)),
            f"{side}humerus": (f"{side}clavicle", (27 * x, 0, 0)),
            f"{side}radius": (f"{side}humerus", (25 * x, 0, 0)),
            f"{side}wrist": (f"{side}radius", (10 * x, 0, 0)),
        }
    bones = [ASF_BONE.format(n, *d, np.linalg.norm(d), "dof rx ry rz\n") for n, (_, d) in person.items()]
    tree = "\n".join(f"{parent} {name}" for name, (parent, _) in person.items())
    head = ":units\nlength 1\nangle deg\n:root\norder TX TY TZ RX RY RZ\naxis XYZ\nposition 0 0 0\norientation 0 0 0\n"
    (folder / "07.asf").write_text(f"{head}:bonedata\n{''.join(bones)}:hierarchy\nbegin\n{tree}\nend\n")
    row = "\n".join(f"{name} 0 0 0" for name in person)
    frames = "\n".join(f"{k}\nroot 0 90 0 0 0 0\n{row}" for k in range(1, 41))
    (folder / "07_01.amc").write_text(f":FULLY-SPECIFIED\n:DEGREES\n{frames}\n")


@pytest.fixture
def home(tmp_path, monkeypatch):
    """A folder with all the files that the page names."""
    monkeypatch.chdir(tmp_path)
    walk = bvh_example.y_up(bvh_example.own_walk(load_body("base", "small"), 120))
    (tmp_path / "walk.bvh").write_text(walk.text(prefix="mixamorig:"))
    captured(tmp_path)
    (tmp_path / "my-walk.toml").write_text(re.findall(r"```toml\n(.*?)```", TEXT, flags=re.S)[0])
    shirt, body = MESHES["garment"], MESHES["body"]
    inches = replace(shirt, frames=shirt.frames / np.float32(0.0254), rest=shirt.still / np.float32(0.0254))
    for name, mesh in (("shirt", shirt), ("body", body), ("late", shirt), ("inches", inches)):
        write_pc2(tmp_path / f"{name}.pc2", mesh)
        write_template(tmp_path / f"{name}.obj", mesh)
    late = bytearray((tmp_path / "late.pc2").read_bytes())
    late[20:24] = struct.pack("<f", 100.0)  # clothes' caches that begin at frame 100
    (tmp_path / "late.pc2").write_bytes(late)
    order = np.random.default_rng(0).permutation(len(shirt.still))
    write_template(tmp_path / "pattern.obj", replace(shirt, rest=shirt.still[order] * np.float32([1, 0, 1])))
    both = (tmp_path / "shirt.obj").read_text().replace("v ", "o shirt\nv ", 1)
    shift, uv = len(shirt.still), both.count("vt ")
    other = "".join(
        f"f {' '.join(str(int(w.split('/')[0]) + shift) for w in line.split()[1:])}\n"
        if line[:2] == "f "
        else f"{line}\n"
        for line in (tmp_path / "body.obj").read_text().splitlines()
        if line[:2] in ("v ", "f ")
    )
    assert uv
    (tmp_path / "both.obj").write_text(both + "o body\n" + other)
    return tmp_path


def test_all_commands_run_as_typed(home, capsys):
    for line in COMMANDS:
        arguments = shlex.split(line)
        more = ["--preset", "smoke"] if arguments[1] == "simulate" else []
        assert arguments[0] == "garmentbench" and main([*arguments[1:], *more]) == 0, (line, capsys.readouterr().err)
    said = capsys.readouterr().out
    assert "names: CMU as captured" in said and "names: Mixamo" in said
    sequences = {name: sequence_file.load(home / f"{name}.h5") for name in ("my", "late", "inches", "still", "cut")}
    for name in ("my", "late", "inches"):
        np.testing.assert_allclose(sequences[name].garment, sequences["my"].garment, atol=1e-5)
    for name in ("walk.npz", "quick.npz", "captured.npz", "walk.png", "my.png", "folder/garment.pc2"):
        assert (home / name).is_file()


def test_every_option_of_the_two_commands_is_on_the_page_or_in_its_help_only():
    """Options that a user has to know of; names, splits and pictures the help tells."""
    from garmentbench.commands.meshes import Import
    from garmentbench.commands.motions import ImportMotion

    known = {"garment", "file", "out", "body", "split", "name", "body_name", "picture", "smplx_models"}
    for command in (Import, ImportMotion):
        for option in set(command.__dataclass_fields__) - known:
            assert f"--{option.replace('_', '-')}" in TEXT, option
