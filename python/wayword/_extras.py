"""Packages that only some calls need."""

from __future__ import annotations

import importlib
from typing import Any

from .errors import MissingExtraError


def extra(module: str, name: str) -> Any:
    """A module of an optional package.

    Raises:
        MissingExtraError: if it is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        hint = f"pip install 'wayword[{name}]'"
        raise MissingExtraError(f"this call needs the package {package} ({error})", hint=hint) from error
