"""Where a text leads: `follow`, and `Follower` to follow many texts."""

from __future__ import annotations

from typing import NamedTuple

from ._call import PathLike, opened
from .platform import Platform


class Walk(NamedTuple):
    """A walk that a text may mean."""

    viewpoints: list[str]
    """Nodes of the viewpoint graph, from the start."""
    share: float
    """How likely it is that the text means it, from 0 to 1, among the walks that are thought of."""


class Follower:
    """Follows texts through the scenes of a platform, as a reader who knows the map with its rooms and labels. It uses
    no model; docs/AGENTS.md says how far it gets (`reader-map`).

    Args:
        platform: a world with a viewpoint graph.
        data, at, island, connectivity: as in `generate`.
    """

    def __init__(
        self,
        *,
        platform: str | Platform = "matterport",
        data: PathLike | None = None,
        at: str | None = None,
        island: int | None = None,
        connectivity: PathLike | None = None,
    ) -> None:
        from . import _wayword

        with opened(platform, data, at, island, connectivity) as where:
            self._map = _wayword.Map(**where)

    @property
    def scenes(self) -> list[str]:
        """The names of the scenes."""
        return self._map.scenes()

    def viewpoints(self, scene: str) -> dict[str, tuple[float, float, float]]:
        """The nodes of a scene's graph: positions of the eye, metres, z up."""
        return self._map.viewpoints(scene)

    def follow(self, text: str, *, scene: str, start: str, heading_rad: float, most: int = 10) -> list[Walk]:
        """The walks that a text may mean, the likeliest first.

        Args:
            text: an instruction in English.
            start: the viewpoint where the walker stands.
            heading_rad: which way the walker looks: radians, 0 along +y, clockwise seen from above.
            most: how many walks.

        Raises:
            InputError: if the text cannot be followed.
            PlatformError: if there is no such scene or viewpoint.
        """
        return [Walk(*walk) for walk in self._map.follow(text, (scene, start, heading_rad), most)]


def follow(
    text: str,
    *,
    scene: str,
    start: str,
    heading_rad: float,
    most: int = 10,
    platform: str | Platform = "matterport",
    data: PathLike | None = None,
    at: str | None = None,
    island: int | None = None,
    connectivity: PathLike | None = None,
) -> list[Walk]:
    """The walks that a text may mean. See `Follower` for its arguments; use one to follow more than one text."""
    follower = Follower(platform=platform, data=data, at=at, island=island, connectivity=connectivity)
    return follower.follow(text, scene=scene, start=start, heading_rad=heading_rad, most=most)
