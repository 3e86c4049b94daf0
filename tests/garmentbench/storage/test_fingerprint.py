"""Fingerprints of code: what counts, what doesn't."""

import importlib
import sys

import numpy as np
import pytest

from garmentbench.scenes.presets import preset
from garmentbench.storage import fingerprint as module
from garmentbench.storage.fingerprint import canonical_json, fingerprint


@pytest.fixture
def project(tmp_path, monkeypatch):
    """Writes modules of a package `toy_project` and gives the fingerprint of `toy_project.train`."""
    folder = tmp_path / "toy_project"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    monkeypatch.syspath_prepend(tmp_path)

    def write(**sources: str) -> str:
        for name, text in sources.items():
            (folder / f"{name}.py").write_text(text)
        importlib.invalidate_caches()
        for cached in (module._file, module._tree, module._code, module._imports):
            cached.cache_clear()
        assert "toy_project" not in sys.modules  # it is read, never imported
        return fingerprint("toy_project.train")

    return write


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
    first = project(train='"""Old."""\ndef f(x):\n    """Old."""\n    return x\n')
    assert project(train='"""New."""\n# why\ndef f(x):\n    """New,\n    longer."""\n\n    return x\n') == first
    assert project(train='"""Old."""\ndef f(x):\n    """Old."""\n    return x + 1\n') != first


def test_a_package_stands_for_all_modules_in_it():
    assert fingerprint("garmentbench.scenes.presets") != fingerprint("garmentbench")
    with pytest.raises(ModuleNotFoundError, match="garmentbench.presetz"):
        fingerprint("garmentbench.presetz")


def test_what_only_carries_results_about_does_not_count():
    assert "garmentbench.sequence" in module._reached(["garmentbench.method"])
    assert not {"garmentbench.errors", "garmentbench.paths"} & module._reached(["garmentbench.scenes.scene"])


def test_files_and_folders_count_by_their_bytes(tmp_path):
    (tmp_path / "body.npz").write_bytes(b"1")
    first = fingerprint(tmp_path)
    assert fingerprint(tmp_path) == first
    (tmp_path / "body.npz").write_bytes(b"2")
    assert fingerprint(tmp_path) != first


def test_canonical_json():
    assert canonical_json({"b": (1, np.float32(0.5)), "a": {3, 1}}) == '{"a":[1,3],"b":[1,0.5]}'
    assert '"needs_cuda":false' in canonical_json(preset("smoke"))
    with pytest.raises(ValueError, match="[Oo]ut of range|not JSON"):
        canonical_json(float("nan"))
    with pytest.raises(TypeError, match="not plain JSON"):
        canonical_json({"f": print})
