"""The buildings as the follower perceives them: viewpoints, the ways between them, and what labels say there.

Read from Matterport3D's own files and REVERIE's boxes (docs/DATA.md), without Wayword: neither its code nor its word lists. Positions are in metres,
z is up, a heading of 0 looks along +y and grows clockwise, in radians.
"""

import json
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOMS = {
    "a": "bathroom", "b": "bedroom", "c": "closet", "d": "dining room", "e": "entryway foyer", "f": "family room", "g": "garage", "h": "hallway",
    "i": "library", "j": "laundry room", "k": "kitchen", "l": "living room", "m": "meeting room", "n": "lounge", "o": "office",
    "p": "porch terrace", "r": "game room", "s": "stairs", "t": "toilet", "u": "utility room", "v": "tv room", "w": "gym",
    "x": "outdoor", "y": "balcony", "B": "bar", "C": "classroom", "D": "dining booth", "S": "spa",
}
VIEW_RAD = math.radians(30)
MAX_LABELS = 24


def words_of(name: str) -> list[str]:
    """The words of a label or a text: letters and digits, and the full stops and commas of a text."""
    return re.findall(r"[a-z]+|[0-9]+|[.,]", name.lower())


@dataclass
class World:
    """All buildings in one numbering. `way` arrays have a row for each directed way; the ways out of node n are start[n]..start[n + 1]."""

    index: dict[tuple[str, str], int]
    names: list[tuple[str, str]]
    position: np.ndarray
    start: np.ndarray
    way_to: np.ndarray
    way_heading: np.ndarray
    way_rise: np.ndarray
    way_length: np.ndarray
    node_words: list[list[str]]
    node_objects: list[set[str]]
    room_words: list[list[str]]
    way_words: list[list[str]]
    place_of_way: dict[tuple[int, int], int]
    offset: dict[str, int]
    distance: dict[str, np.ndarray]
    next_hop: dict[str, np.ndarray]

    def metres(self, scan: str, a: int, b: int) -> float:
        """The length of the shortest way between two nodes of a building."""
        return float(self.distance[scan][a - self.offset[scan], b - self.offset[scan]])

    def hop(self, scan: str, a: int, b: int) -> int:
        """The node after `a` on the shortest way to `b`; `a` itself at `b`."""
        return int(self.next_hop[scan][a - self.offset[scan], b - self.offset[scan]]) + self.offset[scan]


def shortest_ways(count: int, ways: list[tuple[int, int, float]]) -> tuple[np.ndarray, np.ndarray]:
    """Distances and next hops between all pairs (Floyd and Warshall)."""
    distance = np.full((count, count), np.inf)
    hop = np.tile(np.arange(count), (count, 1))
    np.fill_diagonal(distance, 0)
    np.fill_diagonal(hop, np.arange(count))
    for a, b, metres in ways:
        distance[a, b] = metres
    for k in range(count):
        through = distance[:, k : k + 1] + distance[k : k + 1, :]
        shorter = through < distance - 1e-9
        distance = np.where(shorter, through, distance)
        hop = np.where(shorter, hop[:, k : k + 1], hop)
    return distance, hop


def read_rooms(data: Path, scan: str) -> dict[str, str]:
    """The letter of the room of each viewpoint."""
    path = data / f"matterport/v1/scans/{scan}/house_segmentations/panorama_to_region.txt"
    if not path.exists():
        return {}
    rows = [line.split() for line in path.read_text().splitlines() if line.strip()]
    return {row[1]: row[3] for row in rows}


def labels_at(data: Path, scan: str, viewpoint: str) -> list[tuple[str, str, list[int]]]:
    """The objects that are seen from a viewpoint: id, name, and the views (0..35) that show it."""
    path = data / f"reverie/BBox/{scan}_{viewpoint}.json"
    if not path.exists():
        return []
    seen = json.loads(path.read_text()).get(viewpoint, {})
    return [(object_id, box["name"].replace("#", " "), box["visible_pos"]) for object_id, box in seen.items() if box["visible_pos"]]


def read_world(data: Path, scans: list[str]) -> World:
    """Reads these buildings. A building without a graph file is an error; one without labels has viewpoints of which nothing is known."""
    index, names, position, start, offset, distance, next_hop = {}, [], [], [0], {}, {}, {}
    way_to, way_heading, way_rise, way_length, node_words, node_objects, room_words, way_words, place_of_way = [], [], [], [], [], [], [], [], {}
    for scan in scans:
        graph = json.loads((data / f"matterport/connectivity/{scan}_connectivity.json").read_text())
        rooms = read_rooms(data, scan)
        kept = [row for row, node in enumerate(graph) if node["included"]]
        number = {row: place for place, row in enumerate(kept)}
        offset[scan] = len(names)
        ways = []
        for row in kept:
            node = graph[row]
            here = np.array([node["pose"][3], node["pose"][7], node["pose"][11] - node["height"]])
            index[scan, node["image_id"]] = len(names)
            names.append((scan, node["image_id"]))
            position.append(here)
            labels = labels_at(data, scan, node["image_id"])
            node_words.append([word for _, name, _ in labels for word in words_of(name)])
            node_objects.append({object_id for object_id, _, _ in labels})
            room_words.append(words_of(ROOMS.get(rooms.get(node["image_id"], ""), "")))
            for other in kept:
                if other == row or not (node["unobstructed"][other] and graph[other]["unobstructed"][row]):
                    continue
                pose = graph[other]["pose"]
                there = np.array([pose[3], pose[7], pose[11] - graph[other]["height"]])
                step = there - here
                heading = math.atan2(step[0], step[1])
                metres = float(np.linalg.norm(np.array([pose[3], pose[7], pose[11]]) - np.array(node["pose"])[[3, 7, 11]]))
                ahead = [
                    word
                    for _, name, views in labels
                    if any(abs(math.remainder(view % 12 * VIEW_RAD - heading, 2 * math.pi)) <= VIEW_RAD for view in views)
                    for word in words_of(name)
                ]
                place_of_way[offset[scan] + number[row], offset[scan] + number[other]] = len(way_to) - start[-1]
                ways.append((number[row], number[other], metres))
                way_to.append(offset[scan] + number[other])
                way_heading.append(heading)
                way_rise.append(float(step[2]))
                way_length.append(metres)
                way_words.append(ahead)
            start.append(len(way_to))
        distance[scan], next_hop[scan] = shortest_ways(len(kept), ways)
    return World(
        index, names, np.array(position), np.array(start), np.array(way_to), np.array(way_heading), np.array(way_rise), np.array(way_length),
        node_words, node_objects, room_words, way_words, place_of_way, offset, distance, next_hop,
    )
