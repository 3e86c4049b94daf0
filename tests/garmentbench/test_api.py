"""The public names: importable from garmentbench, loaded when asked for, typed, and documented."""

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import garmentbench as gb

ROOT = Path(gb.__file__).parent
WANTED = (
    "load_scene scene_names make_reference load_sequence Sequence Template Garment Body Method History BodyFrame "
    "FitRun roll_out one_step score METRICS check_method parametrize_with_checks train evaluate preset choose_method "
    "training_run Skin SkinOf lift place seed_features tiny_sequence RunStore UserError"
)


def test_importing_it_loads_nothing_heavy_and_is_quick():
    code = "import sys; before = set(sys.modules); import garmentbench; print(*set(sys.modules) - before)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT.parent, check=True)
    loaded = set(done.stdout.split())
    assert {m for m in loaded if m.startswith("garmentbench")} == {"garmentbench"}
    assert not {"numpy", "torch", "warp", "h5py", "scipy", "pandas", "rerun"} & loaded
    times = []
    for _ in range(5):
        code = "import time; start = time.process_time(); import garmentbench; print(time.process_time() - start)"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT.parent, check=True)
        times.append(float(done.stdout))
    assert min(times) < 0.15, times


def test_all_wanted_names_are_public():
    assert set(WANTED.split()) <= set(gb.__all__) <= set(dir(gb))


@pytest.mark.parametrize("name", gb.__all__)
def test_every_public_name_is_there_and_documented(name):
    value = getattr(gb, name)
    if callable(value):
        assert inspect.getdoc(value), name


def test_what_type_checkers_see_is_what_runs():
    tree = ast.parse((ROOT / "__init__.py").read_text())
    block = next(node for node in tree.body if isinstance(node, ast.If))
    seen = {
        alias.asname: (node.module.removeprefix("garmentbench."), alias.name)
        for node in block.body
        for alias in node.names
    }
    runs = {}
    for name, home in gb._HOME.items():
        module, _, attribute = home.partition(":")
        runs[name] = (module, attribute or name)
    assert seen == runs
    assert (ROOT / "py.typed").is_file()


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'garmentbench' has no attribute 'roll_in'"):
        _ = gb.roll_in


def test_the_notebook_of_the_readme_runs(home, monkeypatch):
    """README's example, with its own method, on a real scene at the smallest size."""
    import matplotlib

    matplotlib.use("agg")
    text = (ROOT.parent / "README.md").read_text()
    block = next(b for b in text.split("```python\n")[1:] if "roll_out" in b).split("```")[0]
    lines = [line for line in block.splitlines() if line.strip()]
    assert len(lines) <= 12
    names: dict = {}
    exec(block, names)
    assert names["roll"].status == "ok"
    rows = {row.metric for row in names["rows"]}
    assert "rollout_l2" in rows
    assert list(home.rglob("*.h5"))
