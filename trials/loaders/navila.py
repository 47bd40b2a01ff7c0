"""Reads a folder of NaVILA's layout with NaVILA's own classes: the policy's samples and the speaker's."""

import ast
import contextlib
import importlib
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np

import stubs

SETTINGS = SimpleNamespace(num_video_frames=8)  # as scripts/train/sft_8frames.sh sets it
EMPTY = "Empty video."  # the answer that the classes put in where they could not read


def as_loader_writes(text):
    """A text as LazyVLNCEDataset puts it into the prompt."""
    text = text.replace("\r\n", " ").replace("\n", " ")
    text = re.sub(r"(?<=\.\s)([a-z])", lambda x: x.group().upper(), text.capitalize())
    return re.sub(r"\s+\.", ".", text)


@contextlib.contextmanager
def _module(clone):
    """The genuine module, the conversations that it makes, and the pictures that it hands on."""
    absent = ["torch", "transformers", "datasets", "llava.data.datasets_mixture"]
    absent += [f"llava.{part}" for part in ("conversation", "eval", "model", "train", "utils")]
    with stubs.genuine({"llava": clone / "llava", "llava.data": clone / "llava/data"}, absent):
        module = importlib.import_module("llava.data.dataset")
        importlib.import_module("llava.mm_utils").Image = stubs.Pictures()
        talks, images = [], []
        # In the place of the picture processor and the tokenizer.
        module.process_image = lambda image, *args: images.append(np.array(image)) or np.zeros(1)
        module.preprocess = lambda sources, tokenizer, has_image: talks.append(sources[0]) or {
            "input_ids": [None],
            "labels": [np.zeros(1)],
        }
        yield module, talks, images


def _samples(dataset, talks, images, errors):
    """What the class makes of each entry of its file: question, answer and pictures."""
    for index, item in enumerate(dataset.list_data_dict):
        talks.clear(), images.clear()
        item = {**item, "frames": list(item.get("frames", []))}
        try:
            dataset[index]
        except Exception as error:
            errors.append(f"sample {index}: {type(error).__name__}: {error}")
            continue
        question, answer = (turn["value"] for turn in talks[0])
        if answer == EMPTY:
            errors.append(f"sample {index}: {answer}")
        else:
            yield item, question, answer, images


def _evaluator(clone):
    """NaVILA's evaluator turns an answer into actions inside a long method. This takes its patterns and its function
    `map_string_to_action` out of the file, unchanged, and adds the counting."""
    path = clone / "evaluation/vlnce_baselines/cma_trainer.py"
    parts, numbers = [], []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "patterns":
            parts.insert(0, node)
        elif isinstance(node, ast.FunctionDef) and node.name == "map_string_to_action":
            parts.append(node)
        elif isinstance(node, ast.Call) and ast.unparse(node.func) == "re.search":
            numbers += [a.value for a in node.args[:1] if isinstance(a, ast.Constant)]
    scope = {"re": re}
    exec(compile(ast.Module(parts, []), str(path), "exec"), scope)
    words = {1: "move forward", 2: "turn left", 3: "turn right"}
    numbers = {action: next(n for n in numbers if n.startswith(word)) for action, word in words.items()}

    def actions_of(answer):
        action = scope["map_string_to_action"](answer)
        if not action:
            return [action]
        amount, unit = int(re.search(numbers[action], answer).group(1)), 25 if action == 1 else 15
        # The evaluator would take the nearest number of steps.
        return [action] * (amount // unit) if amount % unit == 0 else [None]

    return actions_of


def read(clone: Path, data: Path) -> dict:
    """`data` is the folder with annotations.json and frames/."""
    actions_of, errors, walks = _evaluator(clone), [], {}
    with _module(clone) as (module, talks, images):
        dataset = module.LazyVLNCEDataset(str(data / "annotations.json"), str(data / "frames"), None, SETTINGS, None)
        for item, question, answer, _ in _samples(dataset, talks, images, errors):
            text = question.split('Your assigned task is: "', 1)[1].rsplit('" Analyze this series', 1)[0]
            walk = walks.setdefault((item["video_id"], item["q"]), {"text": text, "answers": {}, "files": []})
            # The number of earlier pictures is the number of actions so far.
            walk["answers"][len(item["frames"]) - 1] = actions_of(answer)
            walk["files"] = max(walk["files"], item["frames"], key=len)
    rows = []
    for walk in walks.values():
        actions = []
        while walk["answers"].get(len(actions)):
            actions += walk["answers"][len(actions)]
        pictures = [("125cm_0deg/rgb", i, data / "frames" / file) for i, file in enumerate(walk["files"])]
        rows.append({"text": walk["text"], "actions": actions, "pictures": pictures})
    return {
        "ran": [
            "dataset.LazyVLNCEDataset.__init__, __getitem__, _load_video",
            "mm_utils.vlnce_frame_sampling",
            "cma_trainer.py: patterns, map_string_to_action",
        ],
        "samples": len(dataset),
        "rows": rows,
        "errors": errors,
    }


def read_speaker(clone: Path, data: Path) -> dict:
    """`data` is the folder with speaker.json and videos/. A row has the video's length in the place of actions."""
    errors, rows, lengths = [], [], []
    with _module(clone) as (module, talks, images):
        dataset = module.LazyEnvDropDataset(str(data / "speaker.json"), str(data / "videos"), None, SETTINGS, None)
        load = dataset._load_video

        def noting(*args):
            pictures, length = load(*args)
            lengths.append(length)
            return pictures, length

        dataset._load_video = noting
        for _, _, answer, images in _samples(dataset, talks, images, errors):
            last = lengths[-1] - 1
            steps = [*np.linspace(0, last, num=len(images) - 1, endpoint=False, dtype=int).tolist(), last]
            pictures = [("125cm_0deg/rgb", step, image) for step, image in zip(steps, images)]
            rows.append({"text": answer, "length": lengths[-1], "pictures": pictures})
    return {
        "ran": ["dataset.LazyEnvDropDataset.__init__, __getitem__, _load_video", "mm_utils.get_frame_from_vcap_vlnce"],
        "samples": len(dataset),
        "rows": rows,
        "errors": errors,
    }
