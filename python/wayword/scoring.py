"""Figures of trajectories: `evaluate`, and `Evaluator` to score many times."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import errors
from ._call import PathLike, opened
from ._extras import extra
from .checking import as_file
from .platform import Platform

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._wayword import Scores

METRICS = {
    "sr": "success_rate",
    "osr": "oracle_success_rate",
    "spl": "spl",
    "ne_m": "navigation_error_m",
    "tl_m": "trajectory_length_m",
    "ndtw": "ndtw",
    "sdtw": "sdtw",
    "cls": "cls",
    "rgs": "rgs",
    "rgspl": "rgspl",
}
"""The figures by their short names. Shares are from 0 to 1; `ne_m` and `tl_m` are metres."""

Submission = PathLike | Sequence[Mapping[str, Any]] | Mapping[str, Sequence[Any]]
"""Trajectories: a file, a list of {"instr_id", "trajectory", "predObjId"}, or a mapping from instructions to
trajectories. A step of a trajectory is a viewpoint, [viewpoint, heading, elevation], or a list of viewpoints."""


class Interval(NamedTuple):
    """A mean with its 95 % interval, clustered by path: items on one path are not independent."""

    mean: float
    low: float
    high: float
    trajectories: int
    paths: int


class Evaluation:
    """The figures of a submission.

    Success is judged by a rule: "distance", the last viewpoint is under 3 m from the goal (R2R's rule), or "visible",
    the target is visible from there (REVERIE's).
    """

    def __init__(self, scores: Scores, rule: str | None = None) -> None:
        self._scores = scores
        has_visible = scores.has_rule("visible")
        if rule == "visible" and not has_visible:
            what = "no item names an object whose place is known, so nothing can be judged by what is visible"
            raise errors.InputError(what, hint='judge by distance: rule="distance"')
        self.rule = rule or ("visible" if has_visible else "distance")

    def __len__(self) -> int:
        return len(self._scores)

    @property
    def figures(self) -> dict[str, float]:
        """The mean of each figure that a trajectory has, by its short name."""
        means = {short: self._scores.mean(name, self.rule) for short, name in METRICS.items()}
        return {short: mean for short, mean in means.items() if mean is not None}

    def __getitem__(self, figure: str) -> float:
        mean = self._scores.mean(_metric(figure), self.rule)
        if mean is None:
            raise errors.InputError(f"no trajectory has the figure {figure}", hint="`figures` lists those there are")
        return mean

    def interval(self, figure: str, *, resamples: int = 2000, seed: int = 0) -> Interval:
        """A figure with its interval, by a bootstrap over paths."""
        found = self._scores.estimate(_metric(figure), self.rule, resamples, seed)
        if found is None:
            raise errors.InputError(f"no trajectory has the figure {figure}", hint="`figures` lists those there are")
        return Interval(*found)

    @property
    def instructions(self) -> list[str]:
        """The instructions, in the order of the episodes."""
        return self._scores.names()

    def values(self, figure: str) -> npt.NDArray[np.float64]:
        """A figure of each instruction, shape (instructions,), read-only; NaN where there is none."""
        return np.frombuffer(self._scores.values(_metric(figure), self.rule), dtype=np.float64)

    def to_pandas(self) -> Any:
        """The figures of each instruction as a `pandas.DataFrame`: instr_id, path, and a column for each figure.

        Raises:
            MissingExtraError: if pandas is not installed.
        """
        columns: dict[str, Any] = {"instr_id": self.instructions, "path": self._scores.paths()}
        columns.update({figure: self.values(figure) for figure in METRICS})
        return extra("pandas", "pandas").DataFrame(columns)

    def __repr__(self) -> str:
        told = ", ".join(f"{figure} {mean:.3f}" for figure, mean in self.figures.items())
        return f"Evaluation({len(self)} instructions, by {self.rule}: {told})"


def _metric(figure: str) -> str:
    if figure not in METRICS:
        raise errors.InputError(f"there is no figure {figure!r}", hint=f"name one of: {', '.join(METRICS)}")
    return METRICS[figure]


class Evaluator:
    """Scores trajectories of the same episodes again and again, as a training loop does: graphs, distances and demands
    are computed once.

    Args:
        episodes: a dataset file whose paths name viewpoints, or items as R2R or REVERIE have them.
        platform: the world that they are in.
        data, at, island, connectivity: as in `generate`.
    """

    def __init__(
        self,
        episodes: PathLike | Sequence[Mapping[str, Any]],
        *,
        platform: str | Platform = "matterport",
        data: PathLike | None = None,
        at: str | None = None,
        island: int | None = None,
        connectivity: PathLike | None = None,
    ) -> None:
        from . import _wayword

        with as_file(episodes) as file, opened(platform, data, at, island, connectivity) as where:
            self._judge = _wayword.Judge(file, **where)

    def __len__(self) -> int:
        """How many instructions the episodes have."""
        return len(self._judge)

    def score(self, submission: Submission, *, rule: str | None = None, partial: bool = False) -> Evaluation:
        """The figures of trajectories, one for each instruction.

        The definitions are those of R2R's `eval.py`, REVERIE's `eval_release.py` and VLN-DUET's `eval_utils.py`.

        Args:
            submission: the trajectories.
            rule: "distance" or "visible". Without it, what is visible where objects are known.
            partial: whether instructions may lack a trajectory. Leaderboards want every one.

        Raises:
            SubmissionError: if anything is wrong with them; nothing is scored. `problems` lists all of it, but only the
                first of entries that cannot be read.
        """
        if rule not in (None, "distance", "visible"):
            raise errors.InputError(f"there is no rule {rule!r}", hint='give "distance" or "visible"')
        if isinstance(submission, (str, os.PathLike)):
            scores = self._judge.score_file(os.fspath(submission), partial)
        elif isinstance(submission, (Mapping, Iterable)):
            handed = dict(submission) if isinstance(submission, Mapping) else submission
            scores = self._judge.score(handed, partial)
        else:
            raise errors.InputError(f"{submission!r} is no submission", hint="give a file, a list or a mapping")
        if len(scores) == 0:
            raise errors.InputError("no instruction has a trajectory, so there is nothing to score")
        return Evaluation(scores, rule)


def evaluate(
    submission: Submission,
    episodes: PathLike | Sequence[Mapping[str, Any]],
    *,
    platform: str | Platform = "matterport",
    data: PathLike | None = None,
    at: str | None = None,
    island: int | None = None,
    connectivity: PathLike | None = None,
    rule: str | None = None,
    partial: bool = False,
) -> Evaluation:
    """Scores trajectories as the evaluators of R2R and REVERIE do. See `Evaluator` for its arguments; use one to score
    more than once."""
    evaluator = Evaluator(episodes, platform=platform, data=data, at=at, island=island, connectivity=connectivity)
    return evaluator.score(submission, rule=rule, partial=partial)
