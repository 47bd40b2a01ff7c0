"""Figures and speed of `wayword.Evaluator` against R2R's `eval.py` and VLN-DUET's metrics. See README.md."""

import argparse
import json
import math
import os
import pathlib
import random
import statistics
import sys
import time
import types

import networkx
import numpy as np
import wayword

TRAJECTORIES, ROUNDS = 10_000, 7
# What the evaluators give beside the figures, and its name here.
R2R = {"nav_errors": "ne_m", "trajectory_lengths": "tl_m"}
DUET = {"nav_error": "ne_m", "trajectory_lengths": "tl_m", "success": "sr", "oracle_success": "osr", "nDTW": "ndtw"}
DUET |= {"SDTW": "sdtw", "CLS": "cls"}


def graphs_of(folder, scans):
    """The viewpoint graphs, by the rule of the evaluators' own loaders."""
    graphs = {}
    for scan in scans:
        rows = json.loads((folder / f"{scan}_connectivity.json").read_text())
        graph = networkx.Graph()
        for row in rows:
            for other, is_open in zip(rows, row["unobstructed"], strict=True):
                if is_open and row["included"] and other["included"]:
                    a, b = ([at["pose"][n] for n in (3, 7, 11)] for at in (row, other))
                    graph.add_edge(row["image_id"], other["image_id"], weight=math.dist(a, b))
        graphs[scan] = graph
    return graphs


def walks_of(episodes, graphs):
    """Trajectories: people's paths, some of them cut off, some of them with hops at random."""
    dice = random.Random(1)
    for episode in episodes:
        for place in range(len(episode["instructions"])):
            path = list(episode["path"])
            if dice.random() < 0.5:
                path = path[: dice.randint(1, len(path))]
            for _ in range(dice.randint(0, 3)):
                path.append(dice.choice(sorted(graphs[episode["scan"]][path[-1]])))
            yield {"instr_id": f"{episode['path_id']}_{place}", "trajectory": [(name, 0.1, 0.0) for name in path]}


def empty_modules(**names):
    for module, attributes in names.items():
        sys.modules[module] = types.ModuleType(module)
        for attribute in attributes:
            setattr(sys.modules[module], attribute, object)


def r2r(simulator, episodes, graphs, distances):
    """Scores with R2R's `eval.py`: a function from trajectories to the figures of each and the summary."""
    agents = ["BaseAgent", "StopAgent", "RandomAgent", "ShortestAgent"]
    empty_modules(env=["R2RBatch"], utils=["load_datasets", "load_nav_graphs"], agent=agents)
    space = {"__name__": "r2r"}
    exec(compile((simulator / "tasks/R2R/eval.py").read_text(), "eval.py", "exec"), space)
    evaluation = space["Evaluation"].__new__(space["Evaluation"])
    evaluation.error_margin, evaluation.graphs, evaluation.distances = 3.0, graphs, distances
    evaluation.gt = {episode["path_id"]: episode for episode in episodes}

    def score(walks):
        evaluation.instr_ids = {walk["instr_id"] for walk in walks}
        # `score` reads a file; this hands it the lists.
        space["json"] = types.SimpleNamespace(load=lambda _: walks)
        return evaluation.score(os.devnull)

    return score


def duet(repository, episodes, graphs, distances):
    """Scores with VLN-DUET's environment."""
    helpers = ["load_nav_graphs", "new_simulator", "angle_feature", "get_all_point_angle_feature"]
    empty_modules(MatterSim=[], utils=[], **{"utils.data": helpers})
    sys.path.insert(0, str(repository / "map_nav_src"))
    from r2r.env import R2RNavBatch

    environment = R2RNavBatch.__new__(R2RNavBatch)
    environment.shortest_distances = distances
    environment.gt_trajs = {
        f"{episode['path_id']}_{place}": (episode["scan"], episode["path"])
        for episode in episodes
        for place in range(len(episode["instructions"]))
    }

    def score(walks):
        told, sys.stdout = sys.stdout, open(os.devnull, "w")
        try:
            return environment.eval_metrics(walks)
        finally:
            sys.stdout = told

    return score


def seconds(work):
    times = []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def main():
    reads = argparse.ArgumentParser(description=__doc__)
    for name in ("data", "simulator", "duet"):
        reads.add_argument(f"--{name}", type=pathlib.Path, required=True)
    asked = reads.parse_args()
    connectivity = asked.data / "matterport" / "connectivity"
    there = {file.name.split("_")[0] for file in connectivity.glob("*_connectivity.json")}
    episodes = [one for one in json.loads((asked.data / "r2r" / "R2R_train.json").read_text()) if one["scan"] in there]
    graphs = graphs_of(connectivity, sorted({episode["scan"] for episode in episodes}))
    distances = {scan: dict(networkx.all_pairs_dijkstra_path_length(graph)) for scan, graph in graphs.items()}
    walks = list(walks_of(episodes, graphs))[:TRAJECTORIES]
    evaluator = wayword.Evaluator(episodes, platform="matterport", data=asked.data / "matterport")
    order = {walk["instr_id"]: place for place, walk in enumerate(walks)}

    def ours(walks=walks):
        return evaluator.score(walks, rule="distance", partial=True).figures

    scores = evaluator.score(walks, rule="distance", partial=True)
    places = [order[name] for name in scores.instructions]

    theirs = r2r(asked.simulator, episodes, graphs, distances)
    summary, of_each = theirs(walks)
    off = [np.abs(np.asarray(of_each[name])[places] - scores.values(own)).max() for name, own in R2R.items()]
    means = {"success_rate": "sr", "oracle success_rate": "osr", "spl": "spl", "nav_error": "ne_m", "length": "tl_m"}
    off += [abs(summary[name] - scores.figures[own]) for name, own in means.items()]
    report("R2R eval.py", max(off), seconds(lambda: theirs(walks)), seconds(ours))

    nested = [dict(walk, trajectory=[[step[0]] for step in walk["trajectory"]]) for walk in walks]
    theirs = duet(asked.duet, episodes, graphs, distances)
    _, of_each = theirs(nested)
    off = [np.abs(np.asarray(of_each[name])[places] - scores.values(own)).max() for name, own in DUET.items()]
    report("VLN-DUET, with nDTW", max(off), seconds(lambda: theirs(nested)), seconds(lambda: ours(nested)))


def report(name, off, their_s, our_s):
    print(
        f"{name}: largest difference {off:.1e}; {TRAJECTORIES} trajectories in {their_s * 1e3:.1f} ms, "
        f"by wayword in {our_s * 1e3:.1f} ms: {their_s / our_s:.0f} times faster"
    )


if __name__ == "__main__":
    main()
