"""What `pip install .` puts on a machine, and that it works there without the checkout."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).resolve().parents[1]
SDIST = "import sys; from setuptools import build_meta; print(build_meta.build_sdist(sys.argv[1]))"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """The wheel, built from the source distribution, itself built from a copy of the checkout."""
    folder = tmp_path_factory.mktemp("wheel")
    ignored = shutil.ignore_patterns(
        ".*", "build", "tests", "reports", "runs", "sequences", "*.egg-info", "__pycache__"
    )
    shutil.copytree(CHECKOUT, folder / "checkout", symlinks=True, ignore=ignored)
    _done([sys.executable, "-c", SDIST, str(folder)], folder / "checkout")
    shutil.unpack_archive(next(folder.glob("*.tar.gz")), folder / "unpacked")
    source = next((folder / "unpacked").iterdir())
    flags = ("--no-deps", "--no-build-isolation", "--no-index", "--quiet", "--wheel-dir", str(folder))
    _done([sys.executable, "-m", "pip", "wheel", *flags, str(source)], folder)
    return next(folder.glob("*.whl"))


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """Gives a function that runs a command of the installed wheel in a folder, and gives what it printed."""
    target = tmp_path_factory.mktemp("installed")
    flags = ("--no-deps", "--no-index", "--quiet", "--target", str(target))
    _done([sys.executable, "-m", "pip", "install", *flags, str(wheel)], target)

    def run(folder: Path, *command: str) -> str:
        return _done([sys.executable, *command], folder, os.environ | {"PYTHONPATH": str(target)})

    shown = run(target.parent, "-c", "import garmentbench.methods.baselines as b; print(b.__file__)")
    assert Path(shown.strip()).is_relative_to(target)
    return run


def _done(command: list[str], folder: Path, environment: dict[str, str] | None = None) -> str:
    environment = os.environ | {"PYTHONPATH": ""} if environment is None else environment
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_wheel_is_small_and_has_one_package_with_its_data(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    assert wheel.stat().st_size < 10e6
    assert {n.split("/")[0] for n in names if ".dist-info/" not in n} == {"garmentbench"}
    files = [Path(f, name) for f, _, there in os.walk(CHECKOUT / "garmentbench", followlinks=True) for name in there]
    wanted = {str(f.relative_to(CHECKOUT)) for f in files if f.suffix in (".py", ".toml", ".npz", ".j2", ".typed")}
    wanted = {name for name in wanted if "/bake/" not in name}
    assert len(wanted) > 300 and wanted <= set(names), sorted(wanted - set(names))
    assert not [n for n in names if n.endswith(".png") or "/bake/" in n or "/tests/" in n]


def test_it_works_without_the_checkout_and_writes_to_the_working_folder(installed, tmp_path):
    assert "tshirt-armspace-90" in installed(tmp_path, "-m", "garmentbench", "scenes")
    size = ("--preset", "smoke")
    made = installed(tmp_path, "-m", "garmentbench", "simulate", "sheet-stick-a", *size).split("\n")[0].split(": ")[0]
    assert made == str(tmp_path / "sequences/smoke/sheet-stick-a.h5") and Path(made).is_file()
    scenes = ("--train-scene", "sheet-stick-a", "--scene", "sheet-stick-a")
    assert "rollout_l2" in installed(tmp_path, "-m", "garmentbench", "evaluate", "hold", *scenes, *size)
    assert {p.name for p in tmp_path.iterdir()} == {"runs", "sequences"}
    assert "evaluate hold" not in installed(tmp_path, "-m", "garmentbench", "--home", "elsewhere", "runs")
    assert "hold" in installed(tmp_path, "-m", "garmentbench", "runs")


def test_its_report(installed, tmp_path):
    (tmp_path / "mine.toml").write_text('train = ["sheet-stick-a"]\ntest = ["sheet-stick-b"]\nentries = ["hold"]\n')
    file = ("mine.toml", "--preset", "smoke", "--home", "home")
    installed(tmp_path, "-m", "garmentbench", "evals", *file)
    first = (tmp_path / "home/reports/mine-smoke/index.html").read_bytes()
    assert "index.html" in installed(tmp_path, "-m", "garmentbench", "report", *file)
    assert (tmp_path / "home/reports/mine-smoke/index.html").read_bytes() == first
    assert {p.name for p in tmp_path.iterdir()} == {"home", "mine.toml"}
