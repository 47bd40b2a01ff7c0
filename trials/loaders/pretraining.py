"""Reads pre-training lines with the genuine classes of VLN-DUET or ScaleVLN. Features of pictures are zeros: the
classes only take them by their keys."""

import importlib
import json
import tempfile
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np

import stubs

# The special tokens of bert-base-uncased, which is all that the tasks ask a tokenizer for.
TOKENIZER = SimpleNamespace(cls_token_id=101, sep_token_id=102, mask_token_id=103, pad_token_id=0)
ENDS = ("pos", "neg_in_gt_path", "neg_others")  # the kinds of end that the tasks draw by chance


def read(clone: Path, data: Path, connectivity: Path) -> dict:
    """`data` is the folder with R2R_SPLIT_enc.jsonl and scanvp_candview_relangles.json."""
    source = next(d for d in (clone / "pretrain_src/data", clone / "VLN-DUET/pretrain_src/data") if d.is_dir())
    lines = next(data.glob("R2R_*_enc.jsonl"))
    cands = data / "scanvp_candview_relangles.json"
    items = [json.loads(line) for line in lines.read_text().splitlines()]
    table = json.loads(cands.read_text())
    errors, samples = [], 0
    with tempfile.TemporaryDirectory() as temporary, stubs.genuine({"genuine": source}, ["torch"]):
        dataset, tasks = importlib.import_module("genuine.dataset"), importlib.import_module("genuine.tasks")
        features = f"{temporary}/views.hdf5"
        with h5py.File(features, "w") as file:
            for key in table:
                file[key] = np.zeros((36, 2), np.float32)
        db = dataset.R2RTextPathData(
            [str(lines)], features, str(cands), str(connectivity), image_feat_size=1, image_prob_size=1, max_txt_len=200
        )
        worst = _check_table(db, importlib.import_module("genuine.common"), table, items, errors)
        for index, item in enumerate(items):
            path = item["path"]
            np.random.seed(index)
            for kind, end in [(kind, None) for kind in ENDS] + [("path", place) for place in path]:
                try:
                    got = db.get_input(index, kind, return_act_label=True, end_vp=end)
                except Exception as error:
                    errors.append(f"{item['instr_id']} {kind}: {type(error).__name__}: {error}")
                    continue
                samples += 1
                label, local = got["global_act_labels"], got["local_act_labels"]
                if label > 0 and got["gmap_visited_masks"][label]:
                    # The model sets this logit to minus infinity, so its loss becomes infinite.
                    errors.append(f"{item['instr_id']} {kind}: the next step is masked")
                if end is None:
                    continue
                if end == path[-1]:
                    right = label == local == 0
                else:
                    following = path[path.index(end) + 1]
                    right = got["gmap_vpids"][label] == got["traj_cand_vpids"][-1][local - 1] == following
                if not right:
                    errors.append(f"{item['instr_id']} {end}: the next step is not the path's")
            if list(got["instr_encoding"]) != item["instr_encoding"]:
                errors.append(f"{item['instr_id']}: the text was cut")
        for task in (tasks.MlmDataset(db, TOKENIZER), tasks.SapDataset(db, TOKENIZER)):
            for index in range(len(task)):
                try:
                    task[index]
                    samples += 1
                except Exception as error:
                    errors.append(f"{type(task).__name__} {index}: {type(error).__name__}: {error}")
        del db
    return {
        "ran": [
            "common.load_nav_graphs, calculate_vp_rel_pos_fts",
            "dataset.R2RTextPathData.__init__, get_input, get_act_labels, get_traj_pano_fts, get_gmap_inputs",
            "tasks.MlmDataset.__getitem__",
            "tasks.SapDataset.__getitem__",
        ],
        "samples": samples,
        "rows": [{"text": i["instr_encoding"], "actions": [i["scan"], i["heading"], *i["path"]]} for i in items],
        "errors": errors,
        "found": {"largest_difference_rad": worst},
    }


def _check_table(db, common, table, items, errors):
    """The table of neighbours against the graph, by the loader's own angles."""
    views = np.array(common.get_view_rel_angles(12), float)  # view 12 looks along heading 0, level
    worst = 0.0
    for scan in {item["scan"] for item in items}:
        graph = db.graphs[scan]
        for place in graph.nodes:
            found = table.get(f"{scan}_{place}", {})
            if set(found) != set(graph[place]):
                errors.append(f"{scan} {place}: the table has other neighbours than the graph")
            for other in set(found) & set(graph[place]):
                view, distance, heading, elevation = found[other]
                ends = (graph.nodes[p]["position"] for p in (place, other))
                off = np.array(common.calculate_vp_rel_pos_fts(*ends)[:2]) - views
                off[:, 0] = (off[:, 0] + np.pi) % (2 * np.pi) - np.pi
                away = np.hypot(*off.T)
                if away[view] > away.min() + 1e-6:
                    errors.append(f"{scan} {place} {other}: {view} is not the nearest view")
                wrong = (*(off[view] - [heading, elevation]), np.hypot(heading, elevation) - distance)
                worst = max(worst, float(np.abs(wrong).max()))
    if worst > 1e-5:
        errors.append(f"the table's angles are up to {worst} off")
    return worst
