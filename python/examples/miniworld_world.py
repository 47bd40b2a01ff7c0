#!/usr/bin/env python3
"""MiniWorld (pip install miniworld; tested with 2.1.0) as a world for Wayword.

A scene is an environment and a seed, as in `miniworld_world.py ThreeRooms-1 FourRooms-7`. Without a screen: EGL.
"""
import functools
import math
import os
import sys
import gymnasium
import numpy as np
import pyglet
pyglet.options["headless"] = "DISPLAY" not in os.environ  # before miniworld is imported
from miniworld.objmesh import ObjMesh  # noqa: E402
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import wayword.platform as kit  # noqa: E402
EYE_M, REACH_M = 1.5, 0.4  # the height of the eye, and the least distance to walls and objects


class MiniWorld(kit.OpenPlatform):
    name, has_labels = "MiniWorld", True

    def scenes(self):
        return sys.argv[1:] or ["FourRooms-1", "RoomObjects-1", "ThreeRooms-1"]

    @functools.lru_cache(maxsize=None)
    def env(self, scene):
        if scene not in self.scenes():
            raise kit.UnknownScene(f"there are {self.scenes()}")
        kind, seed = scene.rsplit("-", 1)
        env = gymnasium.make(f"MiniWorld-{kind}-v0", obs_width=640, obs_height=480).unwrapped
        env.reset(seed=int(seed))
        return env

    def bounds(self, scene):
        env = self.env(scene)
        return (env.min_x, -env.max_z, EYE_M), (env.max_x, -env.min_z, EYE_M)

    def is_free(self, scene, place):
        env, (x, _, z) = self.env(scene), kit.y_up_from_wayword(place)
        inside = any(room.point_inside((x, 0, z)) for room in env.rooms)
        return inside and not env.intersect(env.agent, (x, 0, z), REACH_M)

    def observe(self, scene, look):
        env, (x, y, z) = self.env(scene), kit.y_up_from_wayword(look.position)
        env.agent.pos, env.agent.dir = np.array((x, y - EYE_M, z)), kit.angle_from_wayword(look.heading_rad)
        env.agent.cam_height, env.agent.cam_fov_y = EYE_M, math.degrees(look.vertical_fov_rad)
        labels = [self.label(str(env.entities.index(thing)), thing) for thing in env.get_visible_ents()]
        return kit.View(env.render_obs() if look.picture else None, sorted(labels, key=lambda label: label.object))

    def label(self, number, thing):
        mesh = [os.path.basename(path) for path, mesh in ObjMesh.cache.items() if mesh is getattr(thing, "mesh", 0)]
        name, _, colour = (mesh or [type(thing).__name__])[0].split(".")[0].partition("_")  # such as "ball_green.obj"
        name = {"ImageFrame": "picture", "duckie": "toy duck"}.get(name, name.lower())
        middle = kit.wayword_from_y_up(np.add(thing.pos, (0, thing.height / 2, 0)))
        return kit.Label(number, name, middle, colour=getattr(thing, "color", colour) or None)


kit.serve(MiniWorld)
