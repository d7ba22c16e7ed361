"""Every example in docstrings and in the guide runs, and every public thing has one."""

import doctest
import importlib
import inspect
import re
from pathlib import Path

import pytest
from conftest import ROOT

import dotray

HIDDEN = ["camera", "caster", "diagnostic", "engines", "image", "look", "options", "pieces", "progress", "scene"]
HIDDEN += ["shapes", "tree", "values"]
MODULES = ["dotray", "dotray.cluster", *(f"dotray._{name}" for name in HIDDEN)]
GUIDE = ROOT / "docs/python.md"


@pytest.mark.parametrize("name", MODULES)
def test_examples_in_docstrings(name):
    found = doctest.testmod(importlib.import_module(name), optionflags=doctest.IGNORE_EXCEPTION_DETAIL)
    assert found.failed == 0


def test_every_public_thing_has_an_example():
    missing = []
    for name in dotray.__all__:
        thing = getattr(dotray, name)
        if not (inspect.isclass(thing) or inspect.isfunction(thing)) or name in ("SceneError", "Comparison"):
            continue
        things = [(name, thing)]
        if inspect.isclass(thing):
            things += [
                (f"{name}.{part}", method)
                for part, method in inspect.getmembers(thing, inspect.isfunction)
                if not part.startswith("_")
            ]
        texts = {what: inspect.getdoc(method) or "" for what, method in things}
        for what, text in texts.items():
            assert text, f"{what} has no docstring"
        missing += [what for what, text in texts.items() if ">>>" not in text]
    # The class's own example shows these, or they write files.
    allowed = {"Diagnostic", "Group", "Image.save", "Image.compare", "RayCaster.cast_rays"}
    assert set(missing) <= allowed, set(missing) - allowed


def test_the_guide(tmp_path, monkeypatch):
    """The blocks of Python in the guide, one after the other."""
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```", GUIDE.read_text(), re.M | re.S)
    assert len(blocks) >= 8
    names = {}
    for block in blocks:
        exec(compile(block, str(GUIDE), "exec"), names)
    assert list(Path(tmp_path).glob("*.png"))
