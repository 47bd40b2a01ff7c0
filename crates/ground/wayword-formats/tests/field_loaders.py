"""Reads what Wayword writes the way the field's own loaders do.

Written from the published field lists and the accesses that those loaders make; no dataset and no simulator is needed:
    python3 field_loaders.py FORMAT FILE
It prints the number of instructions that an agent would be given, or fails as the loader would.
"""

import gzip
import json
import sys


def opened(name):
    return gzip.open(name, "rt", encoding="utf-8") if name.endswith(".gz") else open(name, encoding="utf-8")


def agent_items(items, instr_id):
    """One agent item per instruction, as R2R's environments build them; an agent's ids are unique."""
    data = []
    for item in items:
        for index, instruction in enumerate(item["instructions"]):
            new = dict(item)
            new["instr_id"] = instr_id(item, index)
            new["instructions"] = instruction
            data.append(new)
    for new in data:
        assert isinstance(new["scan"], str) and isinstance(new["instructions"], str)
        # newEpisode(scan, first viewpoint, heading, elevation) wants a C++ double.
        assert isinstance(new["path"][0], str) and isinstance(new["heading"], (int, float))
    ids = [new["instr_id"] for new in data]
    assert len(set(ids)) == len(ids), "two instructions of one id: the evaluator would judge only one"
    return data


def r2r(name):
    with opened(name) as file:
        items = json.load(file)
    truth = {item["path_id"]: item for item in items}
    assert len(truth) == len(items), "two items of one path_id"
    data = agent_items(items, lambda item, index: "%s_%d" % (item["path_id"], index))
    for new in data:
        # The evaluator finds the path from the instruction's id.
        assert truth[int(new["instr_id"].split("_")[0])]["path"] == new["path"]
    return len(data)


def reverie(name):
    with opened(name) as file:
        items = json.load(file)
    truth = {item["id"]: item for item in items}
    assert len(truth) == len(items), "two items of one id"
    for item in items:
        assert isinstance(item["path_id"], int)
        if "objId" in item:
            assert item["id"] == "%d_%d" % (item["path_id"], int(item["objId"]))

    def instr_id(item, index):
        if "objId" in item:
            return "%s_%s_%d" % (item["path_id"], item["objId"], index)
        return "%s_%d" % (item["id"], index)

    data = agent_items(items, instr_id)
    for new in data:
        truth[new["instr_id"].rsplit("_", 1)[0]]
    return len(data)


def rxr(name):
    with opened(name) as file:
        items = [json.loads(line) for line in file]
    for item in items:
        "%06d" % item["instruction_id"]
        assert isinstance(item["annotator_id"], int) and isinstance(item["path_id"], int)
        assert isinstance(item["split"], str) and item["language"].split("-")[0] in ("en", "hi", "te")
        assert isinstance(item["edit_distance"], float)
        for timed in item["timed_instruction"]:
            assert isinstance(timed["word"], str)
            timed.get("start_time"), timed.get("end_time")
        item["instructions"] = [item["instruction"]]
    return len(agent_items(items, lambda item, index: "%s" % item["instruction_id"]))


class Goal:
    def __init__(self, position=None, radius=None):
        assert position is not None and len(position) == 3


class InstructionData:
    def __init__(self, instruction_text=None, instruction_tokens=None):
        assert instruction_text is not None
        self.tokens = instruction_tokens


class Episode:
    """Habitat's episode class: a key that is not an attribute raises TypeError."""

    def __init__(
        self,
        *,
        episode_id=None,
        scene_id=None,
        start_position=None,
        start_rotation=None,
        info=None,
        goals=None,
        start_room=None,
        shortest_paths=None,
        reference_path=None,
        instruction=None,
        trajectory_id=None,
    ):
        for needed in (episode_id, scene_id, start_position, start_rotation, instruction):
            assert needed is not None
        assert len(start_position) == 3 and len(start_rotation) == 4
        assert abs(sum(part * part for part in start_rotation) - 1) < 1e-4
        self.episode_id, self.scene_id, self.info = episode_id, scene_id, info
        self.goals, self.reference_path, self.instruction = goals, reference_path, instruction


def vlnce(name):
    with opened(name) as file:
        deserialized = json.loads(file.read())
    words = deserialized["instruction_vocab"]["word_list"]
    index = {word: place for place, word in enumerate(words)}
    assert index["<pad>"] == 0 and index["<unk>"] == 1
    ids = set()
    for fields in deserialized["episodes"]:
        episode = Episode(**fields)
        ids.add(str(episode.episode_id))
        scan = episode.scene_id.split("/")[-2]
        assert episode.scene_id == "mp3d/%s/%s.glb" % (scan, scan)
        instruction = InstructionData(**episode.instruction)
        assert len(instruction.tokens) == 200 and all(0 <= token < len(words) for token in instruction.tokens)
        [Goal(**goal) for goal in episode.goals]
        assert all(len(position) == 3 for position in episode.reference_path)
        # The measures of VLN-CE divide by it.
        assert episode.info["geodesic_distance"] > 0
    assert len(ids) == len(deserialized["episodes"])
    return len(ids)


if __name__ == "__main__":
    loaders = {"r2r": r2r, "reverie": reverie, "rxr": rxr, "vlnce": vlnce}
    print(loaders[sys.argv[1]](sys.argv[2]))
