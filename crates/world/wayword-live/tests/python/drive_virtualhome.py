"""Drives VirtualHome with the genuine Python client and prints, as JSON, what the client decoded.

Usage: drive_virtualhome.py PORT
"""

import collections
import collections.abc
import json
import sys
import sysconfig

# The client, version 2.3.0, was written for Python up to 3.9, and searches for itself in the sixth entry of sys.path.
collections.Iterable = collections.abc.Iterable
sys.path[5:5] = [""] * (5 - len(sys.path)) + [sysconfig.get_paths()["purelib"]]

from virtualhome.simulation.unity_simulator.comm_unity import UnityCommunication  # noqa: E402

comm = UnityCommunication(port=sys.argv[1])
told = {"connected": comm.check_connection(), "reset": comm.reset(0)}
ok, graph = comm.environment_graph()
told["nodes"] = {node["id"]: [node["class_name"], node["category"], node["bounding_box"]] for node in graph["nodes"]}
told["inside"] = sum(edge["relation_type"] == "INSIDE" for edge in graph["edges"])
told["character"] = comm.add_character("Chars/Male1", initial_room="kitchen")
room = next(node for node in graph["nodes"] if node["class_name"] == "livingroom")
x, _, z = room["bounding_box"]["center"]
told["cameras"] = [comm.camera_count()[1]]
told["added"] = comm.add_camera([x, 1.5, z], [0, 0, 0], 60)[0]
told["moved"] = comm.update_camera(0, [x, 1.5, z], [0, 90, 0], 70)[0]
told["cameras"].append(comm.camera_count()[1])
told["at"] = [x, z]
ok, (normal,) = comm.camera_image([0], mode="normal", image_width=160, image_height=120)
ok, (instances,) = comm.camera_image([0], mode="seg_inst", image_width=160, image_height=120)
told["shape"] = [list(normal.shape), list(instances.shape)]
told["mean"] = [float(channel) for channel in normal[:, :, ::-1].reshape(-1, 3).mean(axis=0)]
ok, colours = comm.instance_colors()
by_colour = {tuple(round(channel * 255) for channel in rgb): int(id) for id, rgb in colours.items()}
pixels = {tuple(int(n) for n in pixel) for pixel in instances[:, :, ::-1].reshape(-1, 3)}
told["seen"] = sorted(by_colour[pixel] for pixel in pixels if pixel in by_colour)
told["unknown_colours"] = len([pixel for pixel in pixels if pixel not in by_colour])
told["unknown_action"] = comm.remove_terrain()
print(json.dumps(told))
