"""Making and exporting instructions: `generate`, `export`."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

from ._call import PathLike, Progress, command, flags, opened
from .errors import InputError
from .platform import Platform
from .run import Run, load_run


def generate(
    out: PathLike,
    *,
    platform: str | Platform | None = None,
    data: PathLike | None = None,
    at: str | None = None,
    island: int | None = None,
    connectivity: PathLike | None = None,
    episodes: PathLike | None = None,
    paths: int | None = None,
    scan: str | Sequence[str] | None = None,
    hops: tuple[int, int] | None = None,
    metres: tuple[float, float] | None = None,
    style: str | Sequence[str] | None = None,
    seed: int | None = None,
    llm: str | None = None,
    see: str | None = None,
    config: PathLike | None = None,
    progress: Progress = None,
    **settings: object,
) -> Run:
    """Writes instructions for paths, checks them, and repairs or rejects those that fail.

    The same call goes on with a run that was stopped: finished texts are kept, and no call to a model is paid twice.
    Ctrl-C finishes the items in progress.

    Args:
        out: the run folder.
        platform: a name that `wayword platforms` lists, or your own world: an object of a subclass of
            `wayword.Platform`. Without it, generated houses.
        data: folder or file of the platform's data.
        at: address of a running simulator.
        island: the island of a Habitat navmesh on which paths are taken.
        connectivity: folder of viewpoint graphs in Matterport's format along which Habitat's scenes are walked.
        episodes: take the paths of this dataset file.
        paths: number of random paths.
        scan: only these scenes.
        hops: least and most hops of a random path.
        metres: least and most length of a random path.
        style: r2r, reverie, a TOML file, or NAME=DATASET; several are written for each path. Without it, r2r and
            reverie.
        llm: the model that asks, summarises and writes, as PROVIDER/MODEL; without it rules do.
        see: what looks: labels, or a model.
        config: settings as TOML.
        progress: see `wayword.command`.
        **settings: any other flag of `wayword generate`, with underscores: `per_path=3`, `max_usd=2`.

    Raises:
        StoppedError: when the budget is spent; the same call goes on.
        WaywordError: one of its kinds, see `wayword.errors`.
    """
    if settings.pop("dry_run", None):
        hint = 'wayword.command("generate", "--dry-run", ...) gives the estimate'
        raise InputError("a dry run makes no run folder", hint=hint)
    with opened(platform, data, at, island, connectivity, is_kept=True) as where:
        given = flags(
            **where,
            episodes=episodes,
            paths=paths,
            scan=scan,
            hops=_range(hops),
            metres=_range(metres),
            style=style,
            seed=seed,
            llm=llm,
            see=see,
            config=config,
            **settings,
        )
        summary: Mapping[str, Any] = command("generate", *flags(out=out), *given, progress=progress)
    return dataclasses.replace(load_run(out), summary=summary)


def _range(values: tuple[float, float] | None) -> str | None:
    return None if values is None else f"{values[0]}..{values[1]}"


def export(
    run: Run | PathLike,
    out: PathLike,
    *,
    format: str,
    style: str | None = None,
    progress: Progress = None,
    **settings: object,
) -> Mapping[str, Any]:
    """Writes a run as a file or folder that others read.

    Args:
        run: a run, or its folder.
        out: the file or folder to write.
        format: one that `wayword export --help` lists.
        style: only the texts of this style.
        **settings: any other flag of `wayword export`, with underscores: `tokenizer=...`.

    Returns:
        What was written: the number of `instructions`, the `file`, and what else the format has to say.
    """
    folder = run.folder if isinstance(run, Run) else run
    given = flags(run=folder, format=format, style=style, out=out, **settings)
    result: Mapping[str, Any] = command("export", *given, progress=progress)
    return result
