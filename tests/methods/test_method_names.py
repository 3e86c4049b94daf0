"""Methods are found by name, by "module:Class", and by the entry points of other packages."""

import subprocess
import sys
from importlib.metadata import EntryPoint

import pytest

from garmentbench import methods
from garmentbench.errors import UsageError
from garmentbench.methods import METHODS, load_method
from garmentbench.methods.baselines.skinning import Skinning


@pytest.mark.parametrize("name", METHODS)
def test_each_name_leads_to_a_method_of_that_name(name):
    assert load_method(name).name == name


def test_module_and_class():
    assert load_method("garmentbench.methods.baselines.skinning:Skinning") is Skinning


def test_entry_points(monkeypatch):
    found = [EntryPoint("theirs", "garmentbench.methods.baselines.skinning:Skinning", methods.ENTRY_POINTS)]
    monkeypatch.setattr(methods, "entry_points", lambda group: found if group == "garmentbench.methods" else [])
    assert load_method("theirs") is Skinning
    with pytest.raises(UsageError, match="theirs"):
        load_method("thiers")


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("skining", "unknown method 'skining': did you mean 'skinning'?"),
        (
            "no_such_module:Method",
            "install the package that has it, or run in the folder of no_such_module.py",
        ),
        ("garmentbench.methods.baselines.skinning:Skining", "has no attribute 'Skining'"),
        ("garmentbench.methods.baselines.skinning:", 'or "module:Class"'),
        (":Skinning", 'or "module:Class"'),
    ],
)
def test_wrong_names_are_told(name, says):
    with pytest.raises(UsageError) as error:
        load_method(name)
    assert says in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("code", "says"),
    [
        ("class X(:", "{}.py:1: SyntaxError: invalid syntax; mend it"),
        ("\n1 / 0", "{}.py:2: ZeroDivisionError: division by zero; mend it"),
        ("import no_such_thing", "{}.py:1: ModuleNotFoundError: No module named 'no_such_thing'; mend it"),
        ("import math\nmath.tao", "{}.py:2: AttributeError: module 'math' has no attribute 'tao'; mend it"),
        ("import json\njson.loads('')", "{}.py:2: JSONDecodeError: Expecting value"),
        ("import sys; sys.exit(0)", "{}.py:1: SystemExit: 0; mend it"),
    ],
)
def test_a_module_that_can_not_be_imported_is_one_line(tmp_path, monkeypatch, code, says):
    name = f"broken_{abs(hash(code))}"
    (tmp_path / f"{name}.py").write_text(code)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(UsageError) as error:
        load_method(f"{name}:X")
    assert str(error.value).startswith(f"method '{name}:X': {says.format(name)}") and "\n" not in str(error.value)


def test_names_do_not_import_their_modules():
    code = "import methods, sys; print([m for m in ('torch', 'warp', 'scipy') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "[]"
