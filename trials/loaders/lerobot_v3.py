"""Opens a folder of LeRobot v3.0 with LeRobot's own library, and lets LeRobot judge it.

It takes every frame, asks LeRobot's resolvers which texts apply, renders the recipes that LeRobot ships, and gives
the texts to LeRobot's validator and to its writer, which must write the same rows again. The folder is not changed.

`loaders.py` runs it with a Python of its own: python lerobot_v3.py FOLDER STEPS
"""

import collections
import importlib.metadata
import json
import os
import shutil
import sys
import tempfile
from pathlib import Path

CAMERA = "observation.images.front"
PERSISTENT = ("subtask", "plan", "memory", "motion")  # at most one row of each is active at a time
STATISTICS = {"min", "max", "mean", "std", "count", "q01", "q10", "q50", "q90", "q99"}


def read(data: Path, steps: Path) -> dict:
    """`data` is the folder with meta/; `steps` is the folder of steps that it was packed from."""
    with tempfile.TemporaryDirectory() as work:
        # Both must be set before the first import: no network, and no cache of an earlier run.
        os.environ["HF_HUB_OFFLINE"] = "1"
        os.environ["HF_DATASETS_CACHE"] = f"{work}/cache"
        return _read(data, steps, Path(work))


def _read(data, steps, work):
    import numpy as np
    import torch
    from lerobot.annotations.steerable_pipeline.reader import iter_episodes
    from lerobot.annotations.steerable_pipeline.staging import EpisodeStaging
    from lerobot.annotations.steerable_pipeline.validator import StagingValidator
    from lerobot.annotations.steerable_pipeline.writer import LanguageColumnsWriter
    from lerobot.configs import recipe as recipes
    from lerobot.datasets import LeRobotDataset, compute_stats, language, language_render
    from lerobot.utils.collate import lerobot_collate_fn

    torch.set_num_threads(1)  # the pictures are small, and threads only wait for each other
    errors, ran = [], set()

    def call(where, function, *args, **kwargs):
        """Calls a genuine function, notes its name, and notes what it raises."""
        ran.add(f"{function.__module__}.{function.__qualname__}".removeprefix("lerobot."))
        try:
            return function(*args, **kwargs)
        except Exception as error:
            errors.append(f"{where}: {function.__qualname__}: {type(error).__name__}: {error}")
            return None

    dataset = call("folder", LeRobotDataset, "local/wayword", root=data)
    if dataset is None:
        return {"errors": errors, "ran": sorted(ran), "samples": 0, "rows": []}
    meta, fps = dataset.meta, dataset.meta.fps
    for column, entry in call("language", language.language_feature_info).items():
        if meta.features.get(column) != entry:
            errors.append(f"info.json: {column} is declared as {meta.features.get(column)}, not as {entry}")
    for key, feature in meta.features.items():
        have = set(meta.stats.get(key, {}))
        if feature["dtype"] not in ("string", "language") and have != STATISTICS:
            errors.append(f"stats.json: {key} has {sorted(have)}")
    call("stats.json", compute_stats.aggregate_stats, [meta.stats, meta.stats])

    # The recipes that LeRobot ships (its wheel has none), and one of ours that shows which text is the task.
    folder = Path(recipes.__file__).parent / "recipes"
    shipped = [call(file.name, recipes.load_recipe, file) for file in sorted(folder.glob("*.yaml"))]
    subtask = {"role": "assistant", "content": "${subtask}", "stream": "low_level", "target": True}
    turns = [
        {"role": "user", "content": "${task}", "stream": "high_level"},
        {**subtask, "if_present": "subtask"},
    ]
    ours = recipes.TrainingRecipe.from_dict({"messages": turns})

    views = _views(steps, np)
    walks, counts, worst, compared = {}, collections.Counter(), 0.0, set()
    for i in range(len(dataset)):
        item = call(f"frame {i}", dataset.__getitem__, i)
        if item is None:
            continue
        number, t, text = item["episode_index"].item(), item["timestamp"].item(), item["task"]
        persistent, events = item["language_persistent"], item["language_events"]
        walk = walks.setdefault(number, {"text": text, "actions": [], "rows": persistent, "events": []})
        step, where = len(walk["actions"]), f"episode {number} frame {item['frame_index'].item()}"
        walk["actions"].append(item["action"].item())
        walk["events"].append((t, events))
        if not isinstance(text, str) or text != walk["text"] or persistent != walk["rows"]:
            errors.append(f"{where}: the texts differ from those of the episode's first frame")

        # H.264 loses a little, so the picture must be nearer to its own than to its neighbours.
        length = meta.episodes[number]["length"]
        if (text, length) in views:
            off = {
                n: float(np.abs(item[CAMERA].numpy() - views[text, length](n)).mean())
                for n in (step - 1, step, step + 1)
                if 0 <= n < length
            }
            worst = max(worst, off[step])
            compared.add((number, step))
            if min(off.values()) < off[step]:
                errors.append(f"{where}: the picture is that of another frame")

        rows = {"persistent": persistent, "events": events}
        for style in PERSISTENT:
            counts[style] += call(where, language_render.active_at, t, persistent=persistent, style=style) is not None
            call(where, language_render.emitted_at, t, style=style, **rows)
        for role in ("user", "assistant"):
            row = call(where, language_render.emitted_at, t, style="vqa", role=role, camera=CAMERA, **rows)
            counts[f"vqa {role}"] += row is not None
        # Several task_aug rows share the time 0; only the renderer chooses one.
        texts = {r["content"] for r in persistent if r["style"] == "task_aug"} or {text}
        render = dict(t=t, sample_idx=i, **rows)
        out = call(where, language_render.render_sample, recipe=ours, dataset_ctx={"task": text}, **render)
        if not out or out["messages"][0]["content"] not in texts:
            errors.append(f"{where}: the rendered task is none of the episode's texts: {out}")
        for recipe in shipped:
            call(where, language_render.render_sample, recipe=recipe, task=text, **render)

    # A window of earlier and later frames, as policies ask for it, at both ends of every episode.
    window = {"action": [0, 1 / fps, 2 / fps], CAMERA: [-1 / fps, 0]}
    windows = call("windows", LeRobotDataset, "local/wayword", root=data, delta_timestamps=window)
    for e in meta.episodes:
        for i in (e["dataset_from_index"], e["dataset_to_index"] - 1):
            call(f"window at {i}", windows.__getitem__, i)
    call("batch", lerobot_collate_fn, [dataset[i] for i in range(4)])

    # The validator reads rows of LeRobot's own staging, so they are staged first.
    records, staged = list(call("data", lambda: list(iter_episodes(data))) or []), work / "staged"
    for record in records:
        walk = walks[record.episode_index]
        events = [{**e, "timestamp": t} for t, found in walk["events"] for e in found]
        staging = EpisodeStaging(staged, record.episode_index)
        call("staging", staging.write, "plan", walk["rows"])
        call("staging", staging.write, "vqa", [e for e in events if e["style"] == "vqa"])
        call("staging", staging.write, "interjections", [e for e in events if e["style"] != "vqa"])
        lost = {r["timestamp"] for r in walk["rows"]} - set(record.frame_timestamps)
        errors += [f"episode {record.episode_index}: a text at {t} is on no frame" for t in lost]
    report = call("validator", StagingValidator(dataset_camera_keys=(CAMERA,)).validate, records, staged)
    if report:
        errors += [*report.errors, *report.warnings]

    # The writer, on a copy, must put the same rows back.
    copy = work / "copy"
    for part in ("data", "meta"):
        shutil.copytree(data / part, copy / part)
    again = list(iter_episodes(copy))
    call("writer", LanguageColumnsWriter().write_all, again, staged, copy)
    for record in again:
        walk, frames = walks[record.episode_index], record.frames_df()
        mine = {
            "language_persistent": [walk["rows"]] * record.row_count,
            "language_events": [found for _, found in walk["events"]],
        }
        for column, expected in mine.items():
            if [_plain(r) for r in frames[column]] != [_plain(r) for r in expected]:
                errors.append(f"episode {record.episode_index}: LeRobot's writer writes {column} differently")

    if counts["subtask"] != len(dataset):
        errors.append(f"{len(dataset) - counts['subtask']} frames have no active subtask")
    if (len(walks), sum(len(w["actions"]) for w in walks.values())) != (meta.total_episodes, meta.total_frames):
        errors.append(f"info.json: {meta.total_episodes} episodes, {meta.total_frames} frames")
    return {
        "ran": sorted(name for name in ran if "<" not in name),
        "samples": len(dataset),
        "rows": [{"text": w["text"], "actions": w["actions"]} for w in walks.values()],
        "errors": errors,
        "pictures": len(compared),
        "found": {
            "frames with": dict(counts),
            "recipes": len(shipped),
            "worst mean difference of a picture": worst,
            "decoder": dataset.reader._video_backend,
            "lerobot": importlib.metadata.version("lerobot"),
        },
    }


def _plain(rows):
    """Rows as plain values. The writer's own column pads tool calls."""
    plain = lambda value: value.tolist() if hasattr(value, "tolist") else float(value)
    rows = json.loads(json.dumps([dict(r) for r in rows], default=plain))
    return [{**row, "tool_calls": row["tool_calls"] or None} for row in rows]


def _views(steps, np):
    """The pictures of the steps, by a text of the walk and its number of actions."""
    from PIL import Image

    found = {}
    for line in (steps / "trajectories.jsonl").read_text(encoding="utf-8").splitlines():
        walk = json.loads(line)
        folder = steps / "cameras/125cm_0deg/rgb" / walk["trajectory_id"]

        def view(step, folder=folder):
            picture = Image.open(folder / f"{step:04d}.jpg").convert("RGB")
            return np.asarray(picture, dtype=np.float32).transpose(2, 0, 1) / 255

        for instruction in walk["instructions"]:
            found[instruction["text"], len(walk["actions"])] = view
    return found


if __name__ == "__main__":
    print(json.dumps(read(*map(Path, sys.argv[1:3]))))
