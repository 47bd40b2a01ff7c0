"""Calls of the program's commands inside this process."""

from __future__ import annotations

import atexit
import contextlib
import itertools
import json
import logging
import os
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any, Union

from . import errors
from ._guard import GUARDIAN
from .platform import Platform, answer

Progress = bool | None | Callable[[int, int, str], None]
"""How far a call is: a function of (done, total, text); `True` or `None` for a bar in a notebook or terminal; `False`
for none."""

PathLike = Union[str, "os.PathLike[str]"]

_log = logging.getLogger("wayword")

# The program's exit codes: docs/CLI.md lists them.
_ENDS = {1: errors.InputError, 5: errors.StoppedError, 7: errors.LostError}

# The threads that are inside a call, and those that ask a world for one.
_inside_call = threading.local()


class _Hears:
    """Hears what a command says: messages go to the logger `wayword`, and how far it is to a function."""

    def __init__(self, show: Callable[[int, int, str], None]) -> None:
        self.show = show
        self.last: tuple[int, int, str] | None = None

    def progress(self, done: int, total: int, text: str) -> None:
        if (done, total, text) != self.last:
            self.last = (done, total, text)
            self.show(done, total, text)

    def say(self, text: str) -> None:
        _log.log(logging.WARNING if text.startswith("warning") else logging.INFO, "%s", text)


def command(*arguments: object, progress: Progress = None) -> Any:
    """Runs any command of `wayword` in this process, and returns its result, as `--json` prints it.

    `wayword.command("ledger", "show")`, for commands that have no function of their own. Texts that fail a check are no
    error: the result says so. Ctrl-C lets the command come to its end.

    Raises:
        WaywordError: one of its kinds, see `wayword.errors`.
    """
    from . import _wayword
    from .notebook import shown

    _wayword.guarded_by(*GUARDIAN)
    with _alone(), shown(progress) as show:
        typed = [os.fspath(one) if isinstance(one, os.PathLike) else str(one) for one in arguments]
        code, told = _wayword.call(typed, _Hears(show))
    result = json.loads(told) if told else None
    if code in _ENDS:
        reason = (result or {}).get("stopped") or (result or {}).get("reason") or "the command stopped before its end"
        what, _, hint = str(reason).partition("\nhint: ")
        raise _ENDS[code](what, hint=hint or "give the same call again to go on")
    return result


@contextlib.contextmanager
def _alone() -> Iterator[None]:
    """Refuses a call inside a call, which would wait for itself: from `progress`, a log handler or a world."""
    if getattr(_inside_call, "is_so", False):
        what = "a command cannot be called from `progress`, from a log handler or from a world"
        raise errors.InputError(what, hint="call it when the other one has returned")
    _inside_call.is_so = True
    try:
        yield
    finally:
        _inside_call.is_so = False


@atexit.register
def _finish() -> None:
    module = sys.modules.get("wayword._wayword")
    if module is not None:
        module.finish()


def flags(**values: object) -> list[str]:
    """Keyword arguments as flags: `per_path=2` is `--per-path=2`, a list is repeated, `True` is the flag alone."""
    given: list[str] = []
    for name, value in values.items():
        flag = "--" + name.replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            given.append(flag)
        else:
            each: list[object] = list(value) if isinstance(value, (list, set, tuple)) else [value]
            # With a sign of equality, so that no value is taken for a flag.
            given += [f"{flag}={os.fspath(one) if isinstance(one, os.PathLike) else one}" for one in each]
    return given


def file_name(path: PathLike) -> str:
    """A path as an argument: one that begins with a hyphen is no flag."""
    name = os.fspath(path)
    return os.path.join(os.curdir, name) if name.startswith("-") else name


def opened(
    platform: str | Platform | None,
    data: PathLike | None,
    at: str | None,
    island: int | None,
    connectivity: PathLike | None,
    *,
    is_kept: bool = False,
) -> contextlib.AbstractContextManager[dict[str, Any]]:
    """The flags that name a platform. A world of this process is known while the context lasts; where a run keeps its
    name (`is_kept`), it is known by its class, and worlds of one class take turns."""
    from . import _wayword

    _wayword.guarded_by(*GUARDIAN)
    if platform is None or isinstance(platform, str):
        named = {
            "platform": platform,
            "data": None if data is None else os.fspath(data),
            "at": at,
            "island": island,
            "connectivity": None if connectivity is None else os.fspath(connectivity),
        }
        return contextlib.nullcontext(named)
    if any(given is not None for given in (data, at, island, connectivity)):
        problem = "a world of this process takes no data, at, island or connectivity"
        raise errors.InputError(problem, hint="leave them out")
    if not isinstance(platform, Platform):
        hint = "give a name from `wayword platforms`, or an object of a subclass of wayword.Platform"
        raise errors.InputError(f"platform {platform!r} is no world", hint=hint)
    return _inside(platform, is_kept)


_WORLDS: dict[str, threading.Lock] = {}
_numbers = itertools.count(1)


@contextlib.contextmanager
def _inside(world: Platform, is_kept: bool) -> Iterator[dict[str, Any]]:
    from . import _wayword

    def asked(line: bytes) -> bytes:
        with _alone():
            return answer(world, json.loads(line)).encode()

    name = type(world).__name__
    turn = _WORLDS.setdefault(name, threading.Lock()) if is_kept else contextlib.nullcontext()
    with turn:
        known = name if is_kept else f"{name}-{next(_numbers)}"
        data = _wayword.put_world(known, asked, world.width_px, world.height_px, world.spacing_m)
        try:
            yield {"platform": "process", "data": os.fspath(data), "at": None, "island": None, "connectivity": None}
        finally:
            _wayword.forget_world(data)
