"""What the tests share."""

import os
import pathlib
import subprocess
import sys

import pytest

PYTHON = pathlib.Path(__file__).resolve().parent.parent


@pytest.fixture
def cli():
    """Runs the program with arguments, as `python -m wayword` does. Returns the completed process."""

    def run(*arguments, **options):
        typed = [sys.executable, "-m", "wayword", *map(str, arguments)]
        return subprocess.run(typed, capture_output=True, text=True, timeout=600, **options)

    return run


@pytest.fixture(scope="session")
def houses(tmp_path_factory):
    """A run over two paths in generated houses."""
    import wayword

    return wayword.generate(tmp_path_factory.mktemp("runs") / "houses", paths=2, seed=3, style=["r2r", "reverie"])


@pytest.fixture(scope="session")
def data():
    """The folder of real data, where it is there."""
    folder = pathlib.Path(os.environ.get("WAYWORD_DATA", PYTHON.parent.parent / "shared" / "data"))
    if not (folder / "r2r" / "R2R_val_seen.json").exists():
        pytest.skip(f"there is no real data at {folder} (WAYWORD_DATA)")
    return folder
