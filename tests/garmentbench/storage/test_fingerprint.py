"""Fingerprints of code: what counts, what doesn't."""

import ast
import importlib
import os
import shutil
import subprocess
import sys

import numpy as np
import pytest

from garmentbench import paths, reference
from garmentbench.scenes.presets import preset
from garmentbench.storage import fingerprint as module
from garmentbench.storage.fingerprint import BYSTANDERS, canonical_json, fingerprint

CACHES = (module._file, module._parsed, module._imports, module._hash_with_imports)
DECIDERS = (
    "simulation.kernels",
    "simulation.xpbd",
    "simulation.contact",
    "simulation.contacts.constraints",
    "simulation.contacts.sides",
    "scenes.material",
    "simulation.assembly",
    "metrics.interpenetration",
    "metrics.self_intersection",
    "motion.walk",
    "scenes.scene",
)


def clear() -> None:
    for cached in CACHES:
        cached.cache_clear()


@pytest.fixture
def project(tmp_path, monkeypatch):
    """Writes modules of a package `toy_project` (None: removes them) and gives the fingerprint of its `train`."""
    folder = tmp_path / "toy_project"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    monkeypatch.syspath_prepend(tmp_path)

    def write(start: str = "toy_project.train", /, **sources: str | None) -> str:
        for name, text in sources.items():
            file = folder / f"{name}.py"
            file.unlink() if text is None else file.write_text(text)
        importlib.invalidate_caches()
        clear()
        assert "toy_project" not in sys.modules  # it is read, never imported
        return fingerprint(start)

    return write


@pytest.fixture
def edited(monkeypatch):
    """Gives the fingerprint of simulated sequences where some modules' sources are edited."""
    read = module._source

    def code(names: tuple[str, ...] = (), edit=lambda text: text) -> str:
        files = {module._file(f"garmentbench.{name}") for name in names}
        assert None not in files, names
        monkeypatch.setattr(module, "_source", lambda f: edit(read(f).decode()).encode() if f in files else read(f))
        clear()
        return fingerprint(*reference._CODE)

    yield code
    monkeypatch.undo()
    clear()


def test_code_that_is_imported_counts_and_other_code_does_not(project):
    first = project(
        train="from toy_project import loss\n",
        loss="def late():\n    from .deep import x\n",
        deep="x = 1\n",
        report="y = 1\n",
    )
    assert project(report="y = 2\n") == first
    assert project(deep="x = 2\n") != first
    assert project(deep="x = 1\n") == first
    assert project(train="from toy_project import loss\nz = 3\n") != first


def test_explanations_do_not_count(project):
    first = project(train='"""Old."""\ndef f(x):\n    """Old."""\n    return x\nA = 1\n"""Old."""\n')
    text = '"""New."""\n# why\ndef f(x):\n    """New,\n    longer."""\n\n    return x\nA = 1\n"""New."""\n'
    assert project(train=text) == first
    assert project(train='"""Old."""\ndef f(x):\n    """Old."""\n    return x + 1\nA = 1\n') != first


def test_what_only_a_type_checker_reads_does_not_count(project):
    text = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from toy_project.report import Report\nx = 1\n"
    assert project(train=text, report="y = 1\n") == project(train=text, report="y = 2\n")


def test_annotations_count_only_where_a_decorator_may_read_them(project):
    text = "import warp as wp\n{}def f(x{}){}:\n    return x\n"
    first = project(train=text.format("", "", ""))
    assert project(train=text.format("", ": int", " -> int")) == first
    kernel = project(train=text.format("@wp.func\n", ": int", ""))
    assert project(train=text.format("@wp.func\n", ": float", "")) != kernel


def test_a_module_that_is_renamed_or_moved_is_the_same(project):
    first = project(
        train="import numpy\nfrom toy_project import loss\nfrom toy_project.deep import x\nloss.f(x)\n",
        loss="from toy_project.deep import x as y\ndef f(): return y\n",
        deep="x = 1\n",
    )
    assert first == project(
        "toy_project.fit",
        train=None,
        loss=None,
        deep=None,
        fit="import numpy\nfrom .constants import x\nfrom . import the_loss\nthe_loss.f(x)\n",
        the_loss="from toy_project.constants import x as y\ndef f(): return y\n",
        constants="x = 1\n",
    )


def test_an_import_from_elsewhere_counts_though_both_places_are_read(project):
    other = {"a": "x = 1\n", "b": "x = 2\n"}
    first = project(train="from toy_project.a import x\nfrom toy_project.b import x as y\n", **other)
    assert project(train="from toy_project.b import x\nfrom toy_project.a import x as y\n") != first


def test_what_a_package_passes_on_counts_where_it_is_defined(project, tmp_path):
    passing = (
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from toy_project.deep import x as shown\nHELP = {}\n"
    )
    (tmp_path / "toy_project" / "__init__.py").write_text(passing.format(1))
    first = project(train="from toy_project import shown\n", deep="x = 1\n")
    (tmp_path / "toy_project" / "__init__.py").write_text(passing.format(2))
    assert project() == first
    assert project(deep="x = 2\n") != first


def test_a_package_stands_for_all_modules_in_it():
    assert fingerprint("garmentbench.scenes.presets") != fingerprint("garmentbench.scenes")
    with pytest.raises(ModuleNotFoundError, match="garmentbench.presetz"):
        fingerprint("garmentbench.presetz")


@pytest.mark.parametrize("name", sorted(BYSTANDERS))
def test_each_module_that_is_left_out_exists(name):
    assert module._file(name) is not None


def test_an_edit_of_an_explanation_makes_no_sequence_anew(edited):
    first = edited()
    names = tuple(name.removeprefix("garmentbench.") for name in module._reached(list(reference._CODE)))
    assert edited(names, lambda text: f'"""New."""\n# New.\n{text}\n# New.\n') == first


def test_an_edit_of_what_decides_no_sequence_makes_none_anew(edited):
    first = edited()
    packages = ("importing", "commands", "report", "viewing", "evals", "methods", "evaluation.rollout", "storage.runs")
    inside = [name for package in packages for name in module._inside(f"garmentbench.{package}")]
    assert edited(tuple(n.removeprefix("garmentbench.") for n in inside), lambda text: text + "\nNEW = 1\n") == first


@pytest.mark.parametrize("name", DECIDERS)
def test_an_edit_of_what_decides_a_sequence_makes_it_anew(edited, name):
    first = edited()

    def next_number(text: str) -> str:
        """With the last number of the file one larger."""
        tree = ast.parse(text)
        numbers = [n for n in ast.walk(tree) if isinstance(n, ast.Constant) and type(n.value) in (int, float)]
        numbers[-1].value += 1
        return ast.unparse(tree)

    assert edited((name,), lambda text: ast.unparse(ast.parse(text))) == first
    assert edited((name,), next_number) != first


def test_an_edit_of_an_asset_makes_a_sequence_anew(tmp_path, monkeypatch):
    from garmentbench.scenes.wardrobe import load_scene

    copy = shutil.copytree(paths.DATASETS, tmp_path / "datasets")
    for name in ("BODIES", "GARMENTS"):
        monkeypatch.setattr(paths, name, copy / name.lower())
    monkeypatch.setattr("garmentbench.reference.GARMENTS", copy / "garments")
    scene, smoke = load_scene("tshirt-armspace-90"), preset("smoke")
    identities = {reference.reference_identity(scene, smoke)}
    for asset in ("garments/tshirt-smoke.npz", "bodies/base-small.npz"):
        with (copy / asset).open("ab") as file:
            file.write(b"1")
        identities.add(reference.reference_identity(scene, smoke))
    assert len(identities) == 3
    with (copy / "garments/dress-smoke.npz").open("ab") as file:
        file.write(b"1")
    assert reference.reference_identity(scene, smoke) in identities


def test_all_that_a_simulation_imports_is_counted(home):
    code = """
import sys
from garmentbench import reference
from garmentbench.scenes.presets import preset
reference.make_reference(reference.resolve_source("sheet-stick-a"), preset("smoke"))
print(*(name for name in sys.modules if name.split(".")[0] == "garmentbench"))
"""
    env = os.environ | {"PYTHONPATH": str(paths.PACKAGE.parent)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=env, cwd=home, check=True)
    imported = {n for n in done.stdout.split()[-200:] if n.startswith("garmentbench")}
    assert "garmentbench.simulation.kernels" in imported
    counted = module._reached(list(reference._CODE))
    packages = {n for n in imported if module._file(n).name == "__init__.py"}
    rest = {n for n in imported - counted - packages if not module._bystander(n)}
    # the package of metrics lists them all; those that a sequence keeps are among `_CODE`
    # what these read counts
    read = {"garmentbench.scenes.wardrobe", "garmentbench.scenes.fabrics", "garmentbench.storage.typed_toml"}
    assert rest <= read | {"garmentbench.reference", "garmentbench.device"} | {
        n for n in rest if n.startswith(("garmentbench.sequence_file.", "garmentbench.metrics."))
    }


def test_files_and_folders_count_by_their_bytes(tmp_path):
    (tmp_path / "body.npz").write_bytes(b"1")
    first = fingerprint(tmp_path)
    assert fingerprint(tmp_path) == first
    (tmp_path / "body.npz").write_bytes(b"2")
    assert fingerprint(tmp_path) != first


def test_canonical_json():
    assert canonical_json({"b": (1, np.float32(0.5)), "a": {3, 1}}) == '{"a":[1,3],"b":[1,0.5]}'
    assert '"frame_limit":null' in canonical_json(preset("laptop"))
    with pytest.raises(ValueError, match="[Oo]ut of range|not JSON"):
        canonical_json(float("nan"))
    with pytest.raises(TypeError, match="not plain JSON"):
        canonical_json({"f": print})
