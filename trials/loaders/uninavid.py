"""Reads conversations about videos with the class of Uni-NaVid (`read`) or NaVid (`read_navid`), and follows the
answers as the project's evaluation does."""

import contextlib
import importlib
import io
import random
import re
import tempfile
from pathlib import Path
from types import SimpleNamespace

import stubs

WORDS = {"stop": 0, "forward": 1, "left": 2, "right": 3}


class _Tokenizer:
    """Splits at words. Like Llama's it begins with one extra id, and a space at the end is an id of its own."""

    bos_token_id, pad_token_id, model_max_length = 1, 0, 1_000_000
    special = "<video_special>|</video_special>|<image_special>|</image_special>|\\[Navigation\\]|<image_sep>|</s>"
    pattern = re.compile(special + r"|\s*[^\s<\[]+|\s*[<\[]|\s+")

    def __init__(self):
        self.words = ["<pad>", "<s>"]

    def __call__(self, text, return_tensors=None, **kwargs):
        found = self.pattern.findall(text)
        self.words += [word for word in dict.fromkeys(found) if word not in self.words]
        ids = [self.bos_token_id, *map(self.words.index, found)]
        return SimpleNamespace(input_ids=stubs.Tensor([ids]) if return_tensors else ids)

    def decode(self, ids):
        return "".join(self.words[i] for i in ids if i >= 0)


class _Processor:
    """Takes pictures as they are; the genuine one scales them to 224 and cuts the middle square out."""

    def preprocess(self, video, return_tensors=None):
        return {"pixel_values": video}


def _follow(name, agent, task, answer):
    """The actions that the evaluation takes for this answer, and the prompt that it would have asked."""
    asked = []
    agent.predict_inference = lambda prompt: asked.append(prompt) or answer
    if name == "uninavid":
        actions = agent.act({"observations": None, "instruction": task})["actions"]
        return [WORDS.get(action) for action in actions], asked[0]
    agent.pending_action_list = []
    actions = [agent.act({"rgb": None, "instruction": {"text": task}}, None, "0")["action"]]
    actions += agent.pending_action_list
    # An answer that its pattern does not read becomes a random action; so ask the pattern too.
    kind, _ = agent.extract_result(answer[:-1])
    return (actions if kind == actions[0] else [None]), asked[0]


def read(clone: Path, data: Path) -> dict:
    """`data` is the folder with uninavid.json and nav_videos/."""
    return _read("uninavid", "offline_eval_uninavid", clone, data)


def read_navid(clone: Path, data: Path) -> dict:
    """`data` is the folder with navid.json and nav_videos/."""
    return _read("navid", "navid_agent", clone, data)


def _read(name, evaluation, clone, data):
    log = io.StringIO()
    four = tuple(stubs.Anything() for _ in range(4))
    absent = ["torch", "transformers", "habitat", "cv2", "imageio", f"{name}.model", f"{name}.train.llava_trainer"]
    with (
        tempfile.TemporaryDirectory() as temporary,
        contextlib.redirect_stdout(log),
        stubs.genuine(
            packages={name: clone / name, f"{name}.train": clone / name / "train"},
            absent=absent,
            values={f"{name}.model.builder.load_pretrained_model": lambda *args, **kwargs: four},
        ),
    ):
        train = importlib.import_module(f"{name}.train.train")
        module = stubs.load(clone / f"{evaluation}.py")
        if name == "uninavid":
            agent = module.UniNaVid_Agent("model")
        else:
            agent = module.NaVid_Agent("model", temporary, require_map=False)
        read = []

        class Reader(train.VideoReader):  # notes the frames that the class takes, before it changes them by chance
            def get_batch(self, frames):
                batch = super().get_batch(frames)
                read.append((list(frames), batch.asnumpy()))
                return batch

        train.VideoReader = Reader
        arguments = SimpleNamespace(  # as scripts/*.sh set them
            is_multimodal=True, video_folder=str(data), image_folder=str(data), video_fps=1, input_prompt=None,
            image_processor=_Processor(), image_aspect_ratio="pad", mm_use_im_start_end=False, refine_prompt=False,
        )  # fmt: skip
        tokenizer = _Tokenizer()
        dataset = train.LazySupervisedDataset(str(data / f"{name}.json"), tokenizer, arguments)
        before, after = agent.promt_template.split("{}")
        errors, rows = [], {}
        for index, item in enumerate(dataset.list_data_dict):
            where, start = item["id"], len(log.getvalue())
            random.seed(index)
            read.clear()
            try:
                sample = dataset[index]
            except Exception as error:
                errors.append(f"{where}: {type(error).__name__}: {error}")
                continue
            # The class replaces a sample that it cannot read by a random other one, and only prints.
            said = log.getvalue()[start:].splitlines()
            signs = ("Error in loading", "not exist", "tokenization mismatch")
            errors += [f"{where}: {line}" for line in said if any(sign in line for sign in signs)]
            prompt = sample["prompt"][0]
            if train.NAVIGATION_IDENTIFIER not in prompt or "NAV_ID" not in where:
                errors.append(f"{where}: not taken for navigation")
            answer = tokenizer.decode(sample["labels"]).removesuffix("</s>").strip()
            human = item["conversations"][0]["value"]
            text = human[len(before) : len(human) - len(after)]
            actions, asked = _follow(name, agent, text, answer)
            if asked.replace("<image>", "").replace("\n", "") != prompt:
                errors.append(f"{where}: the prompt is not the one of the evaluation")
            if None in actions:
                errors.append(f"{where}: the evaluation does not understand {answer!r}")
            walk, _, step = where.rpartition("_")
            row = rows.setdefault(walk, {"text": text, "plan": {}, "pictures": {}})
            for i, action in enumerate(actions, int(step)):
                if row["plan"].setdefault(i, action) != action:
                    errors.append(f"{where}: action {i} is {action}, and {row['plan'][i]} by another sample")
            frames, pixels = read[-1]
            if frames != list(range(int(step) + 1)):
                errors.append(f"{where}: of the video the frames {frames} are taken")
            for i, picture in zip(frames, pixels):
                row["pictures"].setdefault(i, picture)
    for row in rows.values():
        row["pictures"] = [("125cm_0deg/rgb", step, picture) for step, picture in row["pictures"].items()]
        plan = row.pop("plan")
        row["actions"] = [plan.get(i) for i in range(max(plan) + 1)]
        if 0 in row["actions"]:  # Uni-NaVid's answers are filled up with stops
            row["actions"] = row["actions"][: row["actions"].index(0) + 1]
    return {
        "ran": [
            "train.LazySupervisedDataset.__init__, __getitem__, preprocess_multimodal, preprocess_imgsp_v1",
            "mm_utils.tokenizer_image_token",
            "UniNaVid_Agent.act" if name == "uninavid" else "NaVid_Agent.act, extract_result",
        ],
        "samples": len(dataset),
        "rows": list(rows.values()),
        "errors": errors,
    }
