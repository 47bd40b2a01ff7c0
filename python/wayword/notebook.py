"""What a notebook shows: how far a call is, and instructions as cards with the pictures of their frames."""

from __future__ import annotations

import base64
import contextlib
import html
import pathlib
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._call import Progress
    from .run import Instruction, Run

MOST_FRAMES = 12
"""Frames that a card shows; of a longer path, evenly spread ones."""
MOST_CARDS = 10
"""Instructions that a run shows."""
_MOST_BYTES = 2 << 20
_COLOURS = {"pass": "#1a7f37", "unverified": "#9a6700", "fail": "#cf222e"}


@contextlib.contextmanager
def shown(progress: Progress) -> Iterator[Callable[[int, int, str], None]]:
    """A function that shows how far a call is, while the context lasts."""
    if callable(progress):
        yield progress
        return
    bar: _NotebookBar | _TerminalBar | None = None
    if progress is not False and _in_notebook():
        bar = _NotebookBar()
    elif progress is not False and sys.stderr.isatty():
        bar = _TerminalBar()
    if bar is None:
        yield lambda done, total, text: None
        return
    try:
        yield bar.show
    finally:
        bar.end()


def _in_notebook() -> bool:
    # A kernel has loaded IPython before it runs a cell.
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and type(shell).__name__ == "ZMQInteractiveShell"


class _TerminalBar:
    _drawn = False

    def show(self, done: int, total: int, text: str) -> None:
        self._drawn = True
        sys.stderr.write(f"\r\x1b[K{done}/{total} {text}"[:200])
        sys.stderr.flush()

    def end(self) -> None:
        if self._drawn:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()


class _NotebookBar:
    _display: Any = None

    def show(self, done: int, total: int, text: str) -> None:
        display = _display()
        page = display.HTML(
            f'<progress style="width:16em;vertical-align:middle" value="{done}" max="{max(total, 1)}"></progress> '
            f"{done}/{total} {html.escape(text)}"
        )
        if self._display is None:
            self._display = display.display(page, display_id=True)
        else:
            self._display.update(page)

    def end(self) -> None:
        if self._display is not None:
            self._display.update(_display().HTML(""))


def _display() -> Any:
    from IPython import display

    return display


def card(instruction: Instruction) -> str:
    """An instruction with its verdict and the frames of its path, as HTML. Every text in it is escaped."""
    path = instruction.path
    colour = _COLOURS.get(instruction.verdict, "#57606a")
    length = "" if path.length_m is None else f" · {path.length_m:.1f} m"
    head = (
        f'<b style="color:{colour}">{html.escape(instruction.verdict)}</b> '
        f"{html.escape(instruction.style)} · {html.escape(path.scene)} · path {html.escape(path.id)}{length}"
    )
    wrong = "".join(
        f"<li>{html.escape(finding.check)}: {html.escape(finding.reason)}</li>"
        for finding in instruction.findings
        # A text passes although a check could not be made, and the card of such a text stays short.
        if finding.reason and finding.verdict != "pass" and instruction.verdict != "pass"
    )
    frames = "".join(_frame(instruction, at) for at in _spread(len(path.frames)))
    return (
        '<div style="border:1px solid #8884;border-radius:6px;padding:.6em .8em;margin:.4em 0;max-width:64em">'
        f'<div style="font-size:85%">{head}</div>'
        f'<p dir="auto" style="font-size:110%;margin:.4em 0">{html.escape(instruction.text)}</p>'
        + (f"<ul>{wrong}</ul>" if wrong else "")
        + (f'<div style="display:flex;gap:6px;overflow-x:auto">{frames}</div>' if frames else "")
        + "</div>"
    )


def _spread(count: int) -> list[int]:
    if count <= MOST_FRAMES:
        return list(range(count))
    return sorted({round(n * (count - 1) / (MOST_FRAMES - 1)) for n in range(MOST_FRAMES)})


def _frame(instruction: Instruction, at: int) -> str:
    caption = instruction.captions[at] if at < len(instruction.captions) else ""
    picture = picture_of(instruction.folder, instruction.path.id, at)
    if picture is None and not caption:
        return ""
    image = ""
    if picture is not None:
        data = base64.b64encode(picture).decode()
        image = f'<img style="width:150px;border-radius:4px" alt="frame {at}" src="data:image/jpeg;base64,{data}">'
    clamp = "display:-webkit-box;-webkit-box-orient:vertical;-webkit-line-clamp:3;overflow:hidden"
    return (
        f'<figure style="margin:0;flex:0 0 150px;font-size:75%" title="{html.escape(caption)}">{image}'
        f'<figcaption style="{clamp}"><b>{at}</b> {html.escape(caption)}</figcaption></figure>'
    )


def picture_of(folder: pathlib.Path | None, item: str, frame: int) -> bytes | None:
    """The picture of a frame (from 0) of an item, as the bytes of a JPEG file; `None` where the run has none."""
    if folder is None or any(mark in item for mark in "/\\\0"):
        return None
    file = folder / "frames" / f"{item}_{frame}.jpg"
    if file.is_symlink() or not file.is_file() or file.stat().st_size > _MOST_BYTES:
        return None
    data = file.read_bytes()
    return data if data.startswith(b"\xff\xd8\xff") else None


def page(run: Run) -> str:
    """A run as HTML: how many texts it has, and the first of them as cards."""
    counts = (
        f"<b>{html.escape(str(run.folder))}</b>: {len(run.instructions)} instructions, {len(run.rejected)} rejected, "
        f"{len(run.errors)} failed"
    )
    cards = "".join(card(instruction) for instruction in run.instructions[:MOST_CARDS])
    more = len(run.instructions) - MOST_CARDS
    return f"<div>{counts}</div>{cards}" + (f"<div>and {more} more</div>" if more > 0 else "")


def cards(instructions: Sequence[Instruction]) -> Any:
    """Shows instructions as cards in a notebook.

    Raises:
        MissingExtraError: if IPython is not installed.
    """
    from ._extras import extra

    display = extra("IPython.display", "notebook")
    return display.HTML("".join(card(instruction) for instruction in instructions))
