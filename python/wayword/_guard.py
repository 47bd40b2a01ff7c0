"""How this package is started again, to guard the child processes of this one."""

from __future__ import annotations

import pathlib
import sys

# The package that runs here, whatever the current folder or PYTHONPATH has.
_START = (
    f"import sys; sys.path.insert(0, {str(pathlib.Path(__file__).resolve().parent.parent)!r}); "
    "from wayword.__main__ import main; sys.exit(main())"
)
GUARDIAN: tuple[str, list[str]] = (sys.executable or "python3", ["-c", _START])
