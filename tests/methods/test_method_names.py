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
        ("no_such_module:Method", "no module named 'no_such_module'"),
        ("garmentbench.methods.baselines.skinning:Skining", "has no attribute 'Skining'"),
        ("garmentbench.methods.baselines.skinning:", 'or "module:Class"'),
        (":Skinning", 'or "module:Class"'),
    ],
)
def test_wrong_names_are_told(name, says):
    with pytest.raises(UsageError) as error:
        load_method(name)
    assert says in str(error.value) and "\n" not in str(error.value)


def test_names_do_not_import_their_modules():
    code = "import methods, sys; print([m for m in ('torch', 'warp', 'scipy') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "[]"
