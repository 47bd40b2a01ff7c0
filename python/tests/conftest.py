"""What the tests share."""

import subprocess
import sys

import pytest


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
