"""Drives a TDW build with the genuine Python client and prints, as JSON, what the client decoded.

Usage: drive_tdw.py PORT FOLDER
"""

import json
import sys

import tdw
from tdw.add_ons.image_capture import ImageCapture
from tdw.add_ons.occupancy_map import OccupancyMap
from tdw.add_ons.third_person_camera import ThirdPersonCamera
from tdw.controller import Controller
from tdw.output_data import (
    AvatarKinematic,
    Bounds,
    CameraMatrices,
    Categories,
    ImageSensors,
    IsOnNavMesh,
    NavMeshPath,
    OutputData,
    QuitSignal,
    SceneRegions,
    SegmentationColors,
    Transforms,
)
from tdw.tdw_utils import TDWUtils

port, folder = int(sys.argv[1]), sys.argv[2]
c = Controller(port=port, check_version=False, launch_build=False)
told = {"client": tdw.version.__version__, "build": c._tdw_version, "unity": c._unity_version}


def frames(commands):
    response = c.communicate(commands)
    return {OutputData.get_data_type_id(frame): frame for frame in response[:-1]}, response[-1]


camera = ThirdPersonCamera(avatar_id="a", position={"x": 3.0, "y": 1.5, "z": 3.0}, look_at={"x": 4.0, "y": 1.5, "z": 7.0})
capture = ImageCapture(avatar_ids=["a"], path=folder, png=True, pass_masks=["_img", "_id", "_depth"])
occupancy = OccupancyMap()
c.add_ons.extend([camera, capture, occupancy])
got, number = frames([{"$type": "set_screen_size", "width": 160, "height": 120}])
told["frame"] = Controller.get_frame(number)
images = capture.images["a"]
told["size"] = [images.get_width(), images.get_height()]
told["passes"] = [images.get_pass_mask(i) for i in range(images.get_num_passes())]
pictures = capture.get_pil_images()["a"]
depth = TDWUtils.get_depth_values(images.get_image(2), width=160, height=120)
told["depth"] = [float(depth.min()), float(depth[60][80])]

occupancy.generate(cell_size=0.5)
got, _ = frames(
    [
        {"$type": "set_field_of_view", "field_of_view": 60, "avatar_id": "a"},
        {"$type": "send_segmentation_colors", "frequency": "once"},
        {"$type": "send_categories", "frequency": "once"},
        {"$type": "send_scene_regions", "frequency": "once"},
        {"$type": "send_bounds", "frequency": "once"},
        {"$type": "send_transforms", "frequency": "once"},
        {"$type": "send_avatars", "frequency": "once"},
        {"$type": "send_camera_matrices", "frequency": "once"},
        {"$type": "send_image_sensors", "frequency": "once"},
        {"$type": "send_is_on_nav_mesh", "position": {"x": 3.0, "y": 0.0, "z": 3.0}, "max_distance": 2.0, "id": 5},
        {"$type": "a_command_that_nobody_knows", "value": 1},
    ]
)
segmentation = SegmentationColors(got["segm"])
colours = {tuple(int(n) for n in segmentation.get_object_color(i)): i for i in range(segmentation.get_num())}
told["objects"] = {
    segmentation.get_object_id(i): [segmentation.get_object_name(i), segmentation.get_object_category(i)]
    for i in range(segmentation.get_num())
}
seen = {pixel for pixel in pictures["_id"].convert("RGB").getdata()}
told["seen"] = sorted(segmentation.get_object_id(colours[pixel]) for pixel in seen if pixel in colours)
told["unknown_colours"] = len([pixel for pixel in seen if pixel not in colours])
told["categories"] = Categories(got["cate"]).get_num_categories()
told["rooms"] = SceneRegions(got["sreg"]).get_num()
bounds = Bounds(got["boun"])
told["bounds"] = {bounds.get_id(i): [float(n) for n in bounds.get_center(i)] for i in range(bounds.get_num())}
transforms = Transforms(got["tran"])
told["transforms"] = {transforms.get_id(i): [float(n) for n in transforms.get_position(i)] for i in range(transforms.get_num())}
avatar = AvatarKinematic(got["avki"])
told["avatar"] = [avatar.get_avatar_id(), [float(n) for n in avatar.get_position()], [float(n) for n in avatar.get_forward()]]
told["camera"] = [float(n) for n in CameraMatrices(got["cama"]).get_camera_matrix()]
sensors = ImageSensors(got["imse"])
told["sensor"] = [sensors.get_sensor_name(0), float(sensors.get_sensor_field_of_view(0))]
told["occupancy"] = {str(kind): int((occupancy.occupancy_map == kind).sum()) for kind in (-1, 0, 1)}
ground = IsOnNavMesh(got["isnm"])
told["on_nav_mesh"] = [bool(ground.get_is_on()), [float(n) for n in ground.get_position()]]

free = [occupancy.positions[i] for i in zip(*(occupancy.occupancy_map == 0).nonzero())]
start, end = ({"x": float(place[0]), "y": 0.0, "z": float(place[1])} for place in (free[0], free[-1]))
got, _ = frames([{"$type": "send_nav_mesh_path", "origin": start, "destination": end, "id": 7}])
path = NavMeshPath(got["path"])
told["path"] = [path.get_id(), path.get_state(), len(path.get_path()), [float(n) for n in path.get_path()[-1]], end]
got, _ = frames([{"$type": "terminate"}])
told["quit"] = bool(QuitSignal(got["quit"]).get_ok())
print(json.dumps(told))
