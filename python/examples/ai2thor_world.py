#!/usr/bin/env python3
"""AI2-THOR as a world for Wayword. NOT RUN by us: written from the documentation of the API of ai2thor 5.

`ai2thor_world.py FloorPlan1 FloorPlan201`. Without a screen it uses CloudRendering."""
import os, re, sys  # noqa: E401
import numpy as np
import ai2thor.controller, ai2thor.platform  # noqa: E401
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import wayword.platform as kit  # noqa: E402
GRID_M, WIDTH_PX, HEIGHT_PX, VERTICAL_DEG = 0.25, 640, 480, 73.74  # Unity's field of view is vertical: 90 degrees wide


class Thor(kit.Platform):
    name, has_labels, scene = "AI2-THOR", True, None

    def __init__(self):
        screen = {} if "DISPLAY" in os.environ else {"platform": ai2thor.platform.CloudRendering}
        screen.update(width=WIDTH_PX, height=HEIGHT_PX, fieldOfView=VERTICAL_DEG)
        self.thor = ai2thor.controller.Controller(gridSize=GRID_M, renderInstanceSegmentation=True, **screen)

    def scenes(self):
        return sys.argv[1:] or ["FloorPlan1", "FloorPlan201", "FloorPlan301", "FloorPlan401"]

    def enter(self, scene):
        if scene not in self.scenes():
            raise kit.UnknownScene(f"there are {self.scenes()}")
        if scene != self.scene:
            known = self.thor.reset(scene=scene).metadata
            self.scene, self.eye_m = scene, known["cameraPosition"]["y"] - known["agent"]["position"]["y"]
            spots = self.thor.step("GetReachablePositions").metadata["actionReturn"]
            self.free = {(round(spot["x"] / GRID_M), round(spot["z"] / GRID_M)): spot for spot in spots}

    def points(self, scene, count, seed):
        self.enter(scene)
        return [kit.wayword_from_unity((at["x"], at["y"] + self.eye_m, at["z"])) for at in self.free.values()]

    def walkable(self, scene, a, b):
        self.enter(scene)
        way = (np.add(a, np.subtract(b, a) * part) for part in np.linspace(0, 1, 40))
        return all((round(x / GRID_M), round(y / GRID_M)) in self.free for x, y, _ in way)

    def observe(self, scene, look):
        self.enter(scene)
        if (look.width_px, look.height_px) != (WIDTH_PX, HEIGHT_PX) or abs(look.horizontal_fov_rad - np.pi / 2) > 1e-3:
            raise kit.Refused("this example draws 640 x 480 pixels, 90 degrees wide")
        place = dict(zip("xyz", np.subtract(kit.unity_from_wayword(look.position), (0, self.eye_m, 0)).tolist()))
        turn = dict(x=0, y=kit.unity_yaw_from_wayword(look.heading_rad), z=0)
        event = self.thor.step("TeleportFull", position=place, rotation=turn, horizon=0, standing=True)
        if not event.metadata["lastActionSuccess"]:
            raise kit.Refused(event.metadata["errorMessage"])
        seen = filter(lambda thing: thing["objectId"] in event.instance_detections2D, event.metadata["objects"])
        return kit.View(np.ascontiguousarray(event.frame), list(map(label, seen)))


def label(thing):
    name, middle = thing["objectType"], thing["axisAlignedBoundingBox"]["center"]
    name = re.sub("(?<=[a-z])(?=[A-Z])", " ", name).lower()  # CoffeeTable: coffee table
    return kit.Label(thing["objectId"], name, kit.wayword_from_unity([middle[axis] for axis in "xyz"]))

kit.serve(Thor)
