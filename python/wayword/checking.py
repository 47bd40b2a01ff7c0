"""Checks of anyone's texts: `check`, and how much two sets of texts are alike: `similarity`."""

from __future__ import annotations

import contextlib
import json
import os
import pathlib
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from . import errors
from ._call import PathLike, Progress, command, file_name, flags, opened
from .platform import Platform
from .run import Finding, Run, findings_of

Texts = Run | PathLike | Sequence[Mapping[str, Any]]
"""Texts with their paths: a run, a dataset file, or items of R2R's or REVERIE's format."""


@dataclass(frozen=True)
class CheckedText:
    """A text that did not pass."""

    path: str
    text: str
    verdict: str
    """unverified or fail."""
    findings: tuple[Finding, ...]


@dataclass(frozen=True)
class Checks:
    """What was found in texts."""

    passed: int
    unverified: int
    failed: int
    checked_against: tuple[str, ...]
    """The evidence: labels (ground truth), a detector, captions, or the path alone."""
    by_check: Mapping[str, Mapping[str, int]]
    """For each check, how many texts passed, were unverified, or failed."""
    not_passed: tuple[CheckedText, ...]
    report: Mapping[str, Any] = field(repr=False)
    """Everything, as `wayword check --json` prints it."""


def check(
    texts: Texts,
    *,
    run: PathLike | None = None,
    platform: str | Platform | None = None,
    data: PathLike | None = None,
    at: str | None = None,
    island: int | None = None,
    connectivity: PathLike | None = None,
    style: str | None = None,
    progress: Progress = None,
    **settings: object,
) -> Checks:
    """Checks texts against what their paths show. Texts that fail are no error.

    Args:
        texts: a run, a dataset file, or a list of items as R2R or REVERIE have them.
        run: check against what this run saw, in place of a platform.
        platform: the world that the paths are in. A run knows its own; one that was made in a world of a Python program
            is checked against what it saw.
        style: check that every text keeps to this style.
        **settings: any other flag of `wayword check`, with underscores: `world="open"`, `doubts=True`.
    """
    if isinstance(texts, Run) and platform is None and run is None:
        own = texts.platform
        platform = own["platform"]
        if data is None and str(own.get("data", "")).startswith("python:"):
            platform, run = None, texts.folder
        elif data is None and at is None and island is None and connectivity is None:
            data, at, island, connectivity = (own.get(key) for key in ("data", "at", "island", "connectivity"))
    with contextlib.ExitStack() as stack:
        file = stack.enter_context(as_file(texts))
        where: Mapping[str, Any] = {"run": run}
        if run is None:
            where = stack.enter_context(opened(platform, data, at, island, connectivity, is_kept=True))
        report = command("check", file, *flags(**where, style=style, **settings), progress=progress)
    not_passed = tuple(
        CheckedText(
            text["path"],
            text["text"],
            text["verdict"],
            findings_of(text["findings"]),
        )
        for text in report["not_passed"]
    )
    return Checks(
        passed=report["passed"],
        unverified=report["unverified"],
        failed=report["failed"],
        checked_against=tuple(report["checked_against"]),
        by_check=report["by_check"],
        not_passed=not_passed,
        report=report,
    )


def similarity(
    a: Texts,
    b: Texts,
    *,
    by: str = "item",
    style: str | None = None,
    encoder: str = "words",
    metrics: bool = False,
    progress: Progress = None,
    **settings: object,
) -> Mapping[str, Any]:
    """How similar the texts of `a` are to those of `b`, beside two texts of one item and texts at random.

    Args:
        a, b: a run, a dataset file (with #STYLE for one style), or items.
        by: "item": texts of the same item; "path": of the same path, whatever the target.
        encoder: a sentence encoder as hf/ORG/NAME; "words" counts words and needs no model.
        metrics: BLEU, ROUGE-L and CIDEr-D in place of a cosine.
        **settings: any other flag of `wayword similarity`, with underscores.

    Returns:
        The figures, as `wayword similarity --json` prints them.
    """
    with as_file(a, style) as left, as_file(b, style) as right:
        given = flags(by=by, encoder=encoder, metrics=metrics, **settings)
        result: Mapping[str, Any] = command("similarity", left, right, *given, progress=progress)
    return result


@contextlib.contextmanager
def as_file(texts: Texts, style: str | None = None) -> Iterator[str]:
    """The file of texts. Items are written to one for as long as the context lasts."""
    mark = f"#{style}" if style else ""
    if isinstance(texts, Run):
        yield str(texts.folder / "instructions.jsonl") + mark
    elif isinstance(texts, (str, os.PathLike)):
        yield file_name(texts) + mark
    else:
        items = list(texts)
        if not all(isinstance(item, Mapping) for item in items):
            hint = "give a file, a run, or a list of dictionaries like the items of R2R"
            raise errors.InputError("a text needs its path", hint=hint)
        with tempfile.TemporaryDirectory(prefix="wayword-") as folder:
            file = pathlib.Path(folder) / "texts.json"
            file.write_text(json.dumps([dict(item) for item in items]), encoding="utf-8")
            yield str(file)
