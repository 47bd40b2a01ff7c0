#!/usr/bin/env python3
"""Takes the actions of an exported set of houses in AI Habitat itself: `replay.py HOUSES`.

HOUSES is the folder that `wayword house` wrote. It needs habitat-sim and habitat-lab. For each episode it steps through the
actions of episodes/train_gt.json.gz and compares where the agent ends with the last location there, and with the goal.
"""

import gzip
import json
import os
import sys

import habitat
import numpy as np

NAMES = {0: "stop", 1: "move_forward", 2: "turn_left", 3: "turn_right"}


def main() -> int:
    if len(sys.argv) != 2:
        sys.exit("usage: replay.py HOUSES")
    # The configuration names its files from within the folder.
    os.chdir(sys.argv[1])
    with gzip.open("episodes/train_gt.json.gz", "rt") as file:
        acted = json.load(file)
    farthest, collisions = 0.0, 0
    with habitat.Env(habitat.get_config(os.path.abspath("vln.yaml"))) as env:
        for _ in env.episodes:
            env.reset()
            episode = env.current_episode
            told = acted[str(episode.episode_id)]
            for action in told["actions"]:
                env.step({"action": NAMES[action]})
                collisions += bool(getattr(env.sim, "previous_step_collided", False))
            place = np.array(env.sim.get_agent_state().position)
            off = np.linalg.norm((place - told["locations"][-1])[[0, 2]])
            goal = np.linalg.norm((place - episode.goals[0].position)[[0, 2]])
            farthest = max(farthest, goal)
            print(f"{episode.episode_id}: {len(told['actions'])} actions, {off:.3f} m from where they should end, {goal:.2f} m from the goal")
    print(f"{len(acted)} episodes, the farthest ends {farthest:.2f} m from its goal; {collisions} collisions")
    return 0 if farthest <= 0.5 else 1


if __name__ == "__main__":
    sys.exit(main())
