"""Wayword writes the wayfinding instructions that a person would give a robot, checks them, and measures whether people
and agents can follow them.

    import wayword

    run = wayword.generate("runs/houses", paths=3, style="r2r")     # offline, in generated houses
    run[0].text, run[0].verdict
    run.to_pandas()

    wayword.check("R2R_val_seen.json", platform="matterport", data="DATA").failed
    judge = wayword.Evaluator("R2R_val_seen.json", platform="matterport", data="DATA")
    judge.score(trajectories).figures

A world of your own is a subclass of `wayword.Platform`: see `wayword.platform`. Errors are in `wayword.errors`. What
has no function here is a command: `wayword.command("report", "--run", "runs/houses")`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import errors as errors
    from ._call import command as command
    from ._wayword import __version__ as __version__
    from .aligning import AlignedText as AlignedText
    from .aligning import align as align
    from .checking import Checks as Checks
    from .checking import check as check
    from .checking import similarity as similarity
    from .errors import WaywordError as WaywordError
    from .following import Follower as Follower
    from .following import follow as follow
    from .generating import export as export
    from .generating import generate as generate
    from .notebook import cards as cards
    from .platform import Platform as Platform
    from .run import Instruction as Instruction
    from .run import Run as Run
    from .run import load_run as load_run
    from .scoring import Evaluation as Evaluation
    from .scoring import Evaluator as Evaluator
    from .scoring import evaluate as evaluate

# Loaded when first used: a world that runs as a child needs neither NumPy nor the extension module.
_WHERE = {
    "AlignedText": "aligning",
    "Checks": "checking",
    "Evaluation": "scoring",
    "Evaluator": "scoring",
    "Follower": "following",
    "Instruction": "run",
    "Platform": "platform",
    "Run": "run",
    "WaywordError": "errors",
    "__version__": "_wayword",
    "align": "aligning",
    "cards": "notebook",
    "check": "checking",
    "command": "_call",
    "evaluate": "scoring",
    "export": "generating",
    "follow": "following",
    "generate": "generating",
    "load_run": "run",
    "similarity": "checking",
}

__all__ = [
    "AlignedText",
    "Checks",
    "Evaluation",
    "Evaluator",
    "Follower",
    "Instruction",
    "Platform",
    "Run",
    "WaywordError",
    "__version__",
    "align",
    "cards",
    "check",
    "command",
    "errors",
    "evaluate",
    "export",
    "follow",
    "generate",
    "load_run",
    "similarity",
]


def __getattr__(name: str) -> Any:
    import importlib

    if name == "errors":
        return importlib.import_module(".errors", __name__)
    if name not in _WHERE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_WHERE[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
