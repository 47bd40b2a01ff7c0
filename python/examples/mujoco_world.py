#!/usr/bin/env python3
"""MuJoCo (pip install mujoco; tested with 4.0.0) as a world for Wayword. Without a screen it uses EGL.

`mujoco_world.py MODEL.xml ...` serves your own models: objects are bodies with a name, of which what follows a # only
tells namesakes apart, and one walks on the geom named `floor`. Without an argument it serves flat.xml, which is beside
this file. house_mujoco.py makes models of generated houses, with the rooms of each in NAME.rooms.json beside it.
"""
import functools, json, math, os, pathlib, sys  # noqa: E401
if "DISPLAY" not in os.environ:
    os.environ.setdefault("MUJOCO_GL", "egl")
import mujoco  # noqa: E402
import numpy as np  # noqa: E402
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import wayword.platform as kit  # noqa: E402
EYE_M, REACH_M = 1.5, 0.3  # the height of the eye, and the least distance to anything
SHOWN = 0.0015  # what shows on a smaller share of a picture gets no label
FILES = {name.stem: name for name in map(pathlib.Path, sys.argv[1:] or [pathlib.Path(__file__).with_name("flat.xml")])}
ROOMS = {scene: json.loads(rooms.read_text()) for scene, file in FILES.items() if (rooms := file.with_suffix(".rooms.json")).exists()}


def room_at(scene, place, heading_rad):
    """The room of an eye; where it stands in an opening, which is in no room's area, that of the room ahead."""
    for far_m in (0, 0.5):
        x, y = place[0] + far_m * math.sin(heading_rad), place[1] + far_m * math.cos(heading_rad)
        for room in ROOMS.get(scene, []):
            (x0, y0, x1, y1), over_m = room["area_m"], place[2] - EYE_M - room["floor_m"]
            if x0 <= x <= x1 and y0 <= y <= y1 and -0.2 <= over_m < 2.5:
                return room["name"]
    return None


class MuJoCo(kit.OpenPlatform):
    name, has_labels, has_rooms = "MuJoCo", True, bool(ROOMS)

    def scenes(self):
        return sorted(FILES)

    @functools.lru_cache(maxsize=None)
    def load(self, scene):
        if scene not in FILES:
            raise kit.UnknownScene(f"there are {self.scenes()}")
        model = mujoco.MjModel.from_xml_path(str(FILES[scene]))
        mujoco.mj_forward(model, data := mujoco.MjData(model))
        model.vis.global_.offwidth, model.vis.global_.offheight = 640, 480
        return model, data, mujoco.Renderer(model, 480, 640), model.geom("floor")

    def bounds(self, scene):
        floor = self.load(scene)[3]
        return [(*(floor.pos + side * floor.size)[:2], floor.pos[2] + EYE_M) for side in (-1, 1)]

    def is_free(self, scene, place):
        def ray(start, towards):  # the distance to the geom that it meets, and that geom; both are -1 if it meets none
            met, (model, data, _, _) = np.full((1, 1), -1, np.int32), self.load(scene)
            return mujoco.mj_ray(model, data, np.array(start), np.array(towards), None, 1, -1, met), met[0, 0]
        knee, turns = np.subtract(place, (0, 0, EYE_M - 0.3)), np.linspace(0, math.tau, 8, endpoint=False)
        around = [ray(knee, (math.cos(turn), math.sin(turn), 0.0))[0] for turn in turns]
        above_floor = ray(place, (0.0, 0.0, -1.0))[1] == self.load(scene)[3].id
        return above_floor and not any(0 <= far_m < REACH_M for far_m in around)

    def observe(self, scene, look):
        (model, data, renderer, _), eye = self.load(scene), mujoco.MjvCamera()  # a free camera, which looks at a point
        eye.lookat = np.add(look.position, (math.sin(look.heading_rad), math.cos(look.heading_rad), 0))
        eye.distance, eye.elevation, eye.azimuth = 1, 0, math.degrees(kit.angle_from_wayword(look.heading_rad))
        model.vis.global_.fovy = math.degrees(look.vertical_fov_rad)
        renderer.update_scene(data, eye)
        picture = renderer.render() if look.picture else None
        renderer.enable_segmentation_rendering()
        seen = renderer.render()[:, :, 0]
        renderer.disable_segmentation_rendering()
        count = np.bincount(model.geom_bodyid[seen[seen >= 0]], minlength=model.nbody)
        bodies = np.flatnonzero(count >= SHOWN * seen.size).tolist()
        names = [(body, model.body(body).name.split("#")[0]) for body in bodies if body > 0]
        labels = [kit.Label(str(body), name, data.xipos[body]) for body, name in names if name]
        return kit.View(picture, labels, room_at(scene, look.position, look.heading_rad))


kit.serve(MuJoCo)
