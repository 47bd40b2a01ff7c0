"""Reads folders of InternNav's two layouts with InternNav's own classes: `read` VLN-CE's, `read_n1` VLN-N1's."""

import importlib
import json
import tempfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from PIL import Image

import stubs

LEVEL, PITCHED = "125cm_0deg", "125cm_30deg"
NAME = "r2r_125cm_0_30"  # the clone's name for these two cameras
STEPS = {1: (0.25, 0.0, 0.0), 2: (0.0, 0.0, np.radians(15)), 3: (0.0, 0.0, -np.radians(15))}  # ahead, left, turn
SIGNS = {0: "STOP", 2: "←", 3: "→"}
WRONG_M, WRONG_DEG = 1e-3, 0.01  # poses are of 32 bits
GOAL_M = 0.2  # how far a pixel goal may be from the place that it means


def _packages(clone):
    return {"internnav": clone / "internnav", "internnav.dataset": clone / "internnav/dataset"}


def _off(action, ahead, left, turn):
    """How far a motion is from its action's: metres, and degrees."""
    want = STEPS[action]
    turn = (turn - want[2] + np.pi) % (2 * np.pi) - np.pi
    return max(abs(ahead - want[0]), abs(left - want[1])), abs(np.degrees(turn))


class _Processor:
    """In the place of Qwen's picture processor: every picture is one patch."""

    merge_size = 1

    def preprocess(self, image, return_tensors):
        return {"pixel_values": stubs.Tensor(np.zeros((1, 1))), "image_grid_thw": stubs.Tensor([[1, 1, 1]])}


def read(clone: Path, data: Path) -> dict:
    """`data` is the folder that InternNav calls SET, with a folder for each scene."""
    with stubs.genuine(
        packages=_packages(clone),
        absent=["torch", "transformers", "torchcodec"],
        values={"transformers.image_utils.to_numpy_array": np.array},
    ):
        module = importlib.import_module("internnav.dataset.internvla_n1_lerobot_dataset")
        module.data_dict[NAME]["data_path"] = str(data)
        notes = module.get_annotations_from_lerobot_data(str(data), PITCHED)["episodes"]
        errors, walks, goals = [], {}, []
        for e in notes:
            # As the class does: the first action is a dummy, and the stop is not written.
            walk = {"actions": e["actions"][1:] + [0], "goals": e["pixel_goals"], "pictures": {}}
            walks[(e["video"], e["id"])] = walk
            _check_motion(module, e, walk["actions"], errors)
            goals += _check_goals(e, errors)
        samples = _read_samples(module, walks, errors)
        rows = []
        for e in notes:
            walk = walks[(e["video"], e["id"])]
            found = [(ahead + i, *goal) if ahead >= 0 else None for i, (ahead, goal) in enumerate(walk["goals"])]
            rows.append(
                {
                    "text": e["instructions"],
                    "actions": walk["actions"],
                    "goals": found,
                    "pictures": list(walk["pictures"].values()),
                }
            )
    return {
        "ran": [
            "internvla_n1_lerobot_dataset.get_annotations_from_lerobot_data, get_trajectory_relative_to_frame",
            "NavPixelGoalDataset.__init__, __getitem__, preprocess_depth_image_v2",
        ],
        "samples": samples,
        "rows": rows,
        "errors": errors,
        "found": {"pixel goals": len(goals), "mean_m_off": float(np.mean(goals)), "largest_m_off": float(max(goals))},
    }


def _check_motion(module, e, actions, errors):
    """Between each pose and the next lies what the action says, as InternNav's own code measures it."""
    poses = np.array(e[f"poses_{PITCHED}"], dtype=float)
    if e["actions"][0] != -1:
        errors.append(f"{e['video']} {e['id']}: the first action is {e['actions'][0]}, not -1")
    for i, action in enumerate(actions[:-1]):
        motion = module.get_trajectory_relative_to_frame(poses[i : i + 2], camera_deg=30)[1]
        metres, degrees = _off(action, *(float(v) for v in motion))
        if metres > WRONG_M or degrees > WRONG_DEG:
            errors.append(f"{e['video']} {e['id']} row {i}: the motion is {metres} m, {degrees} degrees off its action")


def _check_goals(e, errors):
    """How far, over ground, the place that the depth picture has at each goal is from the goal's frame."""
    poses = np.array(e[f"poses_{PITCHED}"], dtype=float)
    off = []
    for i, (ahead, goal) in enumerate(e["pixel_goals"]):
        if ahead == -1 and list(goal) == [-1, -1]:
            continue
        if not all(isinstance(v, int) for v in [ahead, *goal]) or not 0 < ahead < len(poses) - i:
            errors.append(f"{e['video']} {e['id']} row {i}: the goal is {goal}, {ahead} frames ahead")
            continue
        depth = Image.open(f"{e['video']}/observation.images.depth.{PITCHED}/episode_{e['id']:06d}_{i}.png")
        f = depth.width / 2  # 90 degrees, as Wayword draws
        z = depth.getpixel(tuple(goal)) / 1000
        x, y = ((v + 0.5 - size / 2) / f * z for v, size in zip(goal, depth.size))
        off.append(float(np.linalg.norm((poses[i] @ [x, y, z, 1.0])[:2] - poses[i + ahead][:2, 3])))
        if off[-1] > GOAL_M:
            errors.append(f"{e['video']} {e['id']} row {i}: the goal is {off[-1]} m off")
    return off


def _read_samples(module, walks, errors):
    """Every sample of the class, and what it teaches to answer."""
    chats, pictures = [], stubs.Pictures()
    module.Image = pictures
    module.preprocess_qwen_2_visual = lambda sources, tokenizer, **_: chats.append(sources[0]) or {
        "input_ids": [stubs.Anything()]
    }
    arguments = SimpleNamespace(  # as scripts/train/qwenvl_train/train_system2.sh sets them
        vln_dataset_use=NAME, model_type="qwen2.5vl", sample_step=4, num_future_steps=4, num_history=8,
        predict_step_num=32, pixel_goal_only=False, transform_train=None, image_processor=_Processor(),
    )  # fmt: skip
    dataset = module.NavPixelGoalDataset(None, arguments)
    dataset.get_rope_index = lambda *args, **kwargs: (None, None)
    seen = set()
    for index, sample in enumerate(dataset.list_data_dict):
        number, video, (start, _), action, pose = sample[0], sample[2], sample[7], sample[8], sample[9]
        if id(sample) in seen:  # the class has each stop five times
            continue
        seen.add(id(sample))
        chats.clear(), pictures.names.clear()
        try:
            dataset[index]
        except Exception as error:
            errors.append(f"sample {index}: {type(error).__name__}: {error}")
            continue
        walk = walks[(video, number)]
        if pose is not None:
            want = ["↓", " ".join(str(v) for v in walk["goals"][start][1])]
        elif isinstance(action, int):
            want = ["STOP"]
        else:
            coming = walk["actions"][start : start + 4]
            turns = coming[: coming.index(1)] if 1 in coming else coming
            want = ["".join(SIGNS[a] for a in turns)]
        said = [turn["value"] for turn in chats[0] if turn["from"] == "gpt"]
        if said != want:
            errors.append(f"sample {index}: the answer is {said}, not {want}")
        for name in pictures.names:
            kind, _, camera = Path(name).parent.name.removeprefix("observation.images.").partition(".")
            step = int(Path(name).stem.rpartition("_")[2])
            walk["pictures"][name] = (f"{camera}/{kind}", step, Path(name))
    return len(dataset)


def _read_ply(name):
    """In the place of open3d: points and colours (0 to 1) of a PLY file as Wayword writes it."""
    head, _, body = Path(name).read_bytes().partition(b"end_header\n")
    kinds = {"float": "<f4", "uchar": "u1"}
    words = [line.split() for line in head.decode().splitlines()]
    table = np.frombuffer(body, dtype=[(w[2], kinds[w[1]]) for w in words if w[0] == "property"])
    points = np.stack([table[n] for n in "xyz"], axis=-1).astype(float)
    colors = np.stack([table[n] for n in ("red", "green", "blue")], axis=-1) / 255
    return SimpleNamespace(points=points, colors=colors)


def read_n1(clone: Path, data: Path) -> dict:
    """`data` is the folder with GROUP/SCENE/."""
    with stubs.genuine(
        packages=_packages(clone),
        absent=["torch", "open3d"],
        values={
            "open3d.io": SimpleNamespace(read_point_cloud=_read_ply),
            "open3d.geometry": SimpleNamespace(PointCloud=SimpleNamespace),
            "open3d.utility": SimpleNamespace(Vector3dVector=lambda values: values),
        },
    ):
        module = importlib.import_module("internnav.dataset.navdp_lerobot_dataset")
        with tempfile.TemporaryDirectory() as folder:
            dataset = module.NavDP_Base_Datset(str(data), f"{folder}/list.json")
        walks = len(dataset) // 50  # the class repeats its list 50 times
        np.random.seed(0)
        errors, rows, in_view = [], [], 0
        for index in range(walks):
            try:
                rows.append(_read_walk(dataset, index, errors))
                for _ in range(3):  # the class draws frames by chance
                    *parts, visible = dataset[index]
                    in_view += visible == 1.0
                    if not all(np.isfinite(part).all() for part in parts):
                        errors.append(f"walk {index}: a sample has values that are not finite")
            except Exception as error:
                errors.append(f"walk {index}: {type(error).__name__}: {error}")
    return {
        "ran": [
            "navdp_lerobot_dataset.NavDP_Base_Datset.__init__, __getitem__, process_data_parquet, "
            "process_obstacle_points, relative_pose, load_image, load_depth"
        ],
        "samples": 3 * walks,
        "rows": rows,
        "errors": errors,
        "found": {"goals in view": int(in_view)},
    }


def _read_walk(dataset, index, errors):
    """A walk's actions by its poses, its pictures, and its text, which the class does not read."""
    file = Path(dataset.trajectory_data_dir[index])
    _, extrinsic, poses, _ = dataset.process_data_parquet(index)
    if not len(dataset.process_obstacle_points(index)[0]):
        errors.append(f"{file}: no obstacles")
    # A frame of the body (x right, y ahead, z up) from each pose.
    bodies = poses[:, :3, :3] @ np.linalg.inv(extrinsic[:3, :3])
    if np.abs(bodies[:, 2] - [0, 0, 1]).max() > WRONG_M:
        errors.append(f"{file}: the body is not upright")
    actions = []
    for i, (here, there) in enumerate(zip(poses, poses[1:])):
        _, moved = dataset.relative_pose(here[:3, :3], here[:3, 3], there[:3, :3], there[:3, 3], extrinsic)
        turn = bodies[i].T @ bodies[i + 1]
        yaw = np.arctan2(turn[1, 0], turn[0, 0])
        actions.append(1 if np.linalg.norm(moved[:2]) > 0.1 else 2 if yaw > 0 else 3)
        metres, degrees = _off(actions[-1], moved[0], moved[1], yaw)
        if metres > WRONG_M or degrees > WRONG_DEG:
            errors.append(f"{file} row {i}: the motion is {metres} m, {degrees} degrees off an action")
    pictures = []
    for step, name in enumerate(dataset.trajectory_rgb_path[index]):
        dataset.load_image(name)
        pictures.append(("125cm_0deg/rgb", step, Path(name)))
    for step, name in enumerate(dataset.trajectory_depth_path[index]):
        pictures.append(("125cm_0deg/depth", step, dataset.load_depth(name) / 10000))  # metres
    return {"text": _text(file, len(poses), errors), "actions": actions + [0], "pictures": pictures}


def _text(file, length, errors):
    meta = file.parents[2] / "meta"
    episode = json.loads((meta / "episodes.jsonl").read_text().splitlines()[int(file.stem[-6:])])
    tasks = [json.loads(task) for task in episode["tasks"]]
    parts = [t["sub_indexes"] for t in tasks[:-1]]
    whole = tasks[-1]["sum_indexes"]
    ends = [first for first, _ in parts[1:]] + [length]
    if whole != [0, length - 1] or parts[0][0] != 0 or [last + 1 for _, last in parts] != ends:
        errors.append(f"{file}: the parts {parts} of {whole} do not cover {length} frames")
    return tasks[-1]["sum_instruction"]
