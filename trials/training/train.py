"""Trains the follower on one file of texts, and walks by people's texts with it."""

import argparse
import ctypes
import json
import math
import random
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch.nn import functional as F

from follower import MAX_WORDS, PAD, UNKNOWN, Follower, WorldTensors
from world import World, read_world, words_of

MAX_STEPS = 10
SUCCESS_M = 3.0
HIDDEN_SHARE = 0.4  # of the labels and rooms while it learns
FORGOTTEN_SHARE = 0.1  # of the words of a training text, so that the follower learns to do without a word that it does not know


@dataclass
class Walk:
    """A text with the walk that it describes."""

    item: str
    scan: str
    path: list[int]
    heading: float
    words: list[str]
    target: str | None


def read_walks(file: Path, world: World, scans: set[str]) -> list[Walk]:
    """The texts of an R2R or REVERIE file in these buildings."""
    walks = []
    for entry in json.loads(file.read_text()):
        if entry["scan"] not in scans:
            continue
        path = [world.index[entry["scan"], viewpoint] for viewpoint in entry["path"]]
        name = entry.get("id", entry["path_id"])
        target = str(entry["objId"]) if "objId" in entry else None
        for number, text in enumerate(entry["instructions"]):
            walks.append(Walk(f"{name}_{number}", entry["scan"], path, entry["heading"], words_of(text)[:MAX_WORDS], target))
    return walks


def make_vocabulary(texts: list[Walk], world: World) -> dict[str, int]:
    """Words that stand in two training texts, and all words of labels."""
    count: dict[str, int] = {}
    for walk in texts:
        for word in set(walk.words):
            count[word] = count.get(word, 0) + 1
    known = {word for word, times in count.items() if times > 1}
    known |= {word for words in (*world.node_words, *world.room_words) for word in words}
    return {word: number + 2 for number, word in enumerate(sorted(known))}


def as_tokens(walks: list[Walk], vocabulary: dict[str, int]) -> torch.Tensor:
    width = max(1, max(len(walk.words) for walk in walks))
    rows = torch.full((len(walks), width), PAD, dtype=torch.long)
    for row, walk in enumerate(walks):
        numbers = [vocabulary.get(word, UNKNOWN) for word in walk.words] or [UNKNOWN]
        rows[row, : len(numbers)] = torch.tensor(numbers)
    return rows


def roll_out(model, tensors, walks, tokens, steps, choose):
    """Walks by all texts at once, and returns the routes. `choose(time, rows, nodes, scores, ways)` gives the place of what each of these rows of `walks`
    does: 0 stops, place k takes way k - 1."""
    memory = model.read_text(tokens)
    rows = torch.arange(len(walks))
    nodes = torch.tensor([walk.path[0] for walk in walks])
    heading = torch.tensor([walk.heading for walk in walks], dtype=torch.float32)
    came_from = torch.full_like(nodes, -1)
    routes = [[walk.path[0]] for walk in walks]
    for time_step in range(steps):
        scores, ways, embedded, memory = model(memory, tensors, nodes, heading, came_from, time_step)
        done = choose(time_step, rows, nodes, scores, ways)
        going = (done > 0).nonzero()[:, 0]
        if len(going) == 0:
            break
        at = done[going] - 1
        way = ways[going, at]
        memory = {**{name: value[going] for name, value in memory.items()}, "way": embedded[going, at]}
        rows, came_from, heading, nodes = rows[going], nodes[going], tensors.way_heading[way], tensors.way_to[way]
        for row, node in zip(rows.tolist(), nodes.tolist()):
            routes[row].append(node)
    return routes


def train_batch(model, tensors, world, walks, tokens, generator):
    """The loss of a batch: half of the walks are led along the annotated walk, half go by the follower's own draws and are told the shortest way back to the
    goal at each viewpoint (DAgger)."""
    led = torch.arange(len(walks)) % 2 == 0
    losses = []

    def choose(time_step, rows, nodes, scores, ways):
        right = torch.zeros(len(rows), dtype=torch.long)
        for place, (row, node) in enumerate(zip(rows.tolist(), nodes.tolist())):
            walk = walks[row]
            if node != walk.path[-1]:
                hop = walk.path[time_step + 1] if led[row] else world.hop(walk.scan, node, walk.path[-1])
                right[place] = 1 + world.place_of_way[node, hop]
        losses.append(F.cross_entropy(scores, right, reduction="none"))
        drawn = torch.multinomial(F.softmax(scores.detach(), 1), 1, generator=generator)[:, 0]
        return torch.where(led[rows], right, drawn)

    roll_out(model, tensors, walks, tokens, MAX_STEPS, choose)
    return torch.cat(losses).mean()


def draw_batches(files: list[list[Walk]], size: int, draws: random.Random):
    """Batches without end: an equal share of each file, each text once before any comes again, and texts of like length together."""
    decks: list[list[Walk]] = [[] for _ in files]
    while True:
        pool = []
        for walks, deck in zip(files, decks):
            for _ in range(16 * size // len(files)):
                if not deck:
                    deck.extend(draws.sample(walks, len(walks)))
                pool.append(deck.pop())
        pool.sort(key=lambda walk: len(walk.words))
        batches = [pool[first : first + size] for first in range(0, len(pool), size)]
        draws.shuffle(batches)
        for batch in batches:
            draws.shuffle(batch)
            yield batch


def ndtw(world: World, scan: str, route: list[int], path: list[int]) -> float:
    """Normalised dynamic time warping over distances of the graph (Ilharco et al. 2019), with 3 m."""
    cost = np.full((len(route) + 1, len(path) + 1), np.inf)
    cost[0, 0] = 0
    for i, a in enumerate(route, 1):
        for j, b in enumerate(path, 1):
            cost[i, j] = world.metres(scan, a, b) + min(cost[i - 1, j], cost[i, j - 1], cost[i - 1, j - 1])
    return math.exp(-cost[-1, -1] / (SUCCESS_M * len(path)))


def evaluate(model, tensors, world, walks, vocabulary) -> list[dict]:
    """Walks greedily by each text; a record for each, with its figures. A walk succeeds if it ends within 3 m of the goal (R2R), or where the target is seen
    (REVERIE)."""
    model.eval()
    records = []
    with torch.no_grad():
        for first in range(0, len(walks), 256):
            part = walks[first : first + 256]
            routes = roll_out(model, tensors, part, as_tokens(part, vocabulary), MAX_STEPS, lambda time_step, rows, nodes, scores, ways: scores.argmax(1))
            for walk, route in zip(part, routes):
                goal, length = walk.path[-1], sum(world.metres(walk.scan, a, b) for a, b in zip(route, route[1:]))
                shortest = world.metres(walk.scan, walk.path[0], goal)
                near = world.metres(walk.scan, route[-1], goal) < SUCCESS_M
                success = float(near if walk.target is None else walk.target in world.node_objects[route[-1]])
                records.append({
                    "item": walk.item, "scan": walk.scan, "success": success, "spl": success * shortest / max(shortest, length, 1e-9),
                    "ndtw": ndtw(world, walk.scan, route, walk.path), "route": [world.names[node][1] for node in route],
                })
    model.train()
    return records


def average_into(average: dict, model: Follower, keep: float):
    for name, value in model.state_dict().items():
        average[name].mul_(keep).add_(value, alpha=1 - keep)


def keep_freed_memory():
    """Tells glibc not to give freed tensors back to the system: fetching the pages again takes a third of the time."""
    libc = ctypes.CDLL(None)
    if hasattr(libc, "mallopt"):
        trim_threshold, mmap_threshold = -1, -3
        libc.mallopt(trim_threshold, 2**31 - 1)
        libc.mallopt(mmap_threshold, 2**30)


def main():
    keep_freed_memory()
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--data", type=Path, required=True, help="folder with matterport/ and reverie/ (docs/DATA.md)")
    asked.add_argument("--texts", type=Path, nargs="+", required=True, help="R2R's or REVERIE's form; each file gives an equal share of a batch")
    asked.add_argument("--scans", type=Path, required=True, help="JSON list of the buildings to train in")
    asked.add_argument("--evaluate", nargs="+", required=True, metavar="NAME=FILE", help="people's texts to walk by; all of the file's buildings")
    asked.add_argument("--share", type=float, default=1.0, help="train on this share of the walks")
    asked.add_argument("--seed", type=int, default=0)
    asked.add_argument("--updates", type=int, default=600)
    asked.add_argument("--batch", type=int, default=128)
    asked.add_argument("--rate", type=float, default=8e-3)
    asked.add_argument("--threads", type=int, default=1)
    asked.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    asked.add_argument("--out", type=Path, required=True)
    args = asked.parse_args()
    torch.set_num_threads(args.threads)
    torch.set_default_device(args.device)
    torch.manual_seed(args.seed)
    began = time.time()
    trained_in = set(json.loads(args.scans.read_text()))
    tested = {name: Path(file) for name, file in (pair.split("=", 1) for pair in args.evaluate)}
    tested_in = {name: {entry["scan"] for entry in json.loads(file.read_text())} for name, file in tested.items()}
    world = read_world(args.data, sorted(trained_in.union(*tested_in.values())))
    files = [read_walks(file, world, trained_in) for file in args.texts]
    if args.share < 1:
        files = [share_of(walks, args.share, args.seed) for walks in files]
    vocabulary = make_vocabulary([walk for walks in files for walk in walks], world)
    tensors = WorldTensors(world, vocabulary)
    model = Follower(len(vocabulary) + 2)
    optimizer = torch.optim.AdamW(model.parameters(), lr=args.rate, weight_decay=0.01)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, args.rate, total_steps=args.updates, pct_start=0.1)
    average = {name: value.clone() for name, value in model.state_dict().items()}
    batches = draw_batches(files, args.batch, random.Random(args.seed))
    generator = torch.Generator(args.device).manual_seed(args.seed)
    for update in range(args.updates):
        batch = next(batches)
        tokens = as_tokens(batch, vocabulary)
        forgotten = (torch.rand(tokens.shape, generator=generator) < FORGOTTEN_SHARE) & (tokens != PAD)
        seen = tensors.with_hidden(HIDDEN_SHARE, generator)
        loss = train_batch(model, seen, world, batch, tokens.masked_fill(forgotten, UNKNOWN), generator)
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 2.0)
        optimizer.step()
        schedule.step()
        average_into(average, model, min(0.995, (update + 1) / (update + 10)))
        if update % 100 == 99:
            print(f"update {update + 1}: loss {loss.item():.3f}, {time.time() - began:.0f} s", flush=True)
    model.load_state_dict(average)
    result = {"seed": args.seed, "texts": [len(walks) for walks in files], "words": len(vocabulary), "updates": args.updates}
    for name, file in tested.items():
        records = evaluate(model, tensors, world, read_walks(file, world, tested_in[name]), vocabulary)
        result[name] = records
        figures = {key: sum(record[key] for record in records) / len(records) for key in ("success", "spl", "ndtw")}
        print(name, len(records), {key: round(100 * value, 1) for key, value in figures.items()}, flush=True)
    result["seconds"] = round(time.time() - began)
    args.out.write_text(json.dumps(result))


def share_of(walks: list[Walk], share: float, seed: int) -> list[Walk]:
    """The texts of a share of the walks, whole walks at a time; a larger share contains a smaller one."""
    names = sorted({walk.item.rsplit("_", 1)[0] for walk in walks})
    random.Random(seed).shuffle(names)
    kept = set(names[: round(share * len(names))])
    return [walk for walk in walks if walk.item.rsplit("_", 1)[0] in kept]


if __name__ == "__main__":
    main()
