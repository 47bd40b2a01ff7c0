"""Runs as Python objects: `load_run`."""

from __future__ import annotations

import io
import json
import math
import pathlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from . import errors, notebook
from ._extras import extra

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._call import PathLike

FORMAT = "wayword/1"
"""The format of a run's instructions that this version reads."""


@dataclass(frozen=True)
class Frame:
    """A place on a path, and which way the walker looks there.

    Wayword's frame of reference: right-handed, z up, metres; headings in radians, 0 along +y, clockwise seen from
    above.
    """

    position: tuple[float, float, float]
    """The eye: x, y, z in metres; NaN where the path has no poses."""
    heading_rad: float
    """NaN where the path has no poses."""
    elevation_rad: float
    """0 is level, up is positive; NaN where the path has no poses."""
    viewpoint: str | None = None
    """The node of the viewpoint graph, if the frame is at one."""
    level: int | None = None
    """The storey; the lowest is 1."""


@dataclass(frozen=True)
class Path:
    """A path through a scene: frames from its start to its goal."""

    id: str
    scene: str
    frames: tuple[Frame, ...]
    target: str | None = None
    """The object at its end, in words."""
    target_object: str | None = None
    """The id of that object."""
    has_poses: bool = True
    """Whether it is known where the frames are. A recording without poses has frames in order, and no more."""

    @property
    def positions(self) -> npt.NDArray[np.float64]:
        """The eye at each frame: metres, shape (frames, 3); NaN without poses."""
        return np.array([frame.position for frame in self.frames], dtype=np.float64).reshape(-1, 3)

    @property
    def headings_rad(self) -> npt.NDArray[np.float64]:
        """Which way the walker looks at each frame: radians, shape (frames,); NaN without poses."""
        return np.array([frame.heading_rad for frame in self.frames], dtype=np.float64)

    @property
    def viewpoints(self) -> list[str]:
        """The nodes of the viewpoint graph, from start to goal; empty if a frame lies at none."""
        names = [frame.viewpoint for frame in self.frames if frame.viewpoint is not None]
        return names if len(names) == len(self.frames) else []

    @property
    def length_m(self) -> float | None:
        """Length over the frames, metres; `None` without poses."""
        if not self.has_poses:
            return None
        return float(np.linalg.norm(np.diff(self.positions, axis=0), axis=1).sum())


@dataclass(frozen=True)
class Finding:
    """What a check found in a text."""

    check: str
    """form, landmarks, order, turns, floors, route, coverage, leak."""
    verdict: str
    """pass, unverified or fail."""
    reason: str = ""
    span: tuple[int, int] | None = None
    """The words that it is about: a range of bytes of the text in UTF-8."""


@dataclass(frozen=True)
class Mention:
    """Words of a text that name something on the path."""

    span: tuple[int, int]
    """A range of bytes of the text in UTF-8."""
    kind: str
    """landmark, room, turn, floor or target."""
    frame: int
    """Where on the path it is, from 0."""


@dataclass(frozen=True)
class AlignedPart:
    """A part of a text, with the frames that it describes."""

    span: tuple[int, int]
    """Its byte range in the text."""
    frames: tuple[int, int]
    """The frames where it begins and ends, numbered from 0. The next part begins where it ends."""
    confidence: float | None
    """The probability of exactly these frames, from 0 to 1; None where the motion along the path is unknown."""


@dataclass(frozen=True)
class Instruction:
    """A text for a path, with what was found in it and who made it. In a notebook it is shown as a card."""

    text: str
    style: str
    verdict: str
    """pass: every check passed. unverified: something could not be checked. fail: a check failed."""
    platform: str
    path: Path
    findings: tuple[Finding, ...] = ()
    mentions: tuple[Mention, ...] = ()
    parts: tuple[AlignedPart, ...] = ()
    """Its parts in order; none in records of older versions."""
    ambiguity: Mapping[str, Any] | None = None
    """What the text may mean beside its path: `ends`, `objects`, `told_apart_by`."""
    provenance: Mapping[str, Any] = field(default_factory=dict)
    """Who asked, answered, summarised and wrote. `labels` is ground truth, `rules` is a program without a model."""
    split: str | None = None
    captions: tuple[str, ...] = field(default=(), repr=False)
    """What was seen at each frame, in words."""
    folder: pathlib.Path | None = field(default=None, repr=False)
    """The run folder, which may have pictures of the frames."""

    def picture(self, frame: int) -> bytes | None:
        """The picture of a frame (from 0), as the bytes of a JPEG file; `None` where the run has none."""
        return notebook.picture_of(self.folder, self.path.id, frame)

    def _repr_html_(self) -> str:
        return notebook.card(self)


@dataclass(frozen=True)
class Rejected:
    """A text that failed its checks, and so is not among a run's instructions."""

    path_id: str
    style: str
    reason: str
    last: Instruction | None = None
    """The best text there was."""


@dataclass(frozen=True)
class Failed:
    """A path for which nothing could be written. The same call tries it again."""

    path_id: str
    kind: str
    """missing, broken or lost."""
    reason: str


@dataclass(frozen=True, repr=False)
class Run:
    """A run folder. In a notebook its first instructions are shown as cards."""

    folder: pathlib.Path
    instructions: tuple[Instruction, ...]
    rejected: tuple[Rejected, ...]
    errors: tuple[Failed, ...]
    platform: Mapping[str, Any] = field(default_factory=dict, repr=False)
    """What the run was made on: `platform`, and where it has them `data`, `at`, `island` and `connectivity`."""
    summary: Mapping[str, Any] | None = field(default=None, repr=False)
    """What `generate` said at its end; `None` for a run that was loaded."""

    def __repr__(self) -> str:
        counts = f"{len(self.instructions)} instructions, {len(self.rejected)} rejected, {len(self.errors)} failed"
        return f"Run({str(self.folder)!r}: {counts})"

    def __len__(self) -> int:
        return len(self.instructions)

    def __iter__(self) -> Iterator[Instruction]:
        return iter(self.instructions)

    def __getitem__(self, at: int) -> Instruction:
        return self.instructions[at]

    def rows(self) -> list[dict[str, Any]]:
        """One flat dictionary for each instruction, with the columns of the data frame."""
        return [_row(instruction) for instruction in self.instructions]

    def to_pandas(self) -> Any:
        """The instructions as a `pandas.DataFrame`, a row each.

        Columns: platform, scene, path_id, split, style, text, verdict, length_m (metres), viewpoints (names),
        positions (list of [x, y, z], metres), headings_rad, target, target_object, ends (places that the text may
        mean), writer, answerer, checked_against, repairs, seed.

        Raises:
            MissingExtraError: if pandas is not installed.
        """
        return extra("pandas", "pandas").DataFrame(self.rows(), columns=list(COLUMNS))

    def to_datasets(self) -> Any:
        """The same as a `datasets.Dataset`.

        Raises:
            MissingExtraError: if datasets is not installed.
        """
        rows = self.rows()
        columns = {name: [row[name] for row in rows] for name in COLUMNS}
        return extra("datasets", "datasets").Dataset.from_dict(columns)

    def _repr_html_(self) -> str:
        return notebook.page(self)


COLUMNS = (
    "platform",
    "scene",
    "path_id",
    "split",
    "style",
    "text",
    "verdict",
    "length_m",
    "viewpoints",
    "positions",
    "headings_rad",
    "target",
    "target_object",
    "ends",
    "writer",
    "answerer",
    "checked_against",
    "repairs",
    "seed",
)
"""The columns of `Run.to_pandas`."""


def _row(instruction: Instruction) -> dict[str, Any]:
    path, made = instruction.path, instruction.provenance
    return {
        "platform": instruction.platform,
        "scene": path.scene,
        "path_id": path.id,
        "split": instruction.split,
        "style": instruction.style,
        "text": instruction.text,
        "verdict": instruction.verdict,
        "length_m": path.length_m,
        "viewpoints": path.viewpoints,
        "positions": path.positions.tolist() if path.has_poses else None,
        "headings_rad": path.headings_rad.tolist() if path.has_poses else None,
        "target": path.target,
        "target_object": path.target_object,
        "ends": (instruction.ambiguity or {}).get("ends"),
        "writer": made.get("writer"),
        "answerer": made.get("answerer"),
        "checked_against": made.get("checked_against"),
        "repairs": made.get("repairs"),
        "seed": made.get("seed"),
    }


def load_run(folder: PathLike) -> Run:
    """Reads a run folder, as `wayword generate` makes it.

    Raises:
        FileError: if it is no run folder, or a file cannot be read.
        FormatError: if a line is not of its format; `where` names file and line.
    """
    root = pathlib.Path(folder)
    if not (root / "config.toml").is_file():
        hint = "give the folder that `wayword.generate` was given as `out`"
        raise errors.FileError("it is no run folder: it holds no config.toml", str(root), hint)
    platform = _platform(root)
    walks = dict(_read(root / "walks.jsonl", lambda line: (line["path"]["id"], (_path(line["path"]), _captions(line)))))
    nothing: tuple[str, ...] = ()

    def made(line: Mapping[str, Any]) -> Instruction:
        path = _path(line["path"])
        return instruction(line, path, walks.get(path.id, (path, nothing))[1], root)

    def rejected(line: Mapping[str, Any]) -> Rejected:
        last, item = line.get("last"), line["item"]
        path, captions = walks.get(item, (Path(item, "", (), has_poses=False), nothing))
        text = None if last is None else instruction(last, path, captions, root)
        return Rejected(item, line["style"], line["reason"], text)

    def failed(line: Mapping[str, Any]) -> Failed:
        return Failed(line["item"], line.get("failure", "lost"), line["reason"])

    return Run(
        root,
        tuple(_read(root / "instructions.jsonl", made, FORMAT)),
        tuple(_read(root / "rejected.jsonl", rejected)),
        tuple(_read(root / "errors.jsonl", failed)),
        platform,
    )


_PLACES = ("platform", "data", "at", "island", "connectivity")
"""The settings that say what a run was made on."""


def _platform(folder: pathlib.Path) -> dict[str, Any]:
    from . import _wayword

    try:
        settings = json.loads(_wayword.settings(str(folder)))
    except errors.InputError as error:
        raise errors.FormatError(error.what, str(folder / "config.toml"), error.hint) from error
    return {name: settings[name] for name in _PLACES if settings.get(name) is not None}


_AGAIN = "the file was changed by hand or by another program: make the run again in another folder"
_T = TypeVar("_T")


def _read(file: pathlib.Path, of: Callable[[dict[str, Any]], _T], form: str | None = None) -> list[_T]:
    """What each line of a file holds. A last line that is not whole, of a run that was killed, is left out."""
    if not file.exists():
        return []
    try:
        text = file.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise errors.FormatError(f"it is not UTF-8: {error}", str(file), _AGAIN) from error
    except OSError as error:
        raise errors.FileError(f"it cannot be read: {error}", str(file)) from error
    found = []
    # Unlike `splitlines` this ends lines at line feeds alone: texts may have other separators.
    for number, line in enumerate(io.StringIO(text), 1):
        place = f"{file}: line {number}"
        try:
            value = json.loads(line)
        except ValueError as error:
            if not line.endswith("\n"):
                break
            raise errors.FormatError(f"it is not JSON: {error}", place, _AGAIN) from error
        if form is not None and isinstance(value, dict) and value.get("format") != form:
            problem = f"its format is {value.get('format')!r}, and this version reads {form!r}"
            raise errors.FormatError(problem, place, "read it with the version of Wayword that wrote it")
        try:
            found.append(of(value))
        except (AttributeError, IndexError, KeyError, TypeError, ValueError) as error:
            problem = f"a field is missing or wrong ({type(error).__name__}: {error})"
            raise errors.FormatError(problem, place, _AGAIN) from error
    return found


def _captions(walk: Mapping[str, Any]) -> tuple[str, ...]:
    return tuple(seen.get("summary", "") for seen in walk.get("observations", ()))


def instruction(
    line: Mapping[str, Any], path: Path, captions: Sequence[str], folder: pathlib.Path | None
) -> Instruction:
    """An instruction from its JSON object."""
    mentions = [Mention((m["span"][0], m["span"][1]), m["kind"], m["frame"]) for m in line["mentions"]]
    return Instruction(
        text=line["text"],
        style=line["style"],
        verdict=line["verdict"],
        platform=line.get("platform", ""),
        path=path,
        findings=findings_of(line["findings"]),
        mentions=tuple(mentions),
        parts=parts_of(line.get("parts", ())),
        ambiguity=line.get("ambiguity"),
        provenance=line["provenance"],
        split=line.get("split"),
        captions=tuple(captions),
        folder=folder,
    )


def parts_of(parts: Sequence[Mapping[str, Any]]) -> tuple[AlignedPart, ...]:
    """Parts of a text from their JSON."""
    return tuple(
        AlignedPart((part["span"][0], part["span"][1]), (part["frames"][0], part["frames"][1]), part.get("confidence"))
        for part in parts
    )


def findings_of(findings: Sequence[Mapping[str, Any]]) -> tuple[Finding, ...]:
    """Findings from their JSON objects."""
    return tuple(Finding(f["check"], f["verdict"], f.get("reason", ""), _span(f.get("span"))) for f in findings)


def _span(span: Sequence[int] | None) -> tuple[int, int] | None:
    return None if span is None else (span[0], span[1])


def _path(value: Mapping[str, Any]) -> Path:
    target = value.get("target") or {}
    has_poses = value.get("motion", "known") == "known"
    return Path(
        id=value["id"],
        scene=value["scene"],
        frames=tuple(_frame(frame, has_poses) for frame in value["frames"]),
        target=target.get("name"),
        target_object=target.get("object"),
        has_poses=has_poses,
    )


def _frame(value: Mapping[str, Any], has_pose: bool) -> Frame:
    # Older versions wrote zeros where there is no pose.
    unknown = {"position": [math.nan] * 3, "heading": math.nan, "elevation_rad": math.nan}
    pose: Mapping[str, Any] = value["pose"] if has_pose else unknown
    x, y, z = pose["position"]
    return Frame(
        position=(x, y, z),
        heading_rad=pose["heading"],
        elevation_rad=pose["elevation_rad"],
        viewpoint=value.get("viewpoint"),
        level=value.get("level"),
    )
