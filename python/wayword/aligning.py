"""Alignment of anyone's texts: the parts of each text with the frames of its path that they describe: `align`."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass

from ._call import PathLike, Progress, command, flags, opened
from .checking import Texts, as_file
from .platform import Platform
from .run import AlignedPart, Run, parts_of


@dataclass(frozen=True)
class AlignedText:
    """A text with its parts."""

    path: str
    text: str
    parts: tuple[AlignedPart, ...]
    unaligned: str | None
    """Why the text could not be aligned; then it has no parts."""


def align(
    texts: Texts,
    *,
    platform: str | Platform | None = None,
    data: PathLike | None = None,
    at: str | None = None,
    island: int | None = None,
    connectivity: PathLike | None = None,
    progress: Progress = None,
) -> tuple[AlignedText, ...]:
    """Finds for each part of each text the frames of its path that it describes.

    Args:
        texts: a run, a dataset file, or a list of items as R2R or REVERIE have them.
        platform: the world that the paths are in. A run knows its own.
    """
    if isinstance(texts, Run) and platform is None:
        own = texts.platform
        platform = own["platform"]
        if data is None and at is None and island is None and connectivity is None:
            data, at, island, connectivity = (own.get(key) for key in ("data", "at", "island", "connectivity"))
    with contextlib.ExitStack() as stack:
        file = stack.enter_context(as_file(texts))
        where = stack.enter_context(opened(platform, data, at, island, connectivity, is_kept=True))
        report = command("align", file, *flags(**where), progress=progress)
    return tuple(
        AlignedText(
            text["path"],
            text["text"],
            parts_of(text["parts"]),
            text.get("unaligned"),
        )
        for text in report["texts"]
    )
