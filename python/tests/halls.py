"""A small world for the tests."""

import math

from wayword.platform import Label, OpenPlatform, UnknownScene, View

THINGS = [("lamp", (1, 1, 1)), ("sofa", (9, 1, 1)), ("piano", (1, 9, 1)), ("table", (9, 9, 1)), ("plant", (5, 9.5, 1))]


class Hall(OpenPlatform):
    """A hall of 10 x 10 m with things along its walls and a pillar."""

    name, has_labels, has_pictures, has_rooms = "hall", True, False, True

    def scenes(self):
        return ["hall"]

    def bounds(self, scene):
        if scene != "hall":
            raise UnknownScene("there is one: hall")
        return (0, 0, 1.5), (10, 10, 1.5)

    def is_free(self, scene, place):
        return math.dist(place[:2], (5, 5)) > 1

    def observe(self, scene, look):
        things = [Label(str(n), name, position=at) for n, (name, at) in enumerate(THINGS)]
        near = [thing for thing in things if math.dist(thing.position[:2], look.position[:2]) < 4]
        return View(labels=near, room="hall")
