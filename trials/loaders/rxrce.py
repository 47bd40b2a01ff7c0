"""Reads RxR-CE episodes with the genuine classes of VLN-CE. The base classes of habitat-lab 0.1.7 are written again
here with the same fields."""

import importlib
import tempfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any, List, Optional

import attr
import numpy as np

import stubs

ROLES = ["guide"]


def _must_be_set(self, attribute, value):
    """habitat/core/utils.py: not_none_validator"""
    if value is None:
        raise ValueError(f"Argument '{attribute.name}' must be set")


def _needed(kind):
    return attr.ib(default=None, validator=_must_be_set, type=kind)


@attr.s(kw_only=True)
class NavigationGoal:
    """habitat/tasks/nav/nav.py"""

    position = _needed(List[float])
    radius = attr.ib(default=None)


@attr.s(kw_only=True)
class VLNEpisode:
    """habitat/core/dataset.py, tasks/nav/nav.py and tasks/vln/vln.py in one"""

    episode_id = _needed(str)
    scene_id = _needed(str)
    start_position = _needed(List[float])
    start_rotation = _needed(List[float])
    info = attr.ib(default=None)
    goals = _needed(List[Any])
    start_room = attr.ib(default=None)
    shortest_paths = attr.ib(default=None)
    reference_path = _needed(List[Any])
    instruction = _needed(Any)
    trajectory_id = _needed(Any)


@attr.s(auto_attribs=True)
class InstructionData:
    """habitat/tasks/vln/vln.py"""

    instruction_text: str
    instruction_tokens: Optional[List[str]] = None


class Dataset:
    """habitat/core/dataset.py"""

    @staticmethod
    def scene_from_scene_path(path):
        return Path(path).stem


class Simulator:
    """An agent that stands still, for the measure nDTW."""

    def get_agent_state(self):
        return SimpleNamespace(position=np.zeros(3))


STAND_INS = {
    "dtw.dtw": lambda *args, **kwargs: (0.0, None),
    "fastdtw.fastdtw": lambda *args, **kwargs: (0.0, None),
    "habitat.core.dataset.ALL_SCENES_MASK": "*",
    "habitat.core.dataset.Dataset": Dataset,
    "habitat.core.utils.not_none_validator": _must_be_set,
    "habitat.datasets.utils.VocabDict": lambda word_list: word_list,
    "habitat.tasks.nav.nav.NavigationGoal": NavigationGoal,
    "habitat.tasks.vln.vln.InstructionData": InstructionData,
    "habitat.tasks.vln.vln.VLNEpisode": VLNEpisode,
    "habitat.sims.habitat_simulator.actions.HabitatSimActions": SimpleNamespace(STOP=0),
}
ABSENT = [
    "torch", "gym", "habitat", "habitat_sim", "habitat_baselines", "dtw", "fastdtw", "habitat_extensions.maps",
    "habitat_extensions.shortest_path_follower", "vlnce_baselines.common.env_utils", "vlnce_baselines.common.utils",
]  # fmt: skip


def read(clone: Path, data: Path) -> dict:
    """`data` is the folder with SPLIT_guide.json.gz and, where there are actions, SPLIT_guide_gt.json.gz."""
    file = next(data.glob("*_guide.json.gz"))
    split = file.name.removesuffix("_guide.json.gz")
    pattern = str(data / "{split}_{role}.json.gz")
    gt_pattern = pattern.replace(".json", "_gt.json")
    packages = ["habitat_extensions", "vlnce_baselines", "vlnce_baselines.common"]
    errors, ran = [], ["task.RxRVLNCEDatasetV1.__init__, from_json", "sensors.RxRInstructionSensor.get_observation"]
    with stubs.genuine({p: clone / p.replace(".", "/") for p in packages}, ABSENT, STAND_INS):
        task = importlib.import_module("habitat_extensions.task")

        def load(languages, allowed=("*",)):
            settings = dict(DATA_PATH=pattern, SPLIT=split, ROLES=ROLES, CONTENT_SCENES=["*"], SCENES_DIR="scenes")
            config = SimpleNamespace(**settings, LANGUAGES=languages, EPISODES_ALLOWED=list(allowed))
            return task.RxRVLNCEDatasetV1(config).episodes

        episodes = load(["*"])
        if len(load(["en-US", "en-IN"])) != len(episodes):
            errors.append(f"{file.name}: the usual choice of languages drops episodes")
        # The sensor opens a file of text features, named after the instruction's number and language.
        sensors = importlib.import_module("habitat_extensions.sensors")
        names = []
        sensors.np = SimpleNamespace(
            load=lambda name: names.append(name) or {"features": np.zeros((512, 768))},
            zeros=np.zeros,
            float32=np.float32,
        )
        sensor = object.__new__(sensors.RxRInstructionSensor)
        sensor.features_path = "rxr_{split}/{id:06}_{lang}_text_features.npz"
        for episode in episodes:
            sensor.get_observation(episode=episode)
        if len(set(names)) != len(episodes):
            errors.append(f"{file.name}: texts share a file of features")
        actions = {}
        if (data / f"{split}_guide_gt.json.gz").exists():
            actions = _read_actions(split, gt_pattern, episodes, errors)
            ran += ["measures.NDTW.__init__, reset_metric", "recollection_dataset.collect_dataset"]
            if len(load(["*"], actions)) != len(episodes):
                errors.append(f"{file.name}: the trainer's choice of episodes drops some")
    rows = [{"text": e.instruction.instruction_text, "actions": actions.get(e.episode_id)} for e in episodes]
    return {"ran": ran, "samples": len(episodes), "rows": rows, "errors": errors}


def _read_actions(split, pattern, episodes, errors):
    # The measure opens the actions of both roles, whichever are loaded.
    measures = importlib.import_module("habitat_extensions.measures")
    settings = SimpleNamespace(GT_PATH=pattern, SPLIT=split, FDTW=True, SUCCESS_DISTANCE=3.0)
    measure = measures.NDTW(sim=Simulator(), config=settings)
    for episode in episodes:
        measure.reset_metric(episode=episode)
    recollection = importlib.import_module("vlnce_baselines.common.recollection_dataset")
    with tempfile.TemporaryDirectory() as temporary:
        trainer = object.__new__(recollection.TeacherRecollectionDataset)
        files = dict(gt_file=pattern, trajectories_file=f"{temporary}/trajectories.json.gz", max_traj_len=-1)
        trainer.config = SimpleNamespace(
            use_pbar=False,
            TASK_CONFIG=SimpleNamespace(DATASET=SimpleNamespace(SPLIT=split, ROLES=ROLES)),
            IL=SimpleNamespace(RECOLLECT_TRAINER=SimpleNamespace(**files)),
        )
        actions = {key: [step[1] for step in steps] for key, steps in trainer.collect_dataset().items()}
    for key, found in actions.items():
        if found[-1] != 0 or 0 in found[:-1] or len(found) > 500:
            errors.append(f"{key}: must stop once, at the end, within 500 actions")
    return actions
