"""What can go wrong: one class for each kind of error, with what is wrong, where, and what to do."""

from __future__ import annotations

from collections.abc import Sequence


class WaywordError(Exception):
    """An error of Wayword. Its text has all of the following."""

    what: str
    """What is wrong."""
    where: str | None
    """The file, and in it the item and field; or the scene, or the program."""
    hint: str | None
    """What to do."""

    def __init__(self, what: str, where: str | None = None, hint: str | None = None) -> None:
        self.what, self.where, self.hint = what, where, hint
        place = f"{where}: " if where is not None and where not in what else ""
        super().__init__(place + what + (f"\nhint: {hint}" if hint else ""))


class InputError(WaywordError):
    """An argument is wrong, or does not fit another one."""


class FileError(WaywordError):
    """A file or folder cannot be read or written."""


class FormatError(WaywordError):
    """A dataset file breaks a rule of its format; `where` names item and field."""


class PlatformError(WaywordError):
    """A world lacks something, or its data cannot be used."""


class LostError(WaywordError):
    """A simulator, a service or the disk went away. The same call goes on where it was."""


class StyleError(WaywordError):
    """A style or a prompt is wrong."""


class ModelError(WaywordError):
    """A model cannot be reached, loaded or asked."""


class LedgerError(WaywordError):
    """The ledger, which keeps the calls of models, cannot be used."""


class WalkError(WaywordError):
    """An agent cannot walk an episode."""


class StudyError(WaywordError):
    """A study with people cannot go on."""


class BusyError(WaywordError):
    """Another process writes to the same run folder."""


class StoppedError(WaywordError):
    """A run stopped before its end: its budget is spent, or a key was refused. The same call goes on."""


class SubmissionError(WaywordError):
    """Trajectories cannot be scored; nothing was."""

    problems: Sequence[tuple[str | None, str]]
    """The instruction and what is wrong with its trajectory, up to 100,000 of them."""
    missing: int
    """How many of all problems are instructions without a trajectory."""

    def __init__(
        self, problems: Sequence[tuple[str | None, str]], count: int, missing: int = 0, hint: str | None = None
    ) -> None:
        self.problems, self.missing = problems, missing
        first = "; ".join(f"{name}: {problem}" if name else problem for name, problem in problems[:3])
        more = f"; and {count - 3} more (see `problems`)" if count > 3 else ""
        if missing:
            hint = f"add the {missing} trajectories that are missing, or give partial=True"
        super().__init__(f"nothing was scored: {first}{more}", hint=hint)


class MissingExtraError(WaywordError, ImportError):
    """A package that this call needs is not installed."""


class InternalError(WaywordError):
    """Wayword itself failed: please report it, with this text."""


_KINDS = {
    "input": InputError,
    "file": FileError,
    "format": FormatError,
    "platform": PlatformError,
    "lost": LostError,
    "stopped": StoppedError,
    "style": StyleError,
    "model": ModelError,
    "ledger": LedgerError,
    "walk": WalkError,
    "study": StudyError,
    "busy": BusyError,
    "internal": InternalError,
}


def of_kind(kind: str, what: str, where: str | None, hint: str | None) -> BaseException:
    """The exception of a kind that the extension module names."""
    if kind == "interrupted":
        return KeyboardInterrupt(what)
    if kind == "submission":
        return SubmissionError([(where, what)], 1, hint=hint)
    return _KINDS.get(kind, WaywordError)(what, where, hint)
