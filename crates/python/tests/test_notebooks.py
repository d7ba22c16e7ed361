"""The notebooks of the guide run from top to bottom and make pictures."""

import os
import shutil
import subprocess
import sys

import pytest
from conftest import ROOT

NOTEBOOKS = sorted((ROOT / "docs/notebooks").glob("*.ipynb"))


def test_all_notebooks_are_here():
    names = [notebook.stem for notebook in NOTEBOOKS]
    assert names == ["field", "mesh", "molecules", "network", "particles", "turntable"]


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda notebook: notebook.stem)
def test_a_notebook_runs(notebook, tmp_path):
    for file in notebook.parent.iterdir():
        shutil.copy(file, tmp_path)
    done = subprocess.run(
        [sys.executable, "-m", "nbconvert", "--to", "notebook", "--execute", "--output", "run.ipynb", notebook.name],
        cwd=tmp_path,
        env={**os.environ, "DOTRAY_SMALL": "1", "PYTHONWARNINGS": "ignore"},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "run.ipynb").read_text()
    assert '"image/png"' in text
    if folder := os.environ.get("DOTRAY_KEEP"):
        shutil.copy(tmp_path / "run.ipynb", f"{folder}/{notebook.name}")
