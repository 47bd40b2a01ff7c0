"""Reads a folder of StreamVLN's trajectory data with StreamVLN's own class.

Like every module here it has `read`, which returns
  ran       the genuine functions that ran
  samples   how many samples the loader has
  rows      one for each text: its actions, and its pictures as (camera's folder, step, file or pixels)
  errors    what the loader could not read, or what contradicts itself
"""

import importlib
import re
from pathlib import Path

import numpy as np

import stubs

SIGNS = {"STOP": 0, "↑": 1, "←": 2, "→": 3}


def read(clone: Path, data: Path) -> dict:
    """`data` is the folder with annotations.json and images/."""
    folders = ["", "dataset", "utils"]
    with stubs.genuine(
        packages={".".join(filter(None, ["streamvln", f])): clone / "streamvln" / f for f in folders},
        absent=["torch", "transformers", "llava"],
        values={"torch.stack": list},
    ):
        module = importlib.import_module("streamvln.dataset.vln_action_dataset")
        arguments = importlib.import_module("streamvln.args").DataArguments

        class Processor:  # in the place of the SigLIP processor
            def preprocess(self, images, return_tensors):
                return {"pixel_values": [np.asarray(images).shape]}

        talks = []
        module.SigLipImageProcessor = Processor
        # In the place of the tokenizer: keep the conversation.
        module.preprocess = lambda sources, tokenizer, has_image: talks.append(sources[0]) or {
            "input_ids": [None],
            "labels": [None],
        }
        # As scripts/streamvln_train_slurm.sh sets them.
        settings = arguments(video_folder=str(data), num_frames=32, num_history=8, num_future_steps=4)
        dataset = module.VLNActionDataset(None, settings, 0)
        errors, rows = [], {}
        for index, (walk, number, start, _) in enumerate(dataset.data_list):
            talks.clear()
            try:
                dataset[index]
            except Exception as error:
                errors.append(f"sample {index}: {type(error).__name__}: {error}")
                continue
            prompt = talks[0][0]["value"]
            text = prompt.split("Your task is to ", 1)[1].rsplit(" Devise an action sequence", 1)[0]
            item = dataset.nav_data[walk]
            # The class sorts the names of the files.
            files = sorted((Path(item["video"]) / "rgb").iterdir())
            pictures = [("125cm_0deg/rgb", step, file) for step, file in enumerate(files)]
            row = rows.setdefault((walk, number), {"text": text, "actions": [], "pictures": pictures})
            if start != len(row["actions"]):
                errors.append(f"sample {index}: starts at {start}, after {len(row['actions'])} actions")
            for turn in talks[0]:
                if turn["from"] == "gpt":
                    row["actions"] += [SIGNS[sign] for sign in re.findall("STOP|.", turn["value"])]
    for (walk, _), row in rows.items():
        if len(row["pictures"]) != len(row["actions"]):
            errors.append(f"walk {walk}: {len(row['pictures'])} pictures, {len(row['actions'])} actions")
    return {
        "ran": ["vln_action_dataset.VLNActionDataset.__init__, __getitem__"],
        "samples": len(dataset),
        "rows": list(rows.values()),
        "errors": errors,
    }
