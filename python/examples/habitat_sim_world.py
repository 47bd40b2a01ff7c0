#!/usr/bin/env python3
"""habitat-sim as a world for Wayword. NOT RUN by us: written from the documentation of the API of habitat-sim 0.3.

`habitat_sim_world.py apartment_1.glb skokloster-castle.glb`; each scene needs its .navmesh beside it, and may have
semantic files there. Wayword's own platform `habitat` reads the same files without habitat-sim."""
import pathlib, sys  # noqa: E401
import habitat_sim, numpy as np  # noqa: E401
from habitat_sim.utils.common import quat_from_angle_axis
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import wayword.platform as kit  # noqa: E402
EYE_M, KINDS = 1.5, (habitat_sim.SensorType.COLOR, habitat_sim.SensorType.SEMANTIC)
FILES = {pathlib.Path(name).stem: name for name in sys.argv[1:]}


class Habitat(kit.Platform):
    name, opened = "habitat-sim", (None, None)

    def __init__(self):  # without semantic files the objects are unknown; an empty list would say that there are none
        self.has_labels = all(len(self.sim(scene).semantic_scene.objects) > 0 for scene in FILES)

    def scenes(self):
        return sorted(FILES)

    def sim(self, scene, size=(480, 640), hfov_deg=90.0):
        if scene not in FILES:
            raise kit.UnknownScene(f"there are {self.scenes()}")
        if self.opened[0] != (scene, size, hfov_deg):
            sensors = [habitat_sim.CameraSensorSpec() for _ in KINDS]
            for sensor, kind in zip(sensors, KINDS):
                sensor.uuid, sensor.sensor_type, sensor.resolution = str(kind), kind, list(size)
                sensor.position, sensor.hfov = [0.0, EYE_M, 0.0], hfov_deg
            world, agent = habitat_sim.SimulatorConfiguration(), habitat_sim.agent.AgentConfiguration()
            world.scene_id, agent.sensor_specifications = FILES[scene], sensors
            _ = self.opened[1] and self.opened[1].close()
            self.opened = (scene, size, hfov_deg), habitat_sim.Simulator(habitat_sim.Configuration(world, [agent]))
        return self.opened[1]

    def points(self, scene, count, seed):
        finder = self.sim(scene).pathfinder
        finder.seed(seed % 2**31)
        return [kit.wayword_from_y_up(finder.get_random_navigable_point() + (0, EYE_M, 0)) for _ in range(count)]

    def walkable(self, scene, a, b):
        way = habitat_sim.ShortestPath()
        way.requested_start, way.requested_end = (np.subtract(kit.y_up_from_wayword(p), (0, EYE_M, 0)) for p in (a, b))
        self.sim(scene).pathfinder.find_path(way)  # the distance is infinite if there is no way
        return way.geodesic_distance < 1.02 * np.linalg.norm(np.subtract(a, b))

    def observe(self, scene, look):
        sim = self.sim(scene, (look.height_px, look.width_px), round(np.degrees(look.horizontal_fov_rad), 6))
        state = habitat_sim.AgentState(np.subtract(kit.y_up_from_wayword(look.position), (0, EYE_M, 0)))
        state.rotation = quat_from_angle_axis(kit.yaw_from_wayword(look.heading_rad), np.array([0, 1, 0]))
        sim.get_agent(0).set_state(state)
        picture, numbers = (sim.get_sensor_observations()[str(kind)] for kind in KINDS)
        things = {thing.semantic_id: thing for thing in sim.semantic_scene.objects if thing is not None}
        seen = [things[number] for number in np.unique(numbers) if number in things]
        labels = [kit.Label(one.id, one.category.name(), kit.wayword_from_y_up(one.aabb.center)) for one in seen]
        return kit.View(np.ascontiguousarray(picture[:, :, :3]), labels)

kit.serve(Habitat)
