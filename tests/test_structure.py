"""The house keeps its floors: imports go down, nothing lies about at the root, and what is public says what it is."""

import inspect
import subprocess
import sys
import tomllib
from pathlib import Path

import garmentbench

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "garmentbench"


def lint_imports(config: Path) -> subprocess.CompletedProcess:
    """Check the contracts of a configuration file on this checkout."""
    code = "from importlinter.cli import lint_imports_command as main; main()"
    command = [sys.executable, "-c", code, "--no-cache", "--config", str(config)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)


def test_no_lower_floor_imports_a_higher_one_and_there_is_no_circle():
    done = lint_imports(ROOT / "pyproject.toml")
    assert done.returncode == 0, done.stdout
    assert " 0 broken" in done.stdout


def test_a_floor_put_upside_down_is_found(tmp_path):
    """The contracts look through the links to methods and evals, and at imports inside functions."""
    text = (ROOT / "pyproject.toml").read_text()
    layers = tomllib.loads(text)["tool"]["importlinter"]["contracts"][0]["layers"]
    assert {"methods", "evals", "importing", "report"} <= set(layers)
    turned = text.replace('    "evals",\n    "methods",\n', '    "methods",\n    "evals",\n')
    assert turned != text
    (tmp_path / "pyproject.toml").write_text(turned)
    done = lint_imports(tmp_path / "pyproject.toml")
    assert done.returncode == 1
    assert "garmentbench.evals is not allowed to import garmentbench.methods" in " ".join(done.stdout.split())


def test_at_most_twelve_loose_files_at_the_root():
    loose = sorted(p.name for p in PACKAGE.iterdir() if p.is_file())
    assert len(loose) <= 12, loose


def test_every_public_name_has_a_docstring():
    for name in garmentbench.__all__:
        thing = getattr(garmentbench, name)
        if inspect.isclass(thing) or inspect.isroutine(thing):
            assert thing.__doc__ and thing.__doc__.strip(), name
            # The one that dataclasses write themselves lists the fields and says nothing of them.
            assert not thing.__doc__.startswith(f"{name}("), name
        if inspect.isclass(thing):
            own = {n: m for n, m in vars(thing).items() if not n.startswith("_") and inspect.isroutine(m)}
            own = {n: m for n, m in own.items() if getattr(m, "__name__", "") != "<lambda>"}  # a field's default
            assert [n for n in own if not getattr(thing, n).__doc__] == [], name
