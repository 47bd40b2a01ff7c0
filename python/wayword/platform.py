"""A world for Wayword: write a subclass of `Platform`.

    import wayword
    from wayword.platform import Label, Platform, View

    class MyWorld(Platform):
        name = "my world"
        has_labels = True                                 # each View lists all visible objects

        def scenes(self):
            return ["kitchen"]

        def points(self, scene, count, seed):             # places where the eye can be
            return [(x, y, 1.5), ...]

        def walkable(self, scene, a, b):                  # whether one can walk straight from a to b
            return True

        def observe(self, scene, look):
            return View(image=rgb_rows, labels=[Label("7", "lamp", position=(1, 2, 1))])

    run = wayword.generate("runs/mine", platform=MyWorld(), paths=3)

This file needs nothing but Python 3.9 or later. Where the package `wayword` cannot be installed, in the environment of
a simulator say, copy the file beside your own script as `wayword_platform.py`, end the script with

    if __name__ == "__main__":
        serve(MyWorld)

and give the script, or a world file that names it, to `wayword generate --platform process --data`. docs/PROCESS.md
describes the protocol; examples are in python/examples/. While a world is served, everything that it prints goes to
standard error, even from libraries in C, because standard output carries the protocol.

Leave out the methods that your world does not have: they are not offered.

Wayword's frame: right-handed, z up, metres; a heading is in radians, 0 along +y, clockwise seen from above. The
functions `wayword_from_...` convert to this frame, and `..._from_wayword` from it.
"""

from __future__ import annotations

import base64
import json
import math
import os
import random
import struct
import sys
import traceback
import zlib
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple

Place = Tuple[float, float, float]

PROTOCOL = 1
FRAME = "z-up, metres, radians clockwise from +y"


class Refused(Exception):
    """Raise this for a request that cannot be fulfilled. The world continues to serve."""

    code: Optional[str] = None


class UnknownScene(Refused):
    """Raise this if there is no such scene."""

    code = "unknown_scene"


@dataclass
class Look:
    """The view to return: position, direction and field of view. The elevation is 0; pixels are square."""

    position: Place  # the eye, metres
    heading_rad: float
    horizontal_fov_rad: float
    vertical_fov_rad: float
    width_px: int
    height_px: int
    viewpoint: Optional[str] = None  # the id of the point, if the eye is at one
    picture: bool = True  # False: the picture is not used, so it need not be drawn


@dataclass
class Label:
    """A visible object. Give the centre of its box as `position`, or else a direction."""

    object: str  # its id, unique in the scene
    name: str  # in plain words: "coffee table"
    position: Optional[Sequence[float]] = None
    heading_rad: Optional[float] = None
    elevation_rad: Optional[float] = None
    distance_m: Optional[float] = None
    box_px: Optional[Sequence[float]] = None  # x, y of the upper left corner, width, height
    colour: Optional[str] = None


@dataclass
class View:
    """A view. `image` is a PNG or JPEG file as bytes, a path below the world's folder `images`, or pixels: rows
    from the top, RGB, as a numpy array (height, width, 3) of bytes or as plain bytes of that length."""

    image: Any = None
    labels: Optional[Sequence[Label]] = None  # all objects whose centre is in the view; further ones are ignored
    room: Optional[str] = None  # the room in which the eye is, such as "living room"


@dataclass
class Walk:
    """A path that your world chooses: stops are ids of viewpoints, or positions (x, y, z) of the eye."""

    stops: Sequence[Any]
    heading_rad: Optional[float] = None  # at the start; None: towards the second stop
    target: Optional[str] = None  # the id of the object that the path leads to


class Platform:
    """A simulator. It needs `scenes` and `observe`, and `graph`, or `points` with `neighbours` or `walkable`.

    The methods besides `scenes` and `observe`, and what they return:

    graph(scene)                             ({id: (x, y, z)}, [(id, id), ...]): viewpoints, and edges between them
    points(scene, count, seed)               {id: (x, y, z)}, or [(x, y, z), ...] without ids: about `count` of them
    neighbours(scene, viewpoint)             [id, ...]
    walkable(scene, a, b)                    bool: whether one can walk straight from position a to position b
    sample_path(scene, hops, length_m, seed) a Walk, or None if there is none; hops and length_m are (least, most)
    object_name(scene, object)               its name, or None
    visible_from(scene, object)              [id, ...] of viewpoints, or None if objects are not known
    """

    name = "a world"
    has_pictures = True  # each View has an image, if `look.picture` is True
    has_labels = False  # each View has labels; an empty list means that no object is visible
    has_rooms = False  # a View may name the room
    images: Optional[str] = None  # folder of the pictures that are sent as files
    # Of an object that is given to `wayword.generate`; for a child process the world file says them.
    width_px, height_px = 640, 480  # of pictures
    spacing_m = 1.0  # between viewpoints, where Wayword makes the graph

    def scenes(self) -> Sequence[str]:
        """The names of the scenes."""
        raise NotImplementedError

    def observe(self, scene: str, look: Look) -> View:
        """What is seen from a place."""
        raise NotImplementedError


class OpenPlatform(Platform):
    """A world that knows whether a place is free. `points` and `walkable` are computed from that."""

    def bounds(self, scene: str) -> Tuple[Place, Place]:
        """The lowest and the highest (x, y, z) at which the eye may be."""
        raise NotImplementedError

    def is_free(self, scene: str, place: Place) -> bool:
        """Whether one can stand so that the eye is at this place."""
        raise NotImplementedError

    def points(self, scene: str, count: int, seed: int) -> List[Place]:
        """About `count` free places."""
        dice = random.Random(seed)
        least, most = self.bounds(scene)
        (x0, y0, z0), (x1, y1, z1) = least, most
        places = [(dice.uniform(x0, x1), dice.uniform(y0, y1), dice.uniform(z0, z1)) for _ in range(count)]
        return [place for place in places if self.is_free(scene, place)]

    def walkable(self, scene: str, a: Place, b: Place) -> bool:
        """Whether all places between two are free, 10 cm apart."""
        steps = max(1, math.ceil(math.dist(a, b) / 0.1))
        for n in range(steps + 1):
            x, y, z = (p + (q - p) * n / steps for p, q in zip(a, b))
            if not self.is_free(scene, (x, y, z)):
                return False
        return True


OPTIONAL = ("graph", "points", "neighbours", "walkable", "sample_path", "object_name", "visible_from")


def serve(make_world: Callable[[], Platform]) -> None:
    """Makes the world (from a subclass of Platform, or a function that returns one) and answers requests until Wayword
    closes the pipe."""
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    # From here on everything that is printed, even by C, goes to standard error, and no other code reads requests.
    os.dup2(2, 1)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    sys.stdout = sys.stderr
    world = make_world()
    for line in requests:
        answers.write(answer(world, json.loads(line)).encode() + b"\n")
        answers.flush()


def answer(world: Platform, request: Mapping[str, Any]) -> str:
    """The answer to one request, as a line of JSON."""
    try:
        method = METHODS.get(request["method"])
        if method is None:
            raise Refused(f"there is no method {request['method']!r}")
        result = method(world, request["params"])
        return json.dumps({"id": request["id"], "result": result}, allow_nan=False)
    except Exception as error:
        if not isinstance(error, Refused):
            traceback.print_exc()
        message = str(error) if isinstance(error, Refused) else f"{type(error).__name__}: {error}"
        code = error.code if isinstance(error, Refused) else None
        return json.dumps({"id": request["id"], "error": {"code": code, "message": message}})


def _hello(world: Any, params: Mapping[str, Any]) -> Dict[str, Any]:
    if params["protocol"] != PROTOCOL:
        raise Refused(f"Wayword speaks version {params['protocol']}, but this kit speaks version {PROTOCOL}")
    offers = [name for name in OPTIONAL if hasattr(world, name)]
    offers += [name for name in ("pictures", "labels", "rooms") if getattr(world, "has_" + name)]
    greeting = {"protocol": PROTOCOL, "frame": FRAME, "name": world.name, "offers": offers}
    if world.images is not None:
        greeting["images"] = os.path.abspath(world.images)
    return greeting


def _graph(world: Any, params: Mapping[str, Any]) -> Dict[str, Any]:
    places, edges = world.graph(params["scene"])
    return {"viewpoints": _places(places), "edges": [[str(a), str(b)] for a, b in edges]}


def _points(world: Any, params: Mapping[str, Any]) -> Dict[str, Any]:
    return {"points": _places(world.points(params["scene"], params["count"], params["seed"]))}


def _places(places: Any) -> List[Dict[str, Any]]:
    if isinstance(places, dict):
        return [{"id": str(name), "position": _numbers(place)} for name, place in places.items()]
    return [{"position": _numbers(place)} for place in places]


def _neighbours(world: Any, params: Mapping[str, Any]) -> Dict[str, Any]:
    return {"viewpoints": [str(name) for name in world.neighbours(params["scene"], params["viewpoint"])]}


def _walkable(world: Any, params: Mapping[str, Any]) -> Dict[str, Any]:
    return {"walkable": [bool(world.walkable(params["scene"], tuple(a), tuple(b))) for a, b in params["pairs"]]}


def _sample_path(world: Any, params: Mapping[str, Any]) -> Dict[str, Any]:
    hops, length_m = tuple(params["hops"]), tuple(params["length_m"])
    walk = world.sample_path(params["scene"], hops, length_m, params["seed"])
    if walk is None:
        return {"path": None}
    stops = [{"viewpoint": s} if isinstance(s, str) else {"position": _numbers(s)} for s in walk.stops]
    heading = None if walk.heading_rad is None else float(walk.heading_rad)
    return {"path": {"stops": stops, "heading_rad": heading, "target": walk.target}}


def _observe(world: Any, params: Mapping[str, Any]) -> Dict[str, Any]:
    params = dict(params)
    scene = params.pop("scene")
    known = {name: params[name] for name in Look.__dataclass_fields__ if name in params}
    look = Look(**dict(known, position=tuple(params["position"])))
    view = world.observe(scene, look)
    result = {"room": view.room}
    if view.labels is not None:
        result["labels"] = [_label(label) for label in view.labels]
    if look.picture and view.image is not None:
        result["image"] = _image(view.image, look.width_px, look.height_px)
    return result


def _label(label: Label) -> Dict[str, Any]:
    sent: Dict[str, Any] = {"object": str(label.object), "name": label.name, "colour": label.colour}
    for name in ("position", "box_px"):
        value = getattr(label, name)
        sent[name] = None if value is None else _numbers(value)
    for name in ("heading_rad", "elevation_rad", "distance_m"):
        value = getattr(label, name)
        sent[name] = None if value is None else float(value)
    return sent


def _image(image: Any, width_px: int, height_px: int) -> Dict[str, str]:
    if isinstance(image, (str, os.PathLike)):
        return {"file": os.fspath(image)}
    shape = getattr(image, "shape", None)
    if shape is not None:
        if tuple(shape) != (height_px, width_px, 3) or image.dtype.itemsize != 1:
            expected = f"({height_px}, {width_px}, 3) of uint8"
            raise ValueError(f"the image is {tuple(shape)} of {image.dtype}, expected {expected}")
        image = image.tobytes()
    image = bytes(image)
    if not image.startswith((b"\x89PNG", b"\xff\xd8\xff")) or len(image) == width_px * height_px * 3:
        image = png(image, width_px, height_px)
    return {"base64": base64.b64encode(image).decode()}


def _object_name(world: Any, params: Mapping[str, Any]) -> Dict[str, Any]:
    return {"name": world.object_name(params["scene"], params["object"])}


def _visible_from(world: Any, params: Mapping[str, Any]) -> Dict[str, Any]:
    found = world.visible_from(params["scene"], params["object"])
    return {"viewpoints": None if found is None else [str(name) for name in found]}


METHODS: Dict[str, Callable[[Any, Mapping[str, Any]], Dict[str, Any]]] = {
    "hello": _hello,
    "scenes": lambda world, _: {"scenes": [str(name) for name in world.scenes()]},
    "graph": _graph,
    "points": _points,
    "neighbours": _neighbours,
    "walkable": _walkable,
    "sample_path": _sample_path,
    "observe": _observe,
    "object_name": _object_name,
    "visible_from": _visible_from,
}


def _numbers(values: Any) -> List[float]:
    return [float(value) for value in values]


def png(rgb: bytes, width_px: int, height_px: int) -> bytes:
    """A PNG file made from pixels: rows from the top, RGB."""
    stride = width_px * 3
    if len(rgb) != stride * height_px:
        raise ValueError(f"{width_px} x {height_px} pixels need {stride * height_px} bytes, not {len(rgb)}")
    rows = b"".join(b"\0" + rgb[start : start + stride] for start in range(0, len(rgb), stride))

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", width_px, height_px, 8, 2, 0, 0, 0)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


# Right-handed with y up and -z ahead: OpenGL, Habitat, MiniWorld, glTF.


def wayword_from_y_up(position: Sequence[float]) -> Place:
    x, y, z = position
    return (x, -z, y)


def y_up_from_wayword(position: Sequence[float]) -> Place:
    x, y, z = position
    return (x, z, -y)


# Left-handed with y up and z ahead: Unity, AI2-THOR, ThreeDWorld. Yaw is in degrees, clockwise from +z.


def wayword_from_unity(position: Sequence[float]) -> Place:
    x, y, z = position
    return (x, z, y)


def unity_from_wayword(position: Sequence[float]) -> Place:
    return wayword_from_unity(position)


def wayword_from_unity_yaw(yaw_deg: float) -> float:
    return math.radians(yaw_deg) % math.tau


def unity_yaw_from_wayword(heading_rad: float) -> float:
    return math.degrees(heading_rad) % 360


# Left-handed with z up, x ahead, y right, centimetres: Unreal; CARLA in metres. Yaw is in degrees, clockwise from +x.


def wayword_from_unreal(position: Sequence[float], metres_per_unit: float = 0.01) -> Place:
    x, y, z = position
    return (y * metres_per_unit, x * metres_per_unit, z * metres_per_unit)


def unreal_from_wayword(position: Sequence[float], metres_per_unit: float = 0.01) -> Place:
    x, y, z = position
    return (y / metres_per_unit, x / metres_per_unit, z / metres_per_unit)


# Unreal's x (ahead at yaw 0) is Wayword's y (ahead at heading 0), and both angles turn clockwise.
wayword_from_unreal_yaw = wayword_from_unity_yaw
unreal_yaw_from_wayword = unity_yaw_from_wayword


# Counter-clockwise angles: from +x (mathematics, MuJoCo, ROS, MiniWorld), and from -z (Habitat: yaw about y, up).


def wayword_from_angle(angle_rad: float) -> float:
    return (math.pi / 2 - angle_rad) % math.tau


def angle_from_wayword(heading_rad: float) -> float:
    return (math.pi / 2 - heading_rad) % math.tau


def wayword_from_yaw(yaw_rad: float) -> float:
    return -yaw_rad % math.tau


def yaw_from_wayword(heading_rad: float) -> float:
    return -heading_rad % math.tau
