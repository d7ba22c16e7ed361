"""What the tests share."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

# The same examples on every run, and no folder of them beside the sources.
settings.register_profile("stable", derandomize=True, database=None, deadline=None)
settings.load_profile("stable")

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="session")
def program():
    """The program `dotray`, which makes the same pictures of the same scenes."""
    name = os.environ.get("DOTRAY", str(ROOT / "target/release/dotray"))
    if not Path(name).exists():
        pytest.fail(f"{name} is missing: cargo build --release, or name it by DOTRAY")

    def run(*arguments):
        done = subprocess.run([name, *map(str, arguments)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture
def random():
    return np.random.default_rng(5)
